#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string_view>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/guid.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/string.hpp>

namespace busbar {

/// IdType (Part 3, 8.2.3).
enum class IdType : std::uint8_t { Numeric = 0, String = 1, Guid = 2, Opaque = 3 };

/// NodeId (Part 3, 8.2; Part 6, 5.2.2.9) in 24 bytes. The default is the null NodeId, i=0.
class BUSBAR_API NodeId {
public:
    NodeId() : numeric_{0} {}
    NodeId(std::uint16_t namespace_index, std::uint32_t identifier)
        : namespace_index_{namespace_index}, numeric_{identifier}
    {
    }
    NodeId(std::uint16_t namespace_index, String identifier);
    NodeId(std::uint16_t namespace_index, const char* identifier)
        : NodeId{namespace_index, String{identifier}}
    {
    }
    NodeId(std::uint16_t namespace_index, const Guid& identifier);
    NodeId(std::uint16_t namespace_index, ByteString identifier);
    NodeId(const NodeId& other);
    NodeId(NodeId&& other) noexcept;
    NodeId& operator=(const NodeId& other);
    NodeId& operator=(NodeId&& other) noexcept;
    ~NodeId() { destroy(); }

    /// Reads "i=85", "ns=2;s=Name", "ns=1;g=<guid>", "ns=1;b=<base64>" (Part 6, 5.3.1.10); else
    /// Bad_NodeIdInvalid.
    [[nodiscard]] static Result<NodeId> parse(std::string_view text);

    [[nodiscard]] std::uint16_t namespace_index() const { return namespace_index_; }
    /// Moves the id to another namespace.
    void set_namespace_index(std::uint16_t index) { namespace_index_ = index; }
    [[nodiscard]] IdType id_type() const { return type_; }
    [[nodiscard]] bool is_numeric() const { return type_ == IdType::Numeric; }

    /// The identifier. Call only the function of the NodeId's own IdType.
    [[nodiscard]] std::uint32_t numeric() const { return numeric_; }
    [[nodiscard]] const String& string() const { return string_; }
    [[nodiscard]] const Guid& guid() const { return guid_; }
    [[nodiscard]] const ByteString& opaque() const { return opaque_; }

    /// True for namespace 0 with an identifier that is zero, null or empty (Part 3, 8.2.4).
    [[nodiscard]] bool is_null() const;
    /// True if this is the given node of namespace 0.
    [[nodiscard]] bool is(std::uint32_t namespace0_identifier) const
    {
        return type_ == IdType::Numeric && namespace_index_ == 0 &&
               numeric_ == namespace0_identifier;
    }

    friend BUSBAR_API bool operator==(const NodeId& a, const NodeId& b);
    friend BUSBAR_API std::strong_ordering operator<=>(const NodeId& a, const NodeId& b);

private:
    /// Defined here to be inlined, since every item of every request has a NodeId.
    void destroy()
    {
        if (type_ == IdType::String) {
            string_.~String();
        } else if (type_ == IdType::Opaque) {
            opaque_.~ByteString();
        }
    }
    void copy(const NodeId& other);
    void take(NodeId& other) noexcept;

    std::uint16_t namespace_index_{0};
    IdType type_{IdType::Numeric};
    union {
        std::uint32_t numeric_;
        String string_;
        Guid guid_;
        ByteString opaque_;
    };
};

/// The text form that NodeId::parse reads.
[[nodiscard]] BUSBAR_API std::string to_string(const NodeId& id);
/// Equal NodeIds have equal hashes; the same in every run.
[[nodiscard]] BUSBAR_API std::uint64_t hash_value(const NodeId& id);

/// ExpandedNodeId (Part 4, 7.16; Part 6, 5.2.2.10).
struct ExpandedNodeId {
    NodeId node_id;
    /// If not null, it replaces the namespace index, which is then 0.
    String namespace_uri;
    std::uint32_t server_index{0};

    ExpandedNodeId() = default;
    ExpandedNodeId(NodeId id) : node_id{std::move(id)} {}
    ExpandedNodeId(NodeId id, String uri, std::uint32_t server = 0)
        : node_id{std::move(id)}, namespace_uri{std::move(uri)}, server_index{server}
    {
    }

    /// True if it names a node of this server by namespace index.
    [[nodiscard]] bool is_local() const { return server_index == 0 && namespace_uri.empty(); }

    friend bool operator==(const ExpandedNodeId&, const ExpandedNodeId&) = default;
    friend auto operator<=>(const ExpandedNodeId&, const ExpandedNodeId&) = default;
};

/// "svr=1;nsu=urn:x;i=5".
[[nodiscard]] BUSBAR_API std::string to_string(const ExpandedNodeId& id);

} // namespace busbar

template <>
struct std::hash<busbar::NodeId> {
    std::size_t operator()(const busbar::NodeId& id) const noexcept
    {
        return static_cast<std::size_t>(busbar::hash_value(id));
    }
};
