#include "emit.hpp"

#include "names.hpp"

namespace busbar::generator {

namespace {

/// Fields of a union are not visited: a program asks it which one is set.
std::string fields_of(const Type& type)
{
    const bool is_empty = type.fields.empty();
    std::string text = "template <>\nstruct FieldsOf<" + type.name +
                       "> {\n    template <typename Object, typename Visitor>\n"
                       "    static void visit_all(Object& " +
                       (is_empty ? "" : "value") + ", Visitor& " + (is_empty ? "" : "visit") +
                       ")\n    {\n";
    for (const StructureField& field : type.fields) {
        text += "        visit(" + in_quotes(field.schema_name) + ", value." + field.name + ");\n";
    }
    return text + "    }\n};\n\n";
}

} // namespace

std::string emit_fields(const Schema& schema, const Options& options)
{
    // A template that is specialized, as it is found by its argument: of overloads with a
    // constraint a compiler tries each for each call, and there are hundreds.
    std::string text = preamble(schema) +
                       "#pragma once\n\n#include <concepts>\n#include <type_traits>\n\n#include <" +
                       options.include_path + "/types.hpp>\n\nnamespace " + options.cpp_namespace +
                       " {\n\nnamespace detail {\n\ntemplate <typename Structure>\n"
                       "struct FieldsOf;\n\n";
    for (const Schema::Group& group : schema.groups) {
        for (const Type* type : group.structures) {
            text += type->kind == Type::Kind::Structure ? fields_of(*type) : "";
        }
    }
    text += "} // namespace detail\n\n"
            "/// visit_fields(structure, visit) calls visit(name, field) for each field in wire "
            "order, by\n/// the name that the specification gives it: for printing, comparing, "
            "converting.\n"
            "template <typename Object, typename Visitor>\n"
            "requires(sizeof(detail::FieldsOf<std::remove_const_t<Object>>) > 0)\n"
            "void visit_fields(Object& value, Visitor&& visit)\n{\n"
            "    detail::FieldsOf<std::remove_const_t<Object>>::visit_all(value, visit);\n}\n\n";
    text += "/// visit_structures(visit) calls visit(std::type_identity<T>{}) for each structure T "
            "above.\n"
            "template <typename Visitor>\nvoid visit_structures(Visitor&& visit)\n{\n";
    for (const Schema::Group& group : schema.groups) {
        for (const Type* type : group.structures) {
            text += type->kind == Type::Kind::Structure
                        ? "    visit(std::type_identity<" + type->name + ">{});\n"
                        : "";
        }
    }
    return text + "}\n\n} // namespace " + options.cpp_namespace + "\n";
}

} // namespace busbar::generator
