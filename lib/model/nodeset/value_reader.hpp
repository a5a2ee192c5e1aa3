#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/core/types.hpp>

#include "data_types.hpp"

namespace busbar::nodeset {

/// Turns the XML form of values (Part 6, 5.3) into C++ values. Used for one value; remembers the
/// first error.
///
/// Structures are encoded in OPC UA Binary by the definitions in `types`. A structure of an unknown
/// type stays XML.
class XmlValueReader {
public:
    /// `namespaces` has the index in the result for each namespace index in the text. `fields_left`
    /// counts down the fields of structures: types may be nested so that few bytes stand for very
    /// many.
    XmlValueReader(const DataTypeTable& types, const std::vector<std::uint16_t>& namespaces,
                   std::size_t& fields_left)
        : types_{types}, namespaces_{namespaces}, fields_left_{fields_left}
    {
    }

    /// Takes these names for NodeIds, as files of some tools have the aliases of DataTypes in
    /// Arguments. `names` must outlive this object.
    void take_names(const std::unordered_map<std::string, NodeId>& names) { published_ = &names; }
    /// Returns the first NodeId that was a name, null if none was.
    [[nodiscard]] const Element* named() const { return named_; }

    /// Returns the value of the element in <Value>, such as <ListOfInt32>.
    [[nodiscard]] Variant variant(const Element& xml) { return variant(xml, 0); }
    /// The error and its place; empty and 0 if there is none.
    [[nodiscard]] const std::string& error() const { return error_; }
    [[nodiscard]] std::uint32_t error_line() const { return error_line_; }

private:
    static constexpr unsigned max_depth = 32;

    void fail(const Element& xml, const std::string& expected);

    [[nodiscard]] Variant variant(const Element& xml, unsigned depth);
    [[nodiscard]] Variant matrix(const Element& xml, unsigned depth);
    [[nodiscard]] Variant of_type(const Element& xml, std::string_view name, bool is_list,
                                  unsigned depth);
    template <typename T>
    [[nodiscard]] Variant values(const Element& xml, bool is_list, unsigned depth);
    template <typename T>
    [[nodiscard]] T read_child(const Element& xml, std::string_view name, unsigned depth)
    {
        T value{};
        if (const Element* const child = xml.child(name)) {
            read(*child, value, depth);
        }
        return value;
    }

    template <typename T>
    requires(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) void read(const Element& xml,
                                                                            T& value, unsigned);
    void read(const Element& xml, bool& value, unsigned);
    void read(const Element& xml, String& value, unsigned);
    void read(const Element& xml, XmlElement& value, unsigned);
    void read(const Element& xml, DateTime& value, unsigned);
    void read(const Element& xml, Guid& value, unsigned);
    void read(const Element& xml, ByteString& value, unsigned);
    void read(const Element& xml, NodeId& value, unsigned);
    void read(const Element& xml, ExpandedNodeId& value, unsigned);
    void read(const Element& xml, StatusCode& value, unsigned depth);
    void read(const Element& xml, QualifiedName& value, unsigned depth);
    void read(const Element& xml, busbar::LocalizedText& value, unsigned depth);
    void read(const Element& xml, ExtensionObject& value, unsigned depth);
    void read(const Element& xml, DataValue& value, unsigned depth);
    void read(const Element& xml, Variant& value, unsigned depth);
    [[nodiscard]] std::uint16_t mapped(const Element& xml, std::uint16_t namespace_index);

    /// The facts about a DataType that each of its structures needs.
    struct Structure {
        Kind kind{Kind::Unknown};
        bool is_union{false};
        bool has_optional{false};
        std::vector<const Field*> fields;
        std::vector<FieldForm> forms; // of the fields
    };

    // Structures (structure_reader.cpp)
    [[nodiscard]] const Structure& structure_of(const DataType& type);
    [[nodiscard]] const DataType* structure_type(const Element& xml, const Element& structure);
    void encode_structure(binary::Writer& writer, const Element& xml, const DataType& type,
                          unsigned depth);
    void encode_union(binary::Writer& writer, const Element& xml, const Structure& type,
                      unsigned depth);
    void encode_field(binary::Writer& writer, const Element* found, const Field& field,
                      const FieldForm& form, unsigned depth);
    void encode_matrix(binary::Writer& writer, const Element& xml, const Field& field,
                       const FieldForm& form, unsigned depth);
    void encode_scalar(binary::Writer& writer, const Element& xml, const Field& field,
                       const FieldForm& form, unsigned depth);
    void encode_built_in(binary::Writer& writer, const Element& xml, BuiltInType type,
                         unsigned depth);
    void encode_enumeration(binary::Writer& writer, const Element& xml, const NodeId& type);
    [[nodiscard]] std::uint32_t encoding_mask(const Element& xml,
                                              const std::vector<const Field*>& fields);

    const DataTypeTable& types_;
    const std::vector<std::uint16_t>& namespaces_;
    std::size_t& fields_left_;
    std::unordered_map<const DataType*, Structure> structures_;
    const std::unordered_map<std::string, NodeId>* published_{nullptr};
    const Element* named_{nullptr};
    std::string error_;
    std::uint32_t error_line_{0};
};

} // namespace busbar::nodeset
