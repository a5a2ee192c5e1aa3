#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/string.hpp>

namespace busbar {

namespace binary {
class Reader;
class Writer;
} // namespace binary

/// An encoding id in constant data; its namespace is that of the type it belongs to.
struct StaticId {
    std::uint32_t numeric{0};
    /// If not empty, the id is this string and not a number.
    std::string_view string;

    /// Returns the id in this namespace.
    [[nodiscard]] NodeId in(std::uint16_t namespace_index) const
    {
        return string.empty() ? NodeId{namespace_index, numeric}
                              : NodeId{namespace_index, String{string}};
    }
};

/// Describes a generated structure, as constant data: `Range::type`. The functions work on objects
/// of that C++ type; none of the pointers is null.
struct StructureType {
    std::string_view name;
    std::string_view namespace_uri;
    StaticId type_id;
    StaticId binary_encoding_id;
    std::size_t size;
    void* (*create)();
    void* (*copy)(const void* object);
    void (*destroy)(void* object);
    bool (*equal)(const void* a, const void* b);
    void (*encode)(binary::Writer& writer, const void* object);
    void (*decode)(binary::Reader& reader, void* object);
};

/// A structure that the generator made, or one that is declared as those are: with a `type`.
template <typename T>
concept GeneratedStructure = std::is_same_v<std::remove_cvref_t<decltype(T::type)>, StructureType>;

/// ExtensionObject (Part 6, 5.2.2.15): a structure with the NodeId of its encoding.
///
/// A body whose type the decoder knew is a C++ object; any other is kept as the bytes it came in
/// and is encoded again byte for byte. Thread-compatible.
class BUSBAR_API ExtensionObject {
public:
    /// The form of the body; Object stands for a decoded structure.
    enum class Body : std::uint8_t { None, Binary, Xml, Object };

    ExtensionObject() = default;
    /// Holds a copy of `value`, as from() does.
    template <GeneratedStructure T>
    explicit ExtensionObject(T value, std::uint16_t namespace_index = 0)
        : ExtensionObject{from(std::move(value), namespace_index)}
    {
    }
    ExtensionObject(const ExtensionObject& other);
    ExtensionObject(ExtensionObject&& other) noexcept;
    ExtensionObject& operator=(const ExtensionObject& other);
    ExtensionObject& operator=(ExtensionObject&& other) noexcept;
    ~ExtensionObject();

    /// Holds a copy of `value`. `namespace_index` is the index of the type's namespace in the
    /// server.
    template <typename T>
    [[nodiscard]] static ExtensionObject from(T value, std::uint16_t namespace_index = 0)
    {
        return adopt(T::type, new T(std::move(value)),
                     T::type.binary_encoding_id.in(namespace_index));
    }
    /// Takes ownership of `object`, which `type.create` or `type.copy` made.
    [[nodiscard]] static ExtensionObject adopt(const StructureType& type, void* object,
                                               NodeId encoding_id);
    /// Holds a body that is not decoded, or none.
    [[nodiscard]] static ExtensionObject from_binary(NodeId encoding_id, ByteString body);
    [[nodiscard]] static ExtensionObject from_xml(NodeId encoding_id, XmlElement body);
    [[nodiscard]] static ExtensionObject from_id(NodeId encoding_id);

    /// The encoding's NodeId; null for a null ExtensionObject.
    [[nodiscard]] const NodeId& encoding_id() const { return encoding_id_; }
    [[nodiscard]] Body body() const { return body_; }
    [[nodiscard]] bool is_null() const { return body_ == Body::None && encoding_id_.is_null(); }

    /// The object if it is a T, else null.
    template <typename T>
    [[nodiscard]] const T* get_if() const
    {
        return type_ == &T::type ? static_cast<const T*>(object_) : nullptr;
    }
    /// The type of the object, null unless body() is Object.
    [[nodiscard]] const StructureType* type() const { return type_; }
    [[nodiscard]] const void* object() const { return object_; }
    /// The bytes of a Binary body, else null.
    [[nodiscard]] const ByteString& binary() const { return binary_; }
    /// The text of an Xml body, else null.
    [[nodiscard]] const XmlElement& xml() const { return xml_; }

    friend BUSBAR_API bool operator==(const ExtensionObject& a, const ExtensionObject& b);

private:
    NodeId encoding_id_;
    const StructureType* type_{nullptr};
    void* object_{nullptr};
    ByteString binary_;
    XmlElement xml_;
    Body body_{Body::None};
};

namespace detail {

/// The functions of a StructureType for a C++ type with `encode` and `decode` overloads.
template <typename T>
struct StructureFunctions {
    static void* create() { return new T(); }
    static void* copy(const void* object) { return new T(*static_cast<const T*>(object)); }
    static void destroy(void* object) { delete static_cast<T*>(object); }
    static bool equal(const void* a, const void* b)
    {
        return *static_cast<const T*>(a) == *static_cast<const T*>(b);
    }
    static void encode_object(binary::Writer& writer, const void* object)
    {
        encode(writer, *static_cast<const T*>(object));
    }
    static void decode_object(binary::Reader& reader, void* object)
    {
        decode(reader, *static_cast<T*>(object));
    }
};

template <typename T>
constexpr StructureType make_structure_type(std::string_view name, std::string_view namespace_uri,
                                            StaticId type_id, StaticId binary_encoding_id)
{
    using F = StructureFunctions<T>;
    return {name,    namespace_uri, type_id,  binary_encoding_id, sizeof(T),       F::create,
            F::copy, F::destroy,    F::equal, F::encode_object,   F::decode_object};
}

} // namespace detail

} // namespace busbar
