#include "data_types.hpp"

#include <utility>

namespace busbar::nodeset {

namespace {

/// Returns the kind of a root of the type hierarchy.
Kind final_kind(const NodeId& id)
{
    if (!id.is_numeric() || id.namespace_index() != 0) {
        return Kind::Unknown;
    }
    switch (id.numeric()) {
    case basic_id::Number:
    case basic_id::Integer:
    case basic_id::UInteger:
    case basic_id::Decimal:
        return Kind::Variant;
    case basic_id::Enumeration:
        return Kind::Enumeration;
    case basic_id::OptionSet:
        return Kind::OptionSetStructure;
    case basic_id::Union:
        return Kind::Union;
    default:
        return id.numeric() >= 1 && id.numeric() <= last_built_in_type
                   ? static_cast<Kind>(id.numeric())
                   : Kind::Unknown;
    }
}

std::string name_key(std::uint16_t name_space, std::string_view name)
{
    return std::to_string(name_space) + ':' + std::string{name};
}

/// Returns the name that elements of XML have for a type such as 3DFrame, as no name of XML begins
/// with a digit: the SymbolicNames of namespace 0 have the number in words.
std::string xml_name(std::string_view name)
{
    constexpr std::string_view three = "3D";
    return name.starts_with(three) ? "Three" + std::string{name.substr(1)} : std::string{name};
}

} // namespace

DataTypeTable::DataTypeTable(const Document& document)
{
    for (const Node& node : document.nodes()) {
        if (node.node_class == NodeClass::DataType) {
            insert({node.id,
                    node.browse_namespace,
                    node.browse_name,
                    {},
                    {},
                    {},
                    node.is_abstract,
                    false,
                    node.definition});
        }
    }
    // A BrowseName goes before another type's SymbolicName.
    for (const Node& node : document.nodes()) {
        if (node.node_class == NodeClass::DataType) {
            add_xml_names(node);
        }
        add_references(document, node);
    }
}

void DataTypeTable::add_xml_names(const Node& node)
{
    if (!node.symbolic_name.empty()) {
        names_.emplace(name_key(node.browse_namespace, node.symbolic_name), node.id);
    }
    names_.emplace(name_key(node.browse_namespace, xml_name(node.browse_name)), node.id);
}

void DataTypeTable::add_references(const Document& document, const Node& node)
{
    for (const Reference& reference : node.references) {
        const NodeId& source = reference.is_forward ? node.id : reference.target;
        const NodeId& target = reference.is_forward ? reference.target : node.id;
        if (reference.type.is(has_subtype)) {
            if (const auto subtype = types_.find(target); subtype != types_.end()) {
                subtype->second.supertype = source;
            }
        } else if (reference.type.is(basic_id::HasEncoding)) {
            add_encoding(source, target);
            const Node* const encoding = document.find(target);
            const auto type = types_.find(source);
            if (encoding == nullptr || type == types_.end()) {
                continue;
            }
            if (encoding->browse_name == "Default Binary") {
                type->second.binary_encoding = target;
            } else if (encoding->browse_name == "Default XML") {
                type->second.xml_encoding = target;
            }
        }
    }
}

void DataTypeTable::add(DataType type)
{
    names_.emplace(name_key(type.name_space, xml_name(type.name)), type.id);
    insert(std::move(type));
}

void DataTypeTable::insert(DataType type)
{
    names_.emplace(name_key(type.name_space, type.name), type.id);
    if (!type.binary_encoding.is_null()) {
        add_encoding(type.id, type.binary_encoding);
    }
    NodeId id = type.id;
    types_.emplace(std::move(id), std::move(type));
}

void DataTypeTable::add_encoding(const NodeId& type, const NodeId& encoding)
{
    encoded_.emplace(encoding, type);
}

const DataType* DataTypeTable::find(const NodeId& id) const
{
    const auto found = types_.find(id);
    return found == types_.end() ? nullptr : &found->second;
}

const DataType* DataTypeTable::find_encoded(const NodeId& encoding) const
{
    const auto found = encoded_.find(encoding);
    return find(found == encoded_.end() ? encoding : found->second);
}

const DataType* DataTypeTable::find_named(std::uint16_t name_space, std::string_view name) const
{
    const auto found = names_.find(name_key(name_space, name));
    return found == names_.end() ? nullptr : find(found->second);
}

const DataType* DataTypeTable::supertype(const NodeId& id) const
{
    const DataType* const type = find(id);
    return type == nullptr ? nullptr : find(type->supertype);
}

Kind DataTypeTable::kind(const NodeId& id) const
{
    NodeId at = id;
    for (unsigned level = 0; level < max_levels; ++level) {
        if (const Kind kind = final_kind(at); kind != Kind::Unknown) {
            return kind;
        }
        const DataType* const type = find(at);
        if (type == nullptr) {
            break;
        }
        at = type->supertype;
    }
    return Kind::Unknown;
}

NodeId DataTypeTable::binary_encoding(const NodeId& id) const
{
    const DataType* const type = find(id);
    return type == nullptr ? NodeId{} : type->binary_encoding;
}

std::vector<const Field*> DataTypeTable::fields(const NodeId& id) const
{
    std::vector<const DataType*> levels;
    for (const DataType* at = find(id); at != nullptr && levels.size() < max_levels;
         at = find(at->supertype)) {
        levels.push_back(at);
        if (at->is_complete) {
            break;
        }
    }
    std::vector<const Field*> all;
    for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
        if ((*level)->definition) {
            for (const Field& field : (*level)->definition->fields) {
                all.push_back(&field);
            }
        }
    }
    return all;
}

FieldForm DataTypeTable::form(const Field& field) const
{
    const Kind of_type = kind(field.data_type);
    switch (of_type) {
    case Kind::Unknown:
        return {};
    case Kind::Enumeration:
        return {FieldForm::Class::Enumeration, BuiltInType::Int32, nullptr};
    case Kind::Structure:
    case Kind::Union:
    case Kind::OptionSetStructure: {
        // A value of an abstract structure, or of one whose subtypes are allowed, has its type's id
        // (Part 6, 5.2.6).
        const DataType* const type = find(field.data_type);
        const bool is_open = is_open_structure(field.data_type) || field.allow_sub_types ||
                             type == nullptr || type->is_abstract;
        return {is_open ? FieldForm::Class::BuiltIn : FieldForm::Class::Structure,
                BuiltInType::ExtensionObject, is_open ? nullptr : type};
    }
    default:
        return {FieldForm::Class::BuiltIn,
                field.allow_sub_types ? BuiltInType::Variant : static_cast<BuiltInType>(of_type),
                nullptr};
    }
}

bool DataTypeTable::is_union(const NodeId& id) const
{
    const DataType* const type = find(id);
    return kind(id) == Kind::Union ||
           (type != nullptr && type->definition && type->definition->is_union);
}

bool DataTypeTable::is_open_structure(const NodeId& id)
{
    return id.is(basic_id::Structure) || id.is(basic_id::OptionSet) || id.is(basic_id::Union);
}

} // namespace busbar::nodeset
