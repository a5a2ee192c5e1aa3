#pragma once

#include <string>
#include <utility>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/controller/value_shape.hpp>
#include <busbar/model/data_types.hpp>

#include "model/model_fixture.hpp"

namespace busbar::test {

using controller::ArrayUse;
using controller::MappingArray;
using controller::ShapeError;
using controller::ShapeLimits;
using controller::ShapeRefusal;
using controller::ValueDeclaration;
using controller::ValueShape;

/// "AbstractType" and so on by number, for messages.
inline int number(ShapeError error)
{
    return static_cast<int>(error);
}

/// An AddressSpace with types of its own, and verbs that make shapes of them.
struct ShapeFixture : model::ModelFixture {
    model::DataTypes data_types;

    [[nodiscard]] NodeId own(const char* name) const { return NodeId{ns, String{name}}; }

    static StructureField field(const char* name, NodeId type, std::int32_t rank = -1,
                                Array<std::uint32_t> dimensions = {})
    {
        StructureField made;
        made.name = name;
        made.data_type = std::move(type);
        made.value_rank = rank;
        made.array_dimensions = std::move(dimensions);
        return made;
    }
    NodeId add_structure(const char* name, Array<StructureField> fields,
                         StructureDefinitionType kind = StructureDefinitionType::Structure,
                         const NodeId& base = NodeId{0, id::Structure})
    {
        StructureDefinition definition;
        definition.structure_type = kind;
        definition.fields = std::move(fields);
        model::add_structure_type(space, named(name, space.find(base)), std::move(definition))
            .value();
        return own(name);
    }
    NodeId add_enumeration(const char* name, std::vector<std::int64_t> values, NodeId base = {})
    {
        EnumDefinition definition;
        for (const std::int64_t value : values) {
            definition.fields.emplace_back();
            definition.fields.back().name = String{"V" + std::to_string(value)};
            definition.fields.back().value = value;
        }
        if (base.is_null()) {
            base = NodeId{0, id::Enumeration};
        }
        model::add_enumeration_type(space, named(name, space.find(base)), definition).value();
        return own(name);
    }
    NodeId add_subtype(const char* name, const NodeId& base)
    {
        space.add_data_type(named(name, space.find(base)), {}).value();
        return own(name);
    }

    Expected<ValueShape, ShapeRefusal> try_shape(const ValueDeclaration& declaration,
                                                 std::vector<MappingArray> arrays = {},
                                                 const ShapeLimits& limits = {})
    {
        return ValueShape::of(space, data_types.of(space), declaration, arrays, limits);
    }
    ValueShape shape(const ValueDeclaration& declaration, std::vector<MappingArray> arrays = {},
                     const ShapeLimits& limits = {})
    {
        return try_shape(declaration, std::move(arrays), limits).value();
    }
    /// Why there is no shape; -1 if there is one.
    int error(const ValueDeclaration& declaration, const ShapeLimits& limits = {})
    {
        const auto made = try_shape(declaration, {}, limits);
        return made ? -1 : number(made.error().error);
    }
};

[[nodiscard]] inline std::vector<std::string> paths(const ValueShape& shape)
{
    std::vector<std::string> all;
    for (std::size_t i = 0; i < shape.leaf_count(); ++i) {
        all.push_back(shape.leaf_path(i));
    }
    return all;
}

/// A value whose Int32 leaves are 1, 2, 3 and so on.
[[nodiscard]] inline Result<Variant> counted(const ValueShape& shape,
                                             const Variant* previous = nullptr)
{
    return shape.assemble(previous, [&](std::size_t leaf, void* value) -> StatusCode {
        if (shape.leaf_type(leaf).built_in == BuiltInType::Int32) {
            *static_cast<std::int32_t*>(value) = static_cast<std::int32_t>(leaf + 1);
        }
        return status::Good;
    });
}

/// The Int32 leaves of a value.
[[nodiscard]] inline Result<std::vector<std::int32_t>> leaves(const ValueShape& shape,
                                                              const Variant& value)
{
    std::vector<std::int32_t> all;
    const StatusCode status =
        shape.take_apart(value, [&](std::size_t leaf, const void* at) -> StatusCode {
            if (shape.leaf_type(leaf).built_in == BuiltInType::Int32) {
                all.push_back(*static_cast<const std::int32_t*>(at));
            }
            return status::Good;
        });
    return status.is_good() ? Result<std::vector<std::int32_t>>{all} : fail(status);
}

} // namespace busbar::test
