#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/core/types.hpp>

#include "data_types.hpp"
#include "xml_out.hpp"

namespace busbar::nodeset {

/// Writes xs:boolean, integers, xs:float and xs:double; the fewest digits that restore the number.
template <typename T>
[[nodiscard]] std::string number_text(T value)
{
    if constexpr (std::is_same_v<T, bool>) {
        return value ? "true" : "false";
    } else {
        if constexpr (std::is_floating_point_v<T>) {
            if (std::isnan(value)) {
                return "NaN";
            }
            if (std::isinf(value)) {
                return value < 0 ? "-INF" : "INF";
            }
        }
        char text[64];
        return {text, std::to_chars(text, text + sizeof text, value).ptr};
    }
}

/// Maps the namespaces of a server to the indices of a file, in the order of their first use.
class FileNamespaces {
public:
    [[nodiscard]] std::uint16_t operator()(std::uint16_t index);
    [[nodiscard]] NodeId operator()(NodeId id);
    /// The server's indices, with that of OPC UA itself first.
    [[nodiscard]] const std::vector<std::uint16_t>& used() const { return used_; }

private:
    std::vector<std::uint16_t> used_{0};
    std::unordered_map<std::uint16_t, std::uint16_t> local_{{0, 0}};
};

/// Writes values in their XML form (Part 6, 5.3), which XmlValueReader reads.
class ValueWriter {
public:
    ValueWriter(const DataTypeTable& types, FileNamespaces& namespaces, XmlOut& out)
        : types_{types}, namespaces_{namespaces}, out_{out}
    {
    }

    /// The element for a value that is not null, such as <ListOfInt32>.
    void variant(const Variant& value);

private:
    template <typename T>
    void element(std::string_view name, const T& value)
    {
        out_.begin(name);
        bool is_null = false;
        if constexpr (std::is_base_of_v<String, T> || std::is_same_v<T, ByteString>) {
            is_null = value.is_null();
        }
        if (is_null) {
            say_nil();
        } else {
            contents(value);
        }
        out_.end();
    }
    void say_nil();
    template <typename T>
    void list(std::string_view name, const Array<T>& values);
    void matrix(const Variant& value);

    template <typename T>
    requires std::is_arithmetic_v<T>
    void contents(T value) { out_.text(number_text(value)); }
    void contents(const String& value) { out_.text(value.view()); }
    void contents(const XmlElement& value);
    void contents(const DateTime& value);
    void contents(const Guid& value) { out_.element("String", to_string(value)); }
    void contents(const ByteString& value);
    void contents(const NodeId& value);
    void contents(const ExpandedNodeId& value);
    void contents(const StatusCode& value);
    void contents(const QualifiedName& value);
    void contents(const busbar::LocalizedText& value);
    void contents(const ExtensionObject& value);
    void contents(const DataValue& value);
    void contents(const Variant& value);

    // Structures (structure_writer.cpp)
    void body(const ExtensionObject& value);
    [[nodiscard]] bool structure_body(const DataType& type, const ByteString& bytes);
    void structure(binary::Reader& reader, std::string_view name, const DataType& type);
    void fields(binary::Reader& reader, const DataType& type);
    void union_field(binary::Reader& reader, const std::vector<const Field*>& fields);
    void field(binary::Reader& reader, const Field& field);
    void matrix_field(binary::Reader& reader, const Field& field, std::string_view element_name);
    void scalar(binary::Reader& reader, std::string_view name, const Field& field);

    const DataTypeTable& types_;
    FileNamespaces& namespaces_;
    XmlOut& out_;
    unsigned depth_{0};
    /// Counts for the outermost structure: types may be nested so that few bytes stand for very
    /// many fields.
    std::size_t fields_left_{0};
};

} // namespace busbar::nodeset
