#include "emit.hpp"

#include <algorithm>

namespace busbar::generator {

namespace {

/// The namespace and name of the function that returns the table.
struct TableName {
    std::string in_namespace;
    std::string function;
};

TableName table_name(const Schema& schema, const Options& options)
{
    return schema.namespace_index == 0 ? TableName{"busbar::binary", "namespace0_types"}
                                       : TableName{options.cpp_namespace, "types"};
}

/// Whether `a` comes before `b` in the table: numbers, then strings, each ascending.
bool comes_before(const Type* a, const Type* b)
{
    if (a->encoding_id.id_type() != b->encoding_id.id_type()) {
        return a->encoding_id.is_numeric();
    }
    return a->encoding_id.is_numeric()
               ? a->encoding_id.numeric() < b->encoding_id.numeric()
               : a->encoding_id.string().view() < b->encoding_id.string().view();
}

std::vector<const Type*> registered(const Schema& schema)
{
    std::vector<const Type*> types;
    for (const Type& type : schema.types) {
        const auto id_type = type.encoding_id.id_type();
        if (type.is_structure() && !type.node->is_abstract && !type.encoding_id.is_null() &&
            (id_type == IdType::Numeric || id_type == IdType::String)) {
            types.push_back(&type);
        }
    }
    std::sort(types.begin(), types.end(), comes_before);
    return types;
}

} // namespace

std::string emit_registry_header(const Schema& schema, const Options& options)
{
    const TableName name = table_name(schema, options);
    return preamble(schema) +
           "#pragma once\n\n#include <busbar/binary/type_registry.hpp>\n"
           "#include <busbar/core/api.hpp>\n\n"
           "namespace " +
           name.in_namespace +
           " {\n\n/// All concrete structures of the namespace, for a TypeRegistry. Constant "
           "data.\n"
           "[[nodiscard]] BUSBAR_API busbar::binary::TypeRegistry::Table " +
           name.function + "();\n\n} // namespace " + name.in_namespace + "\n";
}

std::string emit_registry_source(const Schema& schema, const Options& options)
{
    const TableName name = table_name(schema, options);
    const auto types = registered(schema);
    std::string text = preamble(schema) + "#include <" + options.include_path +
                       "/registry.hpp>\n\n#include <" + options.include_path +
                       "/types.hpp>\n\nnamespace " + name.in_namespace +
                       " {\n\nbusbar::binary::TypeRegistry::Table " + name.function + "()\n{\n";
    if (types.empty()) {
        text += "    return {};\n";
    } else {
        text += "    static constexpr const busbar::StructureType* table[] = {\n";
        for (const Type* type : types) {
            text += "        &" + options.cpp_namespace + "::" + type->name + "::type,\n";
        }
        text += "    };\n    return table;\n";
    }
    return text + "}\n\n} // namespace " + name.in_namespace + "\n";
}

} // namespace busbar::generator
