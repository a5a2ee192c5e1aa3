#include "type_compiler.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>

namespace busbar::binary::detail {

using Kind = DynamicType::Kind;

TypeCompiler::TypeCompiler(std::vector<DataTypeEntry> from, const DynamicTypeLimits& limits)
    : limits_{limits}
{
    make_types(std::move(from));
}

void TypeCompiler::run()
{
    for (Entry& entry : entries_) {
        resolve_root(entry);
    }
    cut_endless_supertypes();
    for (Entry& entry : entries_) {
        if (!entry.is_wrong) {
            define(entry);
        }
    }
    refuse_users_of_wrong_types();
    measure_all();
    refuse_users_of_wrong_types();
}

std::size_t TypeCompiler::index_of(const NodeId& data_type) const
{
    const auto found = index_.find(data_type);
    return found == index_.end() ? none : found->second;
}

NodeId TypeCompiler::base_of(const DataTypeEntry& from) const
{
    const auto* const structure = std::get_if<StructureDefinition>(&from.definition);
    return from.base.is_null() && structure != nullptr ? structure->base_data_type : from.base;
}

void TypeCompiler::refuse(Entry& entry, StatusCode status, std::string_view field,
                          std::string reason)
{
    if (!entry.is_wrong) {
        entry.is_wrong = true;
        errors_.push_back(
            {status, entry.from.id, entry.type->name, std::string{field}, std::move(reason)});
    }
}

void TypeCompiler::make_types(std::vector<DataTypeEntry> all)
{
    entries_.reserve(std::min(all.size(), limits_.max_types));
    for (DataTypeEntry& from : all) {
        auto type = std::make_unique<DynamicType>();
        type->id = from.id;
        type->name = from.name.view().substr(0, limits_.max_name_length);
        type->is_abstract = from.is_abstract;
        if (entries_.size() == limits_.max_types) {
            errors_.push_back({status::Bad_EncodingLimitsExceeded, from.id, type->name, "",
                               "there are too many types"});
            return;
        }
        if (from.id.is_null() || !index_.emplace(from.id, entries_.size()).second) {
            errors_.push_back({status::Bad_NodeAttributesInvalid, from.id, type->name, "",
                               "its NodeId is null or used twice"});
            continue;
        }
        entries_.push_back({std::move(from), std::move(type), {}});
    }
}

/// Goes up to a type that is known without a description, which may be the type itself.
void TypeCompiler::resolve_root(Entry& entry)
{
    DynamicType& type = *entry.type;
    const std::size_t base = index_of(base_of(entry.from));
    type.base = base == none ? nullptr : entries_[base].type.get();
    NodeId at = type.id;
    std::optional<DataTypeRoot> root = data_type_root(at);
    for (std::size_t level = 0; !root && level <= limits_.max_depth; ++level) {
        const std::size_t index = index_of(at);
        if (index == none) {
            return refuse(entry, status::Bad_DataTypeIdUnknown, "",
                          "its supertype " + to_string(at) + " is not known");
        }
        at = base_of(entries_[index].from);
        root = data_type_root(at);
    }
    if (!root) {
        type.base = nullptr;
        return refuse(entry, status::Bad_NodeAttributesInvalid, "",
                      "it has too many supertypes, or is one of its own");
    }
    entry.root = *root;
    type.kind = root->kind;
    type.built_in = root->built_in;
}

/// The types at which resolve_root stops may be described with supertypes, too.
void TypeCompiler::cut_endless_supertypes()
{
    constexpr std::size_t levels_of_roots = 8;
    for (Entry& entry : entries_) {
        std::size_t level = 0;
        const DynamicType* at = entry.type.get();
        while (at != nullptr && level <= limits_.max_depth + levels_of_roots) {
            at = at->base;
            ++level;
        }
        if (at != nullptr) {
            entry.type->base = nullptr;
        }
    }
}

void TypeCompiler::define(Entry& entry)
{
    DynamicType& type = *entry.type;
    type.encoding_id = entry.from.encoding_id;
    if (const auto* structure = std::get_if<StructureDefinition>(&entry.from.definition)) {
        if (!type.is_structure()) {
            return refuse(entry, status::Bad_NodeAttributesInvalid, "",
                          "it has a StructureDefinition but is not a Structure");
        }
        if (type.encoding_id.is_null()) {
            type.encoding_id = structure->default_encoding_id;
        }
        return define_structure(entry, *structure);
    }
    if (entry.root.is_option_set_structure) {
        define_option_set(entry);
    } else if (type.is_structure() && !type.is_abstract && !is_open_structure(type.id)) {
        return refuse(entry, status::Bad_NodeAttributesInvalid, "", "it has no definition");
    }
    if (const auto* values = std::get_if<EnumDefinition>(&entry.from.definition)) {
        define_values(entry, *values);
    }
}

bool TypeCompiler::check_names(Entry& entry, const std::vector<std::string_view>& names)
{
    std::vector<std::string_view> sorted = names;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    for (const std::string_view name : names) {
        if (name.empty() || name.size() > limits_.max_name_length) {
            refuse(entry, status::Bad_NodeAttributesInvalid, name.substr(0, 64),
                   "its name is empty or too long");
            return false;
        }
    }
    if (twice != sorted.end()) {
        refuse(entry, status::Bad_NodeAttributesInvalid, *twice, "its name is used twice");
        return false;
    }
    return true;
}

void TypeCompiler::define_structure(Entry& entry, const StructureDefinition& definition)
{
    using enum StructureDefinitionType;
    const StructureDefinitionType type = definition.structure_type;
    const bool is_union = type == Union || type == UnionWithSubtypedValues;
    if (type < Structure || type > UnionWithSubtypedValues ||
        is_union != (entry.type->kind == Kind::Union)) {
        return refuse(entry, status::Bad_NodeAttributesInvalid, "",
                      "its StructureType does not fit its supertype");
    }
    if (definition.fields.size() > limits_.max_fields) {
        return refuse(entry, status::Bad_EncodingLimitsExceeded, "", "it has too many fields");
    }
    std::vector<std::string_view> names;
    for (const StructureField& field : definition.fields) {
        names.push_back(field.name.view());
    }
    if (!check_names(entry, names)) {
        return;
    }
    std::size_t optional_fields = 0;
    for (const StructureField& field : definition.fields) {
        define_field(entry, field, type);
        optional_fields += type == StructureWithOptionalFields && field.is_optional ? 1U : 0U;
    }
    if (optional_fields > 32) { // Part 6, 5.2.7
        refuse(entry, status::Bad_NodeAttributesInvalid, "", "it has over 32 optional fields");
    }
    // The mask exists even if no field needs it: the StructureType says so.
    entry.type->has_optional_fields = type == StructureWithOptionalFields;
}

void TypeCompiler::define_option_set(Entry& entry)
{
    for (const char* const name : {"Value", "ValidBits"}) {
        DynamicField field;
        field.name = name;
        field.data_type = NodeId{0, static_cast<std::uint32_t>(BuiltInType::ByteString)};
        field.built_in = BuiltInType::ByteString;
        entry.type->fields.push_back(std::move(field));
    }
}

void TypeCompiler::define_values(Entry& entry, const EnumDefinition& definition)
{
    DynamicType& type = *entry.type;
    const bool is_unsigned =
        type.built_in == BuiltInType::Byte || type.built_in == BuiltInType::UInt16 ||
        type.built_in == BuiltInType::UInt32 || type.built_in == BuiltInType::UInt64;
    if (is_unsigned) {
        type.kind = Kind::OptionSet;
    }
    if (type.kind == Kind::Simple) {
        return refuse(
            entry, status::Bad_NodeAttributesInvalid, "",
            "it has an EnumDefinition but is neither an Enumeration nor an unsigned integer");
    }
    if (definition.fields.size() > limits_.max_values) {
        return refuse(entry, status::Bad_EncodingLimitsExceeded, "", "it has too many values");
    }
    std::vector<std::string_view> names;
    for (const EnumField& field : definition.fields) {
        names.push_back(field.name.view());
        type.values.push_back({field.value, field.name.str()});
    }
    static_cast<void>(check_names(entry, names));
}

void TypeCompiler::define_field(Entry& entry, const StructureField& from,
                                StructureDefinitionType type)
{
    using enum StructureDefinitionType;
    DynamicField field;
    field.name = from.name.str();
    field.data_type = from.data_type;
    // The flag has one of two meanings (Part 3, 8.51).
    field.is_optional = from.is_optional && type == StructureWithOptionalFields;
    field.allows_subtypes = from.is_optional && (type == StructureWithSubtypedValues ||
                                                 type == UnionWithSubtypedValues);
    field.max_string_length = from.max_string_length;
    if (resolve_field(entry, from, field)) {
        resolve_rank(entry, from, field);
    }
    entry.type->fields.push_back(std::move(field));
}

/// Determines the encoding of one value or element of the field.
bool TypeCompiler::resolve_field(Entry& entry, const StructureField& from, DynamicField& field)
{
    const std::size_t index = index_of(from.data_type);
    const auto own_root = data_type_root(from.data_type);
    if (index == none && !own_root) {
        refuse(entry, status::Bad_DataTypeIdUnknown, from.name.view(),
               "its DataType " + to_string(from.data_type) + " is not known");
        return false;
    }
    const Entry* const known = index == none ? nullptr : &entries_[index];
    const DataTypeRoot root = own_root ? *own_root : known->root;
    field.type = known == nullptr ? nullptr : known->type.get();
    field.built_in = root.built_in;
    field.variant_types = root.variant_types;
    if (root.kind == Kind::Structure || root.kind == Kind::Union) {
        // Part 6, 5.1.7: a value that may be of a subtype has its type's id.
        field.is_structure = known != nullptr && !known->type->is_abstract &&
                             !field.allows_subtypes && !is_open_structure(from.data_type);
    } else if (field.allows_subtypes && root.kind != Kind::Enumeration) {
        field.built_in = BuiltInType::Variant;
    }
    return true;
}

void TypeCompiler::resolve_rank(Entry& entry, const StructureField& from, DynamicField& field)
{
    field.value_rank = from.value_rank;
    const bool is_scalar = from.value_rank == -1;
    const bool is_array =
        from.value_rank >= 1 && static_cast<std::size_t>(from.value_rank) <= limits_.max_rank;
    if (!is_scalar && !is_array) {
        // Part 3, 8.51 requires a fixed rank; a Variant carries any by itself.
        field.value_rank = -1;
        if (field.built_in != BuiltInType::Variant || from.value_rank < -3 || from.value_rank > 0) {
            refuse(entry, status::Bad_NodeAttributesInvalid, from.name.view(),
                   "its ValueRank is " + std::to_string(from.value_rank));
        }
    }
    const std::size_t dimensions = from.array_dimensions.size();
    if (dimensions != 0 && from.value_rank != static_cast<std::int64_t>(dimensions)) {
        refuse(entry, status::Bad_NodeAttributesInvalid, from.name.view(),
               "its ArrayDimensions do not fit its ValueRank");
    }
    field.array_dimensions.assign(from.array_dimensions.begin(), from.array_dimensions.end());
}

} // namespace busbar::binary::detail
