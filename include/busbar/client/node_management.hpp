#pragma once

#include <functional>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/node_management.hpp>

/// The NodeManagement Service Set (Part 4, 5.8). `done` gets a result for each item. Nothing is
/// done twice: only requests that the server cannot have begun are sent again. Parts of a list that
/// is split are sent one after the other, so that a node can be the parent of a later one.
namespace busbar::client {

/// Sends the service of this name; `done` gets a result for each item, in the same order.
BUSBAR_API Operation add_nodes(Requester& requester, std::vector<AddNodesItem> items,
                               std::function<void(std::vector<AddNodesResult>)> done,
                               const ServiceOptions& options = {});
BUSBAR_API Operation add_references(Requester& requester, std::vector<AddReferencesItem> items,
                                    std::function<void(std::vector<StatusCode>)> done,
                                    const ServiceOptions& options = {});
BUSBAR_API Operation delete_nodes(Requester& requester, std::vector<DeleteNodesItem> items,
                                  std::function<void(std::vector<StatusCode>)> done,
                                  const ServiceOptions& options = {});
BUSBAR_API Operation delete_references(Requester& requester,
                                       std::vector<DeleteReferencesItem> items,
                                       std::function<void(std::vector<StatusCode>)> done,
                                       const ServiceOptions& options = {});

} // namespace busbar::client
