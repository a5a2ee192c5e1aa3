#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/client/requester.hpp>
#include <busbar/core/types.hpp>

namespace busbar::client {

/// A node as people and configurations name it. What names its namespaces by URI survives a server
/// that numbers them anew.
///
/// Texts (Part 6, 5.3.1.10 and 5.3.1.11; Part 4, Annex A.2):
///   i=2258, ns=2;s=Pump         a NodeId
///   nsu=urn:acme:machine;s=Pump a NodeId with a namespace URI
///   /Objects/2:Machine/2:Speed  a browse path from the root folder; names as in Part 4's relative
///                               paths, with <references>; nsu=...: may stand for the index
class NodeAddress {
public:
    NodeAddress() = default;
    NodeAddress(NodeId id);
    NodeAddress(ExpandedNodeId id);
    /// A path as above, which may begin at any node instead of the root folder.
    [[nodiscard]] static Result<NodeAddress> path(std::string_view text,
                                                  NodeId start = NodeId{0, 84});
    /// Any of the texts above. Bad_NodeIdInvalid or Bad_BrowseNameInvalid for anything else.
    [[nodiscard]] static Result<NodeAddress> parse(std::string_view text);

    /// As it was written; parse() takes it again.
    [[nodiscard]] const std::string& text() const { return text_; }
    [[nodiscard]] bool is_path() const { return !path_.empty(); }

    /// The NodeId if no server must be asked: Bad_NodeIdUnknown if the server has no such
    /// namespace, Bad_NotSupported for a path.
    [[nodiscard]] Result<NodeId> node_id(const ServerInfo& server) const;

private:
    friend class NodeResolver;

    std::string text_;
    ExpandedNodeId id_;
    std::string path_;
};

/// Calls `done` with a NodeId or a status for each address, in their order; asks the server only
/// for paths (Part 4, 5.9.4), in as few requests as its limits allow. A path with several targets
/// is Bad_TooManyMatches, with none Bad_NoMatch.
void resolve(Requester& requester, std::vector<NodeAddress> addresses,
             std::function<void(std::vector<Result<NodeId>>)> done, RequestOptions options = {});

} // namespace busbar::client
