#include "server_info.hpp"

#include <algorithm>
#include <array>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::client::detail {

namespace {

constexpr std::string_view namespace0_uri = "http://opcfoundation.org/UA/";

struct Limit {
    std::uint32_t node;
    std::uint32_t ServerOperationLimits::*member;
};

constexpr std::array limits{
    Limit{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerRead,
          &ServerOperationLimits::max_nodes_per_read},
    Limit{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerWrite,
          &ServerOperationLimits::max_nodes_per_write},
    Limit{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerMethodCall,
          &ServerOperationLimits::max_nodes_per_method_call},
    Limit{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerBrowse,
          &ServerOperationLimits::max_nodes_per_browse},
    Limit{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerRegisterNodes,
          &ServerOperationLimits::max_nodes_per_register_nodes},
    Limit{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerTranslateBrowsePathsToNodeIds,
          &ServerOperationLimits::max_nodes_per_translate_browse_paths},
    Limit{id::Server_ServerCapabilities_OperationLimits_MaxNodesPerNodeManagement,
          &ServerOperationLimits::max_nodes_per_node_management},
    Limit{id::Server_ServerCapabilities_OperationLimits_MaxMonitoredItemsPerCall,
          &ServerOperationLimits::max_monitored_items_per_call},
};
/// The two arrays, then the limits.
constexpr std::size_t first_limit = 2;
constexpr std::size_t node_count = first_limit + limits.size();

std::uint32_t node(std::size_t index)
{
    switch (index) {
    case 0:
        return id::Server_NamespaceArray;
    case 1:
        return id::Server_ServerArray;
    default:
        return limits[index - first_limit].node;
    }
}

ReadValueId value_of(std::uint32_t numeric)
{
    ReadValueId read;
    read.node_id = NodeId{0, numeric};
    read.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    return read;
}

std::vector<std::string> names_of(const DataValue& value, std::size_t max)
{
    std::vector<std::string> names;
    const auto* array = value.status.is_bad() ? nullptr : value.value.array_if<String>();
    if (array != nullptr) {
        for (std::size_t i = 0; i < std::min(array->size(), max); ++i) {
            names.push_back((*array)[i].str());
        }
    }
    return names;
}

/// True for a server without this service, or a user without the right to it.
bool is_unreadable(StatusCode status)
{
    return status == status::Bad_ServiceUnsupported || status == status::Bad_UserAccessDenied ||
           status == status::Bad_NotSupported || status == status::Bad_NotImplemented;
}

} // namespace

ReadRequest ServerInfoReader::request() const
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    for (std::size_t i = next_; i < node_count && i - next_ < batch_; ++i) {
        request.nodes_to_read.push_back(value_of(node(i)));
    }
    return request;
}

Result<bool> ServerInfoReader::take(const Result<ReadResponse>& response)
{
    if (!response) {
        // A limit may be smaller than the request that reads it (Part 5, 6.3.11).
        if (response.error() == status::Bad_TooManyOperations && batch_ > 1) {
            batch_ = 1;
            return false;
        }
        return is_unreadable(response.error()) ? Result<bool>{true} : fail(response.error());
    }
    const std::size_t asked = std::min(batch_, node_count - next_);
    if (response->results.size() != asked) {
        return fail(status::Bad_UnknownResponse);
    }
    for (const DataValue& value : response->results) {
        take(next_++, value);
    }
    return next_ == node_count;
}

void ServerInfoReader::take(std::size_t node, const DataValue& value)
{
    if (node == 0) {
        info_.namespaces = names_of(value, max_names_);
        if (info_.namespaces.empty()) {
            info_.namespaces = {std::string{namespace0_uri}};
        }
    } else if (node == 1) {
        info_.servers = names_of(value, max_names_);
    } else if (value.status.is_good()) {
        info_.operation_limits.*limits[node - first_limit].member =
            value.value.value_or<std::uint32_t>(0);
    }
}

bool is_same(const ServerInfo& a, const ServerInfo& b)
{
    return a.namespaces == b.namespaces && a.servers == b.servers &&
           a.operation_limits == b.operation_limits;
}

binary::TypeRegistry types_at(const ServerInfo& info,
                              const std::vector<binary::TypeRegistry::Table>& tables)
{
    binary::TypeRegistry types{standard_types()};
    const auto& uris = info.namespaces;
    for (const binary::TypeRegistry::Table& table : tables) {
        const std::string_view uri = table.empty() ? "" : table.front()->namespace_uri;
        const auto found = std::find(uris.begin(), uris.end(), uri);
        const auto index = static_cast<std::size_t>(found - uris.begin());
        if (found != uris.end() && index <= UINT16_MAX) {
            types.add(static_cast<std::uint16_t>(index), table);
        }
    }
    return types;
}

ReadRequest state_request()
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.nodes_to_read = {value_of(id::Server_ServerStatus_State),
                             value_of(id::Server_ServerStatus_SecondsTillShutdown)};
    return request;
}

bool take_state(const ReadResponse& response, ServerInfo& info)
{
    if (response.results.size() != 2 || response.results[0].status.is_bad()) {
        return false;
    }
    const auto* state = response.results[0].value.get_if<std::int32_t>();
    if (state == nullptr) {
        return false;
    }
    info.state = static_cast<ServerState>(*state);
    info.seconds_till_shutdown = response.results[1].value.value_or<std::uint32_t>(0);
    return true;
}

} // namespace busbar::client::detail
