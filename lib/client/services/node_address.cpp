#include <busbar/client/node_address.hpp>

#include <algorithm>
#include <optional>

#include <busbar/binary/relative_path.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::client {

namespace {

using FindNamespace = FunctionRef<std::optional<std::size_t>(std::string_view uri)>;

std::optional<std::size_t> find_namespace(const ServerInfo& server, std::string_view uri)
{
    const auto found = std::find(server.namespaces.begin(), server.namespaces.end(), uri);
    if (found == server.namespaces.end() || found - server.namespaces.begin() > UINT16_MAX) {
        return std::nullopt;
    }
    return static_cast<std::size_t>(found - server.namespaces.begin());
}

/// Returns the path with "2:" for each "nsu=<uri>;" that begins a name. Bad_SyntaxError for an
/// unterminated URI, Bad_NodeIdUnknown for an unknown one.
Result<std::string> with_indices(std::string_view path, FindNamespace find)
{
    std::string result;
    bool at_name = false;
    while (!path.empty()) {
        if (at_name && path.starts_with("nsu=")) {
            const std::size_t end = path.find(';');
            if (end == std::string_view::npos) {
                return fail(status::Bad_SyntaxError);
            }
            const auto index = find(path.substr(4, end - 4));
            if (!index) {
                return fail(status::Bad_NodeIdUnknown);
            }
            result += std::to_string(*index) + ":";
            path.remove_prefix(end + 1);
            at_name = false;
            continue;
        }
        const std::size_t size = path.front() == '&' && path.size() > 1 ? 2 : 1;
        const bool ends_reference = path.front() == '>' || path.front() == '/' ||
                                    path.front() == '.' || path.front() == '<';
        const bool is_flag = at_name && (path.front() == '#' || path.front() == '!');
        at_name = ends_reference || is_flag;
        result += path.substr(0, size);
        path.remove_prefix(size);
    }
    return result;
}

/// Returns whether the text is a path, independent of the server.
bool is_path_text(std::string_view text)
{
    const auto plain = with_indices(text, [](std::string_view) { return std::size_t{1}; });
    return text.size() <= NodeAddress::max_text_length && plain &&
           binary::parse_relative_path(*plain, [](const QualifiedName&) {
               return NodeId{0, id::References};
           }).has_value();
}

std::string bracketed(const std::string& id)
{
    std::string result = "[";
    for (const char c : id) {
        result += c == ']' || c == '&' ? std::string{'&', c} : std::string{c};
    }
    return result + "]";
}

/// Removes "[<id>]" from the front; nothing if it is unterminated.
std::optional<std::string> take_bracketed(std::string_view& text)
{
    std::string id;
    for (std::size_t i = 1; i < text.size(); ++i) {
        if (text[i] == ']') {
            text.remove_prefix(i + 1);
            return id;
        }
        i += text[i] == '&' && i + 1 < text.size() ? 1U : 0U;
        id += text[i];
    }
    return std::nullopt;
}

} // namespace

NodeAddress::NodeAddress(ExpandedNodeId id) : id_{std::move(id)} {}

std::string NodeAddress::text() const
{
    if (!is_path()) {
        return to_string(id_);
    }
    const bool is_from_root = id_ == ExpandedNodeId{NodeId{0, id::RootFolder}};
    return (is_from_root ? std::string{} : bracketed(to_string(id_))) + path_;
}

Result<NodeAddress> NodeAddress::path(std::string_view text, ExpandedNodeId start)
{
    if (!is_path_text(text)) {
        return fail(status::Bad_BrowseNameInvalid);
    }
    NodeAddress address{std::move(start)};
    address.path_ = text;
    return address;
}

Result<NodeAddress> NodeAddress::parse(std::string_view text)
{
    if (!text.empty() && std::string_view{"/.<"}.find(text.front()) != std::string_view::npos) {
        return path(text);
    }
    const bool has_start = text.starts_with('[');
    const auto id_text = has_start ? take_bracketed(text) : std::string{text};
    auto id = id_text ? parse_expanded_node_id(*id_text) : std::nullopt;
    if (!id || id_text->size() > max_text_length) {
        return fail(status::Bad_NodeIdInvalid);
    }
    return has_start ? path(text, *std::move(id)) : NodeAddress{*std::move(id)};
}

Result<NodeId> local_id(const ExpandedNodeId& id, const ServerInfo& server)
{
    if (id.server_index != 0) {
        return fail(status::Bad_ServerIndexInvalid);
    }
    if (id.namespace_uri.empty()) {
        return id.node_id;
    }
    const auto index = find_namespace(server, id.namespace_uri.view());
    if (!index) {
        return fail(status::Bad_NodeIdUnknown);
    }
    NodeId local = id.node_id;
    local.set_namespace_index(static_cast<std::uint16_t>(*index));
    return local;
}

Result<NodeId> NodeAddress::node_id(const ServerInfo& server) const
{
    return is_path() ? fail(status::Bad_NotSupported) : local_id(id_, server);
}

Result<BrowsePath>
NodeAddress::browse_path(const ServerInfo& server,
                         FunctionRef<NodeId(const QualifiedName&)> find_type) const
{
    auto start = is_path() ? local_id(id_, server) : fail(status::Bad_NotSupported);
    if (!start) {
        return fail(start.error());
    }
    const auto text =
        with_indices(path_, [&](std::string_view uri) { return find_namespace(server, uri); });
    auto path = text ? binary::parse_relative_path(*text, find_type) : fail(text.error());
    if (!path) {
        return fail(path.error());
    }
    return BrowsePath{*std::move(start), *std::move(path)};
}

} // namespace busbar::client
