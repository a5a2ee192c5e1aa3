#include <busbar/controller/machine_types.hpp>

#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/model/plcopen.hpp>
#include <busbar/types/ids.hpp>

#include "shape.hpp"

namespace busbar::controller {

namespace {

/// Returns the DataType of OPC 30000 for an elementary type; 0 if it has none there.
constexpr std::uint32_t plcopen_type(ElementaryType type)
{
    switch (type) {
    case ElementaryType::Byte:
        return 3001;
    case ElementaryType::Word:
        return 3002;
    case ElementaryType::Dword:
        return 3003;
    case ElementaryType::Lword:
        return 3004;
    case ElementaryType::Time:
        return 3005;
    case ElementaryType::Date:
        return 3007;
    case ElementaryType::TimeOfDay:
        return 3008;
    case ElementaryType::DateAndTime:
        return 3010;
    case ElementaryType::String:
        return 3013;
    default:
        return 0;
    }
}

constexpr std::uint32_t plcopen_byte = 3001;

Array<EnumField> fields_of(const std::vector<Enumerator>& enumerators)
{
    Array<EnumField> fields;
    for (const Enumerator& enumerator : enumerators) {
        EnumField field;
        field.value = enumerator.value;
        field.name = String{enumerator.name};
        field.display_name = LocalizedText{String{enumerator.name}};
        fields.push_back(std::move(field));
    }
    return fields;
}

Problem type_problem(const ProgramTypes& program, const DerivedType& type, StatusCode code)
{
    const auto index = &type - program.program().types.data();
    return {code, "types[" + std::to_string(index) + "] (" + printable(type.name) + ")",
            "cannot be made a DataType"};
}

/// Prefix of the NodeIds of types.
const std::string type_id = "Types/";

} // namespace

MachineTypeOptions nj501_types()
{
    return {ElementaryTypes::BuiltIn, false};
}

MachineTypeOptions nx102_types()
{
    return nj501_types();
}

MachineDataType data_type_of(ElementaryType type, ElementaryTypes choice,
                             std::uint16_t plcopen_namespace)
{
    const BuiltInType built_in = built_in_type_of(type, choice);
    const std::uint32_t plcopen = plcopen_type(type);
    if (choice == ElementaryTypes::Plcopen && plcopen != 0) {
        return {NodeId{plcopen_namespace, plcopen}, built_in};
    }
    // A built-in type's DataType has the type's own number (Part 6, 5.1.2).
    return {NodeId{0, static_cast<std::uint32_t>(built_in)}, built_in};
}

MachineTypes::MachineTypes(const model::SpaceReader& space, std::uint16_t namespace_index,
                           const MachineTypeOptions& options)
    : options_{options}, namespace_index_{namespace_index}
{
    options_.elementary = elementary_in(space, options);
    if (options_.elementary == ElementaryTypes::Plcopen) {
        plcopen_namespace_ = *space.namespace_index(model::plcopen_uri);
    }
}

ElementaryTypes MachineTypes::elementary_in(const model::SpaceReader& space,
                                            const MachineTypeOptions& options)
{
    const bool has_plcopen = model::find_plcopen(space, plcopen_byte) != model::no_node;
    return has_plcopen ? options.elementary : ElementaryTypes::BuiltIn;
}

Configured<void> MachineTypes::add(model::AddressSpace& space,
                                   std::span<const PublishedVariable> variables)
{
    for (const PublishedVariable& each : variables) {
        std::vector<const DerivedType*> found;
        collect(each.program->resolve(each.variable->type), *each.program, found);
        for (std::size_t i = 0; i < found.size(); ++i) {
            const auto added = add_node(space, *found[i], *each.program);
            if (!added) {
                forget(std::span{found}.subspan(i));
                return Unexpected<Problem>{type_problem(*each.program, *found[i], added.error())};
            }
        }
    }
    return {};
}

void MachineTypes::forget(std::span<const DerivedType* const> types)
{
    for (const DerivedType* type : types) {
        known_.erase(fold_name(type->name));
    }
}

MachineDataType MachineTypes::of(const ResolvedType& type) const
{
    if (!needs_node(type)) {
        return data_type_of(type.elementary, options_.elementary, plcopen_namespace_);
    }
    const auto found = known_.find(fold_name(type.type->name));
    return found == known_.end() ? MachineDataType{} : found->second;
}

bool MachineTypes::needs_node(const ResolvedType& type) const
{
    return type.kind == ResolvedType::Kind::Enumeration
               ? options_.typed_enumerations
               : type.kind != ResolvedType::Kind::Elementary;
}

MachineDataType MachineTypes::future_type(const DerivedType& type) const
{
    const NodeId id{namespace_index_, String{type_id + type.name}};
    if (type.kind == DerivedType::Kind::Enumeration) {
        return {id, BuiltInType::Int32};
    }
    return {id, BuiltInType::ExtensionObject, encoding_of(namespace_index_, type)};
}

NodeId MachineTypes::encoding_of(std::uint16_t namespace_index, const DerivedType& type)
{
    return NodeId{namespace_index, String{type_id + type.name + "/Default Binary"}};
}

/// Lists types that have no node yet. Recursion is limited by ProgramLimits::max_depth.
void MachineTypes::collect(const ResolvedType& type, const ProgramTypes& program,
                           std::vector<const DerivedType*>& found)
{
    if (!needs_node(type) ||
        !known_.try_emplace(fold_name(type.type->name), future_type(*type.type)).second) {
        return;
    }
    found.push_back(type.type);
    for (const ResolvedType& member : program.members(*type.type)) {
        collect(member, program, found);
    }
}

Result<void> MachineTypes::add_node(model::AddressSpace& space, const DerivedType& type,
                                    const ProgramTypes& program) const
{
    model::NewNode node;
    node.id = future_type(type).data_type;
    node.browse_name = QualifiedName{namespace_index_, String{type.name}};
    if (!type.comment.empty()) {
        node.description = LocalizedText{String{type.comment}};
    }
    if (type.kind != DerivedType::Kind::Enumeration) {
        return add_structure(space, std::move(node), type, program);
    }
    node.parent = space.find(id::Enumeration);
    const auto added =
        model::add_enumeration_type(space, node, EnumDefinition{fields_of(type.enumerators)});
    return added ? Result<void>{} : fail(added.error());
}

Result<void> MachineTypes::add_structure(model::AddressSpace& space, model::NewNode node,
                                         const DerivedType& type, const ProgramTypes& program) const
{
    const bool is_union = type.kind == DerivedType::Kind::Union;
    node.parent = space.find(is_union ? id::Union : id::Structure);
    StructureDefinition definition;
    definition.default_encoding_id = future_type(type).encoding;
    definition.structure_type =
        is_union ? StructureDefinitionType::Union : StructureDefinitionType::Structure;
    for (const ResolvedType& member : program.members(type)) {
        const std::string& name = type.members[definition.fields.size()].name;
        definition.fields.push_back(field_of(name, member));
    }
    const auto added = model::add_structure_type(space, node, std::move(definition));
    return added ? Result<void>{} : fail(added.error());
}

StructureField MachineTypes::field_of(const std::string& name, const ResolvedType& type) const
{
    StructureField field;
    field.name = String{name};
    field.data_type = of(type).data_type;
    field.value_rank = detail::value_rank(type);
    field.array_dimensions = detail::array_dimensions(type);
    field.max_string_length = type.text_bytes();
    return field;
}

} // namespace busbar::controller
