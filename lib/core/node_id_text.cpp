#include <busbar/core/node_id.hpp>

#include <charconv>
#include <optional>
#include <vector>

#include "base64.hpp"

namespace busbar {

namespace {

template <typename T>
std::optional<T> whole_number(std::string_view text)
{
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) {
        return std::nullopt;
    }
    return value;
}

std::optional<NodeId> parse_identifier(std::uint16_t index, char kind, std::string_view text)
{
    switch (kind) {
    case 'i':
        if (const auto number = whole_number<std::uint32_t>(text)) {
            return NodeId{index, *number};
        }
        return std::nullopt;
    case 's':
        return NodeId{index, String{text}};
    case 'g':
        if (const auto guid = Guid::parse(text)) {
            return NodeId{index, *guid};
        }
        return std::nullopt;
    case 'b':
        if (const auto bytes = detail::from_base64(text)) {
            return NodeId{index, ByteString{std::span{*bytes}}};
        }
        return std::nullopt;
    default:
        return std::nullopt;
    }
}

} // namespace

Result<NodeId> NodeId::parse(std::string_view text)
{
    std::uint16_t index = 0;
    if (text.starts_with("ns=")) {
        const std::size_t end = text.find(';');
        const auto number = whole_number<std::uint16_t>(text.substr(3, end - 3));
        if (end == std::string_view::npos || !number) {
            return fail(status::Bad_NodeIdInvalid);
        }
        index = *number;
        text.remove_prefix(end + 1);
    }
    if (text.size() < 2 || text[1] != '=') {
        return fail(status::Bad_NodeIdInvalid);
    }
    if (auto id = parse_identifier(index, text[0], text.substr(2))) {
        return *std::move(id);
    }
    return fail(status::Bad_NodeIdInvalid);
}

std::string to_string(const NodeId& id)
{
    std::string text;
    if (id.namespace_index() != 0) {
        text = "ns=" + std::to_string(id.namespace_index()) + ";";
    }
    switch (id.id_type()) {
    case IdType::Numeric:
        return text + "i=" + std::to_string(id.numeric());
    case IdType::String:
        return text + "s=" + id.string().str();
    case IdType::Guid:
        return text + "g=" + to_string(id.guid());
    case IdType::Opaque:
        return text + "b=" + detail::to_base64(id.opaque().span());
    }
    return text;
}

std::string to_string(const ExpandedNodeId& id)
{
    std::string text;
    if (id.server_index != 0) {
        text = "svr=" + std::to_string(id.server_index) + ";";
    }
    if (!id.namespace_uri.empty()) {
        text += "nsu=" + id.namespace_uri.str() + ";";
    }
    return text + to_string(id.node_id);
}

} // namespace busbar
