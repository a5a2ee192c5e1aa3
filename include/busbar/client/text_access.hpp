#pragma once

#include <functional>
#include <string>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/client/node_address.hpp>
#include <busbar/client/type_cache.hpp>
#include <busbar/client/value_text.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/method.hpp>

/// Writes and calls with texts, for command lines and scripts: the server is asked for the types
/// first. The TypeCache must outlive the operations.
namespace busbar::client {

/// The reason why a text could not be used.
struct AccessError {
    StatusCode status;
    /// The printable reason: "value: expected a Byte, 0 to 255, found \"300\"".
    std::string message;
};

/// A value, or why there is none.
template <typename T>
using Accessed = Expected<T, AccessError>;

/// Returns how to read the text of a value with this DataType and ValueRank. Bad_DataTypeIdUnknown
/// if the DataType is neither built in nor among the types.
[[nodiscard]] BUSBAR_API Result<ValueType>
value_type_of(const NodeId& data_type, std::int32_t value_rank, const binary::DynamicTypes& types);

/// Reads DataType and ValueRank of a Variable and writes the text as its value (see parse_value).
BUSBAR_API Operation write_text(Requester& requester, TypeCache& types, const NodeAddress& node,
                                std::string text, std::function<void(Accessed<void>)> done,
                                const ServiceOptions& options = {});

/// Reads the InputArguments of a Method and calls it with a text for each. A bad status of the call
/// is an error, which names the argument that the server refused. The Method is not called if the
/// number of texts differs from that of its arguments.
BUSBAR_API Operation call_text(Requester& requester, TypeCache& types, const NodeAddress& object,
                               const NodeAddress& method, std::vector<std::string> arguments,
                               std::function<void(Accessed<CallMethodResult>)> done,
                               const ServiceOptions& options = {});

} // namespace busbar::client
