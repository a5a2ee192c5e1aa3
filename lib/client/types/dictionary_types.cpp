#include "dictionary_types.hpp"

#include <algorithm>
#include <array>

#include <busbar/types/ids.hpp>

#include "client/dictionary/layout.hpp"

namespace busbar::client::detail {

namespace {

using binary::DataTypeEntry;
using binary::DefinitionError;

/// More of them than a person reads.
constexpr std::size_t max_errors = 1'000;

struct NamedType {
    std::string_view name;
    std::uint32_t id;
};

/// Part 5, C.6, as far as OPC UA Binary has these types; Char is used in arrays only.
constexpr std::array schema_types{
    NamedType{"Boolean", id::Boolean},
    NamedType{"SByte", id::SByte},
    NamedType{"Byte", id::Byte},
    NamedType{"Int16", id::Int16},
    NamedType{"UInt16", id::UInt16},
    NamedType{"Int32", id::Int32},
    NamedType{"UInt32", id::UInt32},
    NamedType{"Int64", id::Int64},
    NamedType{"UInt64", id::UInt64},
    NamedType{"Float", id::Float},
    NamedType{"Double", id::Double},
    NamedType{"CharArray", id::String},
    NamedType{"String", id::String},
    NamedType{"DateTime", id::DateTime},
    NamedType{"ByteString", id::ByteString},
    NamedType{"Guid", id::Guid},
};

/// Names in OPC UA's own dictionary that differ from its nodes.
constexpr std::array ua_types{
    NamedType{"ExtensionObject", id::Structure},
    NamedType{"Variant", id::BaseDataType},
};

void report(const DataTypeEntry& entry, std::string reason, std::vector<DefinitionError>& errors)
{
    if (errors.size() < max_errors) {
        errors.push_back(
            {status::Bad_NodeAttributesInvalid, entry.id, entry.name.str(), {}, std::move(reason)});
    }
}

NodeId supertype_of(const DictionaryType& type)
{
    switch (type.kind) {
    case DictionaryType::Kind::Union:
        return {0, id::Union};
    case DictionaryType::Kind::Enumeration:
        return {0, id::Enumeration};
    case DictionaryType::Kind::Number:
        return {0, type.bits == 8    ? id::Byte
                   : type.bits == 16 ? id::UInt16
                   : type.bits == 32 ? id::UInt32
                                     : id::UInt64};
    case DictionaryType::Kind::Structure:
        break;
    }
    return {0, id::Structure};
}

EnumDefinition names_of(const DictionaryType& type)
{
    EnumDefinition definition;
    for (const auto& [value, name] : type.values) {
        EnumField& field = definition.fields.emplace_back();
        field.value = value;
        field.name = String{name};
    }
    return definition;
}

} // namespace

DictionaryTypes::DictionaryTypes(const std::unordered_map<NodeId, DataTypeEntry>& known,
                                 std::size_t max_types)
    : max_types_{max_types}
{
    for (const NamedType& type : schema_types) {
        ids_.emplace(DictionaryName{std::string{binary_schema_uri}, std::string{type.name}},
                     NodeId{0, type.id});
    }
    for (const NamedType& type : ua_types) {
        ids_.emplace(DictionaryName{std::string{ua_uri}, std::string{type.name}},
                     NodeId{0, type.id});
    }
    for (const auto& [node, entry] : known) {
        if (node.namespace_index() == 0) {
            ids_.emplace(DictionaryName{std::string{ua_uri}, entry.name.str()}, node);
        }
    }
}

void DictionaryTypes::add(const NodeId& node, TypeDictionary dictionary)
{
    for (DictionaryType& type : dictionary.types) {
        if (types_.size() == max_types_) {
            return;
        }
        const NodeId own{node.namespace_index(),
                         String{"type dictionary " + to_string(node) + ": " + type.name}};
        ids_.emplace(DictionaryName{dictionary.namespace_uri, type.name}, own);
        types_.push_back({node, own, std::move(type)});
    }
}

std::vector<DataTypeEntry> DictionaryTypes::entries(std::vector<DefinitionError>& errors) const
{
    std::vector<DataTypeEntry> entries;
    for (const Type& type : types_) {
        DataTypeEntry entry;
        entry.id = type.id;
        entry.name = String{type.from.name};
        entry.base = supertype_of(type.from);
        std::string reason = describe(type.from, entry);
        if (reason.empty()) {
            entries.push_back(std::move(entry));
        } else {
            report(entry, std::move(reason), errors);
        }
    }
    return entries;
}

bool DictionaryTypes::define(DataTypeEntry& entry, const NodeId& node, std::string_view name,
                             std::vector<DefinitionError>& errors) const
{
    const Type* const found = find(node, name);
    std::string reason = "no type dictionary describes it";
    if (found != nullptr) {
        reason = describe(found->from, entry);
        if (found->from.kind == DictionaryType::Kind::Union) {
            entry.base = supertype_of(found->from); // Union did not exist before 1.03
        }
    }
    if (!reason.empty()) {
        report(entry, std::move(reason), errors);
    }
    return reason.empty();
}

const DictionaryTypes::Type* DictionaryTypes::find(const NodeId& node, std::string_view name) const
{
    const Type* only = nullptr;
    std::size_t count = 0;
    for (const Type& type : types_) {
        if (type.from.name == name) {
            if (type.dictionary == node) {
                return &type;
            }
            only = &type;
            ++count;
        }
    }
    return count == 1 ? only : nullptr;
}

NodeId DictionaryTypes::id_of(const DictionaryName& name) const
{
    const auto found = ids_.find(name);
    return found == ids_.end() ? NodeId{} : found->second;
}

std::string DictionaryTypes::describe(const DictionaryType& type, DataTypeEntry& entry) const
{
    if (!type.reason.empty()) {
        return type.reason;
    }
    switch (type.kind) {
    case DictionaryType::Kind::Enumeration:
        entry.definition = names_of(type);
        return {};
    case DictionaryType::Kind::Number:
        return {};
    case DictionaryType::Kind::Structure:
    case DictionaryType::Kind::Union:
        break;
    }
    return describe_structure(type, entry);
}

std::string DictionaryTypes::describe_structure(const DictionaryType& type,
                                                DataTypeEntry& entry) const
{
    StructureDefinition definition;
    definition.base_data_type = supertype_of(type);
    definition.default_encoding_id = entry.encoding_id;
    definition.structure_type =
        type.kind == DictionaryType::Kind::Union ? StructureDefinitionType::Union
        : type.has_mask ? StructureDefinitionType::StructureWithOptionalFields
                        : StructureDefinitionType::Structure;
    for (const DictionaryField& from : type.fields) {
        StructureField& field = definition.fields.emplace_back();
        field.name = String{from.name};
        field.data_type = id_of(from.type);
        field.value_rank = from.is_array ? 1 : -1;
        field.is_optional = from.is_optional;
        if (field.data_type.is_null()) {
            return "field " + from.name + ": no dictionary has its type " + from.type.name +
                   " of " +
                   (from.type.namespace_uri.empty() ? "no namespace" : from.type.namespace_uri);
        }
    }
    entry.definition = std::move(definition);
    return {};
}

} // namespace busbar::client::detail
