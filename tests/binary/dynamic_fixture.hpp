#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::test {

using binary::DataTypeEntry;
using binary::DynamicArray;
using binary::DynamicType;
using binary::DynamicTypes;
using binary::DynamicValue;
using Shape = StructureDefinitionType;

/// NodeIds of namespace 2: of a DataType, and of its encoding.
inline NodeId type_id(std::uint32_t number)
{
    return NodeId{2, number};
}
inline NodeId encoding_of(std::uint32_t number)
{
    return NodeId{2, number + 1'000};
}

inline StructureField field(const char* name, NodeId type, std::int32_t rank = -1,
                            bool is_optional = false)
{
    StructureField result;
    result.name = name;
    result.data_type = std::move(type);
    result.value_rank = rank;
    result.is_optional = is_optional;
    return result;
}
inline StructureField field(const char* name, std::uint32_t namespace0_type, std::int32_t rank = -1,
                            bool is_optional = false)
{
    return field(name, NodeId{0, namespace0_type}, rank, is_optional);
}

inline DataTypeEntry structure(std::uint32_t number, const char* name, Shape shape,
                               std::initializer_list<StructureField> fields)
{
    const bool is_union = shape == Shape::Union || shape == Shape::UnionWithSubtypedValues;
    StructureDefinition definition;
    definition.default_encoding_id = encoding_of(number);
    definition.base_data_type = NodeId{0, is_union ? id::Union : id::Structure};
    definition.structure_type = shape;
    definition.fields = fields;
    return {type_id(number), name, {}, {}, false, std::move(definition)};
}

inline DataTypeEntry enumeration(std::uint32_t number, const char* name, NodeId base,
                                 std::initializer_list<const char*> names)
{
    EnumDefinition definition;
    for (const char* const each : names) {
        EnumField entry;
        entry.value = static_cast<std::int64_t>(definition.fields.size());
        entry.name = each;
        definition.fields.push_back(std::move(entry));
    }
    return {type_id(number), name, std::move(base), {}, false, std::move(definition)};
}

/// A type that has no definition of its own.
inline DataTypeEntry simple(std::uint32_t number, const char* name, NodeId base,
                            bool is_abstract = false)
{
    return {type_id(number), name, std::move(base), {}, is_abstract, {}};
}

/// The types that the tests use, one of every kind.
namespace types {
inline constexpr std::uint32_t Point = 1;
inline constexpr std::uint32_t Mode = 2;
inline constexpr std::uint32_t Flags = 3;
inline constexpr std::uint32_t Length = 4;
inline constexpr std::uint32_t Shape = 5;
inline constexpr std::uint32_t Measurement = 6;
inline constexpr std::uint32_t Part = 7;
inline constexpr std::uint32_t Tree = 8;
inline constexpr std::uint32_t Container = 9;
inline constexpr std::uint32_t Point3D = 10;
inline constexpr std::uint32_t Empty = 11;
inline constexpr std::uint32_t Choice = 12;
inline constexpr std::uint32_t Bits = 13;
} // namespace types

inline std::vector<DataTypeEntry> plant_types()
{
    DataTypeEntry point3d =
        structure(types::Point3D, "Point3D", Shape::Structure,
                  {field("X", id::Double), field("Y", id::Double), field("Z", id::Double)});
    point3d.base = type_id(types::Point);
    return {
        // In an order in which most types are used before they are there.
        structure(types::Measurement, "Measurement", Shape::StructureWithOptionalFields,
                  {field("At", type_id(types::Point)), field("Comment", id::String, -1, true),
                   field("Mode", type_id(types::Mode)),
                   field("Trace", type_id(types::Point), 1, true)}),
        structure(types::Part, "Part", Shape::Structure,
                  {field("Name", id::String), field("Size", type_id(types::Length)),
                   field("Flags", type_id(types::Flags)), field("Shape", type_id(types::Shape)),
                   field("Corners", type_id(types::Point), 1),
                   field("Grid", type_id(types::Point), 2), field("Counts", id::Int16, 1),
                   field("Matrix", id::Float, 2), field("Anything", id::BaseDataType),
                   field("Bits", type_id(types::Bits))}),
        std::move(point3d),
        structure(types::Point, "Point", Shape::Structure,
                  {field("X", id::Double), field("Y", id::Double)}),
        structure(types::Shape, "Shape", Shape::Union,
                  {field("Radius", id::Double), field("Corner", type_id(types::Point)),
                   field("Path", type_id(types::Point), 1)}),
        structure(types::Tree, "Tree", Shape::Structure,
                  {field("Name", id::String), field("Children", type_id(types::Tree), 1)}),
        structure(types::Container, "Container", Shape::StructureWithSubtypedValues,
                  {field("Any", id::Structure), field("Place", type_id(types::Point), -1, true),
                   field("Amount", id::Number, -1, true),
                   field("Places", type_id(types::Point), 1, true)}),
        structure(types::Choice, "Choice", Shape::UnionWithSubtypedValues,
                  {field("Place", type_id(types::Point), -1, true), field("Text", id::String)}),
        structure(types::Empty, "Empty", Shape::Structure, {}),
        enumeration(types::Mode, "Mode", NodeId{0, id::Enumeration}, {"Off", "Manual", "Auto"}),
        enumeration(types::Flags, "Flags", NodeId{0, id::UInt16}, {"Read", "Write", "Delete"}),
        enumeration(types::Bits, "Bits", NodeId{0, id::OptionSet}, {"A", "B"}),
        simple(types::Length, "Length", NodeId{0, id::Double}),
    };
}

inline const DynamicTypes& plant()
{
    static const DynamicTypes compiled = DynamicTypes::compile(plant_types());
    return compiled;
}

inline DynamicValue make(std::uint32_t type)
{
    return DynamicValue{*plant().find(type_id(type))};
}

inline DynamicValue point(double x, double y)
{
    DynamicValue value = make(types::Point);
    REQUIRE(value.set("X", Variant{x}));
    REQUIRE(value.set("Y", Variant{y}));
    return value;
}

template <typename T>
[[nodiscard]] StatusCode status_of(const Result<T>& result)
{
    return result ? status::Good : result.error();
}

} // namespace busbar::test
