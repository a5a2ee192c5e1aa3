#include "schema.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include "hierarchy.hpp"
#include "names.hpp"

namespace busbar::generator {

namespace {

using nodeset::Document;
using nodeset::Node;
using nodeset::NodeClass;

/// C++ types that are written by hand: structures and enumerations never to be generated.
constexpr std::array<std::uint32_t, 4> hand_written = {
    22,    // Structure
    29,    // Enumeration
    256,   // IdType, in core
    12756, // Union
};

/// The C++ name of a DataType's type. Core has a StructureType of its own.
std::string cpp_name(const Node& node)
{
    if (node.id.is(basic_id::StructureType)) {
        return "StructureDefinitionType";
    }
    return type_name(node.symbolic_name.empty() ? node.browse_name : node.symbolic_name);
}

class SchemaMaker {
public:
    SchemaMaker(const Document& document, const Options& options, Schema& schema)
        : document_{document}, options_{options}, schema_{schema}, hierarchy_{document}
    {
    }

    Expected<void, Failure> make();

private:
    void make_types();
    void make_type(const Node& node);
    void make_enumerators(Type& type);
    void make_fields(Type& type);
    void add_fields(Type& type, const Node& node, unsigned depth);
    StructureField make_field(const Node& owner, const nodeset::Field& from);
    FieldType field_type(const Node& owner, const nodeset::Field& from);
    FieldType enumeration_type(const Node& node, const char* underlying, std::size_t size);
    FieldType structure_type(const Node& node);
    [[nodiscard]] std::string qualified(const Node& node, const std::string& name) const;
    std::size_t min_wire_size(Type& type);
    void fail(const Node& node, std::uint32_t line, const std::string& what);
    /// A NodeId by its namespace's URI; files have indexes of their own.
    [[nodiscard]] std::string global_text(NodeId id) const;

    const Document& document_;
    const Options& options_;
    Schema& schema_;
    Hierarchy hierarchy_;
    std::unordered_map<const Node*, Type*> by_node_;
    Failure failure_;
};

void SchemaMaker::fail(const Node& node, std::uint32_t line, const std::string& what)
{
    if (failure_.empty()) {
        failure_ = place(document_, node, line) + what;
    }
}

std::string SchemaMaker::global_text(NodeId id) const
{
    if (id.namespace_index() == 0) {
        return to_string(id);
    }
    const std::string& uri = document_.namespaces()[id.namespace_index()];
    id.set_namespace_index(0);
    return to_string(ExpandedNodeId{std::move(id), uri});
}

Expected<void, Failure> SchemaMaker::make()
{
    make_types();
    for (Type& type : schema_.types) {
        if (type.is_structure()) {
            make_fields(type);
        }
    }
    for (Type& type : schema_.types) {
        if (failure_.empty() && type.is_structure()) {
            min_wire_size(type);
        }
    }
    if (!failure_.empty()) {
        return Unexpected{failure_};
    }
    return {};
}

void SchemaMaker::make_types()
{
    std::set<std::string> names;
    for (const Node& node : document_.nodes()) {
        const bool is_by_hand = node.id.namespace_index() == 0 && node.id.is_numeric() &&
                                std::find(hand_written.begin(), hand_written.end(),
                                          node.id.numeric()) != hand_written.end();
        if (node.node_class != NodeClass::DataType || is_by_hand ||
            node.id.namespace_index() != schema_.namespace_index) {
            continue;
        }
        const std::size_t before = schema_.types.size();
        make_type(node);
        if (schema_.types.size() > before && !names.insert(schema_.types.back().name).second) {
            fail(node, node.line, "there is another type named " + schema_.types.back().name);
        }
    }
}

void SchemaMaker::make_type(const Node& node)
{
    const Kind kind = hierarchy_.kind(node.id);
    Type type;
    type.node = &node;
    type.name = cpp_name(node);
    if (kind == Kind::Structure || kind == Kind::Union || kind == Kind::OptionSetStructure) {
        const bool is_union =
            kind == Kind::Union && node.definition && !node.definition->fields.empty();
        type.kind = is_union ? Type::Kind::Union : Type::Kind::Structure;
        type.encoding_id = hierarchy_.binary_encoding(node.id);
        if (kind == Kind::OptionSetStructure && !hierarchy_.is_option_set_base(node.id)) {
            make_enumerators(type);
        }
    } else if (kind == Kind::Enumeration) {
        type.kind = Type::Kind::Enumeration;
        type.underlying = "std::int32_t";
        make_enumerators(type);
    } else if (hierarchy_.is_number_option_set(node)) {
        type.kind = Type::Kind::OptionSet;
        type.underlying = built_in(kind).cpp;
        make_enumerators(type);
    } else {
        return;
    }
    by_node_.emplace(&node, &schema_.types.emplace_back(std::move(type)));
}

void SchemaMaker::make_enumerators(Type& type)
{
    const Node& node = *type.node;
    const bool is_enumeration = type.kind == Type::Kind::Enumeration;
    const std::int64_t most = is_enumeration        ? std::numeric_limits<std::int32_t>::max()
                              : type.is_structure() ? 0xFFFF
                                                    : built_in_bits(type.underlying) - 1;
    const std::int64_t least = is_enumeration ? std::numeric_limits<std::int32_t>::min() : 0;
    std::set<std::string> names;
    for (const nodeset::Field& field : hierarchy_.enumeration_fields(node)) {
        Enumerator enumerator{
            type_name(field.symbolic_name.empty() ? field.name : field.symbolic_name), field.value};
        if (field.value < least || field.value > most) {
            fail(node, field.line,
                 "found Value=" + std::to_string(field.value) + " of " + field.name +
                     ", expected " + std::to_string(least) + " to " + std::to_string(most));
        }
        if (!names.insert(enumerator.name).second) {
            enumerator.name += '_' + std::to_string(field.value);
        }
        type.enumerators.push_back(std::move(enumerator));
    }
}

void SchemaMaker::make_fields(Type& type)
{
    add_fields(type, *type.node, 0);
    const auto optionals = std::count_if(type.fields.begin(), type.fields.end(),
                                         [](const StructureField& f) { return f.is_optional; });
    if (optionals > 32) {
        fail(*type.node, type.node->line, "found more than 32 optional fields"); // Part 6, 5.2.7
    }
}

void SchemaMaker::add_fields(Type& type, const Node& node, unsigned depth)
{
    constexpr unsigned most_supertypes = 100;
    const Node* const base = hierarchy_.supertype(node.id);
    if (base != nullptr && depth < most_supertypes) {
        add_fields(type, *base, depth + 1);
    }
    const bool has_bits_only = hierarchy_.kind(node.id) == Kind::OptionSetStructure &&
                               !hierarchy_.is_option_set_base(node.id);
    if (!node.definition || has_bits_only) {
        return;
    }
    for (const nodeset::Field& from : node.definition->fields) {
        StructureField field = make_field(node, from);
        // A subtype may narrow the type of a field that it inherits; it is still one field.
        const auto inherited =
            std::find_if(type.fields.begin(), type.fields.end(),
                         [&](const StructureField& other) { return other.name == field.name; });
        if (inherited != type.fields.end()) {
            *inherited = std::move(field);
        } else {
            type.fields.push_back(std::move(field));
        }
    }
}

StructureField SchemaMaker::make_field(const Node& owner, const nodeset::Field& from)
{
    StructureField field;
    field.name = field_name(from.symbolic_name.empty() ? from.name : from.symbolic_name);
    field.schema_name = from.name;
    field.type = field_type(owner, from);
    field.value_rank = from.value_rank;
    field.is_optional = from.is_optional && !owner.definition->is_union;
    if (from.value_rank == -1 || from.value_rank >= 1) {
        return field;
    }
    // Part 5, 12.2.12.5 wants a fixed rank. A Variant carries any by itself.
    if (field.type.cpp != schema_.prefix + "Variant") {
        fail(owner, from.line,
             "found ValueRank=" + std::to_string(from.value_rank) + " of the field " + from.name +
                 ", expected -1 or at least 1");
    }
    field.value_rank = -1;
    return field;
}

FieldType SchemaMaker::field_type(const Node& owner, const nodeset::Field& from)
{
    const Node* const node = document_.find(from.data_type);
    const Kind kind = hierarchy_.kind(from.data_type);
    if (kind == Kind::Unknown) {
        fail(owner, from.line,
             "the DataType " + global_text(from.data_type) + " of the field " + from.name +
                 " is in none of the files");
        return {};
    }
    if (kind == Kind::Structure || kind == Kind::Union || kind == Kind::OptionSetStructure) {
        // Part 6, 5.2.2.15: what may be a subtype goes with its type's id.
        if (node == nullptr || node->is_abstract || from.allow_sub_types ||
            hierarchy_.is_open_structure(from.data_type)) {
            return {schema_.prefix + "ExtensionObject", 3, nullptr};
        }
        return structure_type(*node);
    }
    if (kind == Kind::Variant || (from.allow_sub_types && kind != Kind::Enumeration)) {
        return {schema_.prefix + "Variant", 1, nullptr};
    }
    if (kind == Kind::Enumeration) {
        return enumeration_type(*node, "std::int32_t", 4);
    }
    const BuiltInName& name = built_in(kind);
    if (node != nullptr && hierarchy_.is_number_option_set(*node)) {
        return enumeration_type(*node, name.cpp, name.min_wire_size);
    }
    return {name.is_busbar ? schema_.prefix + name.cpp : name.cpp, name.min_wire_size, nullptr};
}

FieldType SchemaMaker::enumeration_type(const Node& node, const char* underlying, std::size_t size)
{
    const bool is_generated = node.id.namespace_index() != schema_.namespace_index ||
                              by_node_.find(&node) != by_node_.end();
    const std::string name = cpp_name(node);
    const bool is_by_hand = node.id.is(basic_id::Enumeration) || node.id.is(basic_id::IdType);
    return {is_generated && !is_by_hand ? qualified(node, name) : underlying, size, nullptr};
}

FieldType SchemaMaker::structure_type(const Node& node)
{
    const std::string name = cpp_name(node);
    const auto own = by_node_.find(&node);
    return {qualified(node, name), 1, own == by_node_.end() ? nullptr : own->second};
}

std::string SchemaMaker::qualified(const Node& node, const std::string& name) const
{
    if (node.id.namespace_index() == schema_.namespace_index) {
        return name;
    }
    const std::string& file = document_.files()[node.file].name;
    for (const Options::Dependency& dependency : options_.dependencies) {
        if (dependency.path == file) {
            return dependency.cpp_namespace + "::" + name;
        }
    }
    return schema_.prefix + name;
}

std::size_t SchemaMaker::min_wire_size(Type& type)
{
    // Set while its parts are visited, so that a structure that is part of itself shows.
    constexpr std::size_t visiting = std::numeric_limits<std::size_t>::max();
    if (type.min_wire_size == visiting) {
        fail(*type.node, type.node->line,
             "the structure " + type.name + " contains itself other than through an array");
        return 0;
    }
    if (type.min_wire_size != 0) {
        return type.min_wire_size;
    }
    type.min_wire_size = visiting;
    const bool is_union = type.kind == Type::Kind::Union;
    std::size_t size = is_union ? 4 : 0;
    bool has_mask = false;
    for (StructureField& field : type.fields) {
        std::size_t part = field.type.min_wire_size;
        if (field.value_rank < 1 && field.type.structure != nullptr) {
            part = min_wire_size(*by_node_.at(field.type.structure->node));
        } else if (field.value_rank >= 1) {
            part = 4;
        }
        has_mask = has_mask || field.is_optional;
        size += is_union || field.is_optional ? 0 : part;
    }
    type.min_wire_size = size + (has_mask ? 4 : 0);
    return type.min_wire_size;
}

} // namespace

std::string place(const Document& document, const Node& node, std::uint32_t line)
{
    return document.files()[node.file].name + ":" + std::to_string(line) + ": ";
}

Expected<Schema, Failure> make_schema(const Document& document, const Options& options)
{
    Schema schema;
    schema.namespace_uri = options.namespace_uri;
    const auto index = document.namespace_index(schema.namespace_uri);
    if (!index) {
        return Unexpected{"found no namespace " + schema.namespace_uri + " in the NodeSet2 files"};
    }
    schema.namespace_index = *index;
    const bool is_inside =
        options.cpp_namespace == "busbar" || options.cpp_namespace.starts_with("busbar::");
    schema.prefix = is_inside ? "" : "busbar::";
    for (const Options::Dependency& dependency : options.dependencies) {
        const std::string include = dependency.include_path + "/types.hpp";
        auto& includes = schema.foreign_includes;
        if (std::find(includes.begin(), includes.end(), include) == includes.end()) {
            includes.push_back(include);
        }
    }
    SchemaMaker maker{document, options, schema};
    if (auto made = maker.make(); !made) {
        return Unexpected{made.error()};
    }
    if (auto laid_out = lay_out(schema, document, options); !laid_out) {
        return Unexpected{laid_out.error()};
    }
    return schema;
}

} // namespace busbar::generator
