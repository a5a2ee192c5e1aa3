#pragma once

#include <functional>
#include <string>
#include <vector>

#include <busbar/client/node_address.hpp>
#include <busbar/client/operation.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>

namespace busbar::client {

/// The parameters that all items of a Read share.
struct ReadSettings {
    /// Maximum age of values (Part 4, 5.11.2); zero: as new as possible.
    Duration max_age{0};
    TimestampsToReturn timestamps{TimestampsToReturn::Both};
};

/// Reads attributes (Part 4, 5.11.2). `done` gets a DataValue for each item in the same order; the
/// items of a failed request have its status.
BUSBAR_API Operation read(Requester& requester, std::vector<ReadValueId> items,
                          std::function<void(std::vector<DataValue>)> done,
                          ReadSettings settings = {}, const ServiceOptions& options = {});

/// Writes attributes (Part 4, 5.11.4). `done` gets a status for each item.
BUSBAR_API Operation write(Requester& requester, std::vector<WriteValue> items,
                           std::function<void(std::vector<StatusCode>)> done,
                           const ServiceOptions& options = {});

/// The result of one value, as ExplainedCall.
struct ExplainedWrite {
    StatusCode status_code;
    std::string additional_info;
};

/// Writes likewise, and requests the additionalInfo (Part 4, 7.12).
BUSBAR_API Operation write_explained(Requester& requester, std::vector<WriteValue> items,
                                     std::function<void(std::vector<ExplainedWrite>)> done,
                                     const ServiceOptions& options = {});

/// Returns one attribute of one node in the form that read() and write() take.
[[nodiscard]] BUSBAR_API ReadValueId attribute_of(NodeId node,
                                                  AttributeId attribute = AttributeId::Value,
                                                  std::string_view index_range = {});
/// Returns what Write needs to set an attribute of a node.
[[nodiscard]] BUSBAR_API WriteValue value_for(NodeId node, DataValue value,
                                              AttributeId attribute = AttributeId::Value,
                                              std::string_view index_range = {});

/// Reads the same attribute of each node. An address that could not be resolved gets the status of
/// that.
BUSBAR_API Operation read(Requester& requester, std::vector<NodeAddress> nodes,
                          std::function<void(std::vector<DataValue>)> done,
                          AttributeId attribute = AttributeId::Value, ReadSettings settings = {},
                          const ServiceOptions& options = {});

} // namespace busbar::client
