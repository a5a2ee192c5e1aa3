#include <busbar/core/node_id.hpp>

#include <memory>
#include <new>

namespace busbar {

NodeId::NodeId(std::uint16_t namespace_index, String identifier)
    : namespace_index_{namespace_index}, type_{IdType::String}, string_{std::move(identifier)}
{
}

NodeId::NodeId(std::uint16_t namespace_index, const Guid& identifier)
    : namespace_index_{namespace_index}, type_{IdType::Guid}, guid_{identifier}
{
}

NodeId::NodeId(std::uint16_t namespace_index, ByteString identifier)
    : namespace_index_{namespace_index}, type_{IdType::Opaque}, opaque_{std::move(identifier)}
{
}

NodeId::NodeId(const NodeId& other) : numeric_{0}
{
    copy(other);
}

NodeId::NodeId(NodeId&& other) noexcept : numeric_{0}
{
    take(other);
}

NodeId& NodeId::operator=(const NodeId& other)
{
    if (this != &other) {
        destroy();
        copy(other);
    }
    return *this;
}

NodeId& NodeId::operator=(NodeId&& other) noexcept
{
    if (this != &other) {
        destroy();
        take(other);
    }
    return *this;
}

bool NodeId::is_null() const
{
    if (namespace_index_ != 0) {
        return false;
    }
    switch (type_) {
    case IdType::Numeric:
        return numeric_ == 0;
    case IdType::String:
        return string_.empty();
    case IdType::Guid:
        return guid_ == Guid{};
    case IdType::Opaque:
        return opaque_.empty();
    }
    return false;
}

void NodeId::copy(const NodeId& other)
{
    namespace_index_ = other.namespace_index_;
    type_ = other.type_;
    switch (type_) {
    case IdType::Numeric:
        numeric_ = other.numeric_;
        break;
    case IdType::String:
        std::construct_at(&string_, other.string_);
        break;
    case IdType::Guid:
        std::construct_at(&guid_, other.guid_);
        break;
    case IdType::Opaque:
        std::construct_at(&opaque_, other.opaque_);
        break;
    }
}

void NodeId::take(NodeId& other) noexcept
{
    namespace_index_ = other.namespace_index_;
    type_ = other.type_;
    switch (type_) {
    case IdType::Numeric:
        numeric_ = other.numeric_;
        break;
    case IdType::String:
        std::construct_at(&string_, std::move(other.string_));
        break;
    case IdType::Guid:
        std::construct_at(&guid_, other.guid_);
        break;
    case IdType::Opaque:
        std::construct_at(&opaque_, std::move(other.opaque_));
        break;
    }
}

bool operator==(const NodeId& a, const NodeId& b)
{
    return a.type_ == b.type_ && a.namespace_index_ == b.namespace_index_ &&
           (a <=> b) == std::strong_ordering::equal;
}

std::strong_ordering operator<=>(const NodeId& a, const NodeId& b)
{
    if (const auto order = a.namespace_index_ <=> b.namespace_index_; std::is_neq(order)) {
        return order;
    }
    if (const auto order = a.type_ <=> b.type_; std::is_neq(order)) {
        return order;
    }
    switch (a.type_) {
    case IdType::Numeric:
        return a.numeric_ <=> b.numeric_;
    case IdType::String:
        return a.string_ <=> b.string_;
    case IdType::Guid:
        return a.guid_ <=> b.guid_;
    case IdType::Opaque:
        return a.opaque_ <=> b.opaque_;
    }
    return std::strong_ordering::equal;
}

namespace {

/// Multiplies and folds (the finaliser of a 64-bit mixing hash).
std::uint64_t mix(std::uint64_t value)
{
    value ^= value >> 32U;
    value *= 0x9E3779B97F4A7C15U;
    value ^= value >> 29U;
    return value;
}

std::uint64_t hash_bytes(const char* data, std::size_t size, std::uint64_t seed)
{
    std::uint64_t hash = seed ^ size;
    while (size >= 8) {
        std::uint64_t word = 0;
        std::memcpy(&word, data, sizeof word);
        hash = mix(hash ^ word);
        data += sizeof word;
        size -= sizeof word;
    }
    std::uint64_t tail = 0;
    for (std::size_t i = 0; i < size; ++i) {
        tail = tail << 8U | static_cast<unsigned char>(data[i]);
    }
    return mix(hash ^ tail);
}

} // namespace

std::uint64_t hash_value(const NodeId& id)
{
    const std::uint64_t seed = std::uint64_t{id.namespace_index()} << 32U |
                               static_cast<std::uint64_t>(id.id_type()) << 48U;
    switch (id.id_type()) {
    case IdType::Numeric:
        return mix(seed ^ id.numeric());
    case IdType::String:
        return hash_bytes(id.string().view().data(), id.string().size(), seed);
    case IdType::Guid:
        return hash_bytes(reinterpret_cast<const char*>(&id.guid()), sizeof(Guid), seed);
    case IdType::Opaque:
        return hash_bytes(reinterpret_cast<const char*>(id.opaque().span().data()),
                          id.opaque().size(), seed);
    }
    return 0;
}

} // namespace busbar
