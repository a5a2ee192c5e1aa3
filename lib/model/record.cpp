#include "record.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

namespace busbar::model::detail {

namespace {

std::span<const std::byte> as_bytes(std::string_view text)
{
    return std::as_bytes(std::span{text.data(), text.size()});
}

std::string_view as_text(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the bytes of the identifier that go into the text block; none for a number.
std::string_view identifier_text(const NodeId& id)
{
    switch (id.id_type()) {
    case IdType::String:
        return id.string().view();
    case IdType::Opaque:
        return as_text(id.opaque().span());
    case IdType::Guid:
        return as_text(std::as_bytes(std::span{&id.guid(), 1}));
    case IdType::Numeric:
        break;
    }
    return {};
}

} // namespace

NodeId NodeRecord::node_id() const
{
    const std::string_view identifier{text.get(), id};
    switch (id_type) {
    case IdType::String:
        return NodeId{id_namespace, String::borrow(identifier)};
    case IdType::Opaque:
        return NodeId{id_namespace, ByteString::borrow(as_bytes(identifier))};
    case IdType::Guid: {
        Guid guid;
        std::memcpy(&guid, text.get(), sizeof guid);
        return NodeId{id_namespace, guid};
    }
    case IdType::Numeric:
        break;
    }
    return NodeId{id_namespace, id};
}

void NodeRecord::set_names(const NodeId& id_of_node, const QualifiedName& browse_name,
                           NodeLinks& links)
{
    const std::string_view identifier = identifier_text(id_of_node);
    const std::string_view name_text = browse_name.name.view();
    id_namespace = id_of_node.namespace_index();
    id_type = id_of_node.id_type();
    id = id_of_node.is_numeric() ? id_of_node.numeric()
                                 : static_cast<std::uint32_t>(identifier.size());
    browse_namespace = browse_name.namespace_index;
    links.name_size = static_cast<std::uint32_t>(name_text.size());
    const bool shares = identifier.ends_with(name_text);
    text = std::make_unique<char[]>(identifier.size() + (shares ? 0 : name_text.size()));
    std::copy(identifier.begin(), identifier.end(), text.get());
    links.name_offset =
        static_cast<std::uint32_t>(identifier.size() - (shares ? name_text.size() : 0));
    if (!shares) {
        std::copy(name_text.begin(), name_text.end(), text.get() + links.name_offset);
    }
}

bool NodeRecord::has_id(const NodeId& other) const
{
    if (id_type != other.id_type() || id_namespace != other.namespace_index()) {
        return false;
    }
    if (other.is_numeric()) {
        return id == other.numeric();
    }
    return std::string_view{text.get(), id} == identifier_text(other);
}

Extra& NodeRecord::make_extra()
{
    if (extra == nullptr) {
        extra = std::make_unique<Extra>();
    }
    return *extra;
}

} // namespace busbar::model::detail
