#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/client/requester.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/types.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

namespace busbar::client {

/// A node as people and configurations name it. A name with namespace URIs stays valid on a server
/// that numbers its namespaces differently after a restart.
///
/// Texts (Part 6, 5.3.1.10 and 5.3.1.11; Part 4, Annex A.2):
///   i=2258, ns=2;s=Pump         a NodeId
///   nsu=urn:acme:machine;s=Pump a NodeId with a namespace URI
///   /Objects/2:Machine/2:Speed  a browse path from the root folder; names as in Part 4's relative
///                               paths, with `<references>`; nsu=urn:acme:machine; may stand for 2:
///   [ns=2;s=Line]/2:Speed       a browse path from any node; in the brackets, & stands before ]
///                               and &
class BUSBAR_API NodeAddress {
public:
    static constexpr std::size_t max_text_length = 65'536;

    /// Names the null NodeId.
    NodeAddress() : NodeAddress{ExpandedNodeId{}} {}
    NodeAddress(NodeId id) : NodeAddress{ExpandedNodeId{std::move(id)}} {}
    NodeAddress(ExpandedNodeId id);
    /// Reads a path as above, which may begin at any node instead of the root folder.
    /// Bad_BrowseNameInvalid if the text is not a path.
    [[nodiscard]] static Result<NodeAddress> path(std::string_view text,
                                                  ExpandedNodeId start = NodeId{0, id::RootFolder});
    /// Reads any of the texts above. Bad_NodeIdInvalid or Bad_BrowseNameInvalid for anything else.
    [[nodiscard]] static Result<NodeAddress> parse(std::string_view text);

    /// A text that parse() reads as this address.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] bool is_path() const { return !path_.empty(); }

    /// Returns the NodeId, if the server need not be asked for it. Bad_NodeIdUnknown if the server
    /// has no such namespace, Bad_ServerIndexInvalid for a node of another server, Bad_NotSupported
    /// for a path.
    [[nodiscard]] Result<NodeId> node_id(const ServerInfo& server) const;
    /// Returns the path in the form of the service. `find_type` returns the NodeId of a
    /// ReferenceType, null if unknown. Errors as node_id, Bad_ReferenceTypeIdInvalid, and
    /// Bad_NotSupported if it is not a path.
    [[nodiscard]] Result<BrowsePath>
    browse_path(const ServerInfo& server,
                FunctionRef<NodeId(const QualifiedName&)> find_type) const;

    friend bool operator==(const NodeAddress& a, const NodeAddress& b)
    {
        return a.id_ == b.id_ && a.path_ == b.path_;
    }

private:
    ExpandedNodeId id_;
    std::string path_; // empty for a NodeId
};

/// The NodeId of `id` on this server; errors as NodeAddress::node_id.
[[nodiscard]] BUSBAR_API Result<NodeId> local_id(const ExpandedNodeId& id,
                                                 const ServerInfo& server);

/// Calls `done` with a NodeId or a status for each address, in the same order; asks the server only
/// for paths (Part 4, 5.9.4), in as few requests as its limits allow. A path with several targets
/// is Bad_TooManyMatches, with none Bad_NoMatch.
///
/// If the server finds none, a name without namespace stands for the only one of that name in any
/// namespace: the path is followed by browsing then. Bad_TooManyMatches if there are several;
/// resolve_nodes() (resolve_nodes.hpp) lists them.
///
/// Names of ReferenceTypes that are not the specification's are looked up on the server. Before the
/// first session the namespaces are unknown: the operation waits for it then, as long as a request
/// does.
BUSBAR_API Operation resolve(Requester& requester, std::vector<NodeAddress> addresses,
                             std::function<void(std::vector<Result<NodeId>>)> done,
                             const ServiceOptions& options = {});

} // namespace busbar::client
