#include "emit.hpp"

#include <algorithm>
#include <span>

#include "names.hpp"

namespace busbar::generator {

namespace {

bool has_optionals(const Type& type)
{
    return std::any_of(type.fields.begin(), type.fields.end(),
                       [](const StructureField& field) { return field.is_optional; });
}

std::string bit(std::size_t index)
{
    return "std::uint32_t{1} << " + std::to_string(index) + "U";
}

std::string structure_type(const Schema& schema, const Type& type)
{
    return "constinit const " + schema.prefix + "StructureType " + type.name +
           "::type = busbar::detail::make_structure_type<" + type.name + ">(\n    " +
           in_quotes(type.node->browse_name) + ", " + in_quotes(schema.namespace_uri) + ",\n    " +
           static_id(type.node->id) + ", " + static_id(type.encoding_id) + ");\n\n";
}

/// A structure that can contain itself counts its levels (Part 6, 5.1.5).
std::string enter(const Type& type, const char* object)
{
    return type.is_recursive
               ? std::string{"    if (!"} + object + ".enter()) {\n        return;\n    }\n"
               : std::string{};
}

std::string leave(const Type& type, const char* object)
{
    return type.is_recursive ? std::string{"    "} + object + ".leave();\n" : std::string{};
}

/// The mask of the optional fields that are there comes first (Part 6, 5.2.7).
std::string encode_structure(const Type& type)
{
    std::string text;
    if (has_optionals(type)) {
        text += "    std::uint32_t mask = 0;\n";
        std::size_t index = 0;
        for (const StructureField& field : type.fields) {
            if (field.is_optional) {
                text += "    mask |= value." + field.name + " ? " + bit(index++) + " : 0U;\n";
            }
        }
        text += "    writer.number(mask);\n";
    }
    for (const StructureField& field : type.fields) {
        text += field.is_optional
                    ? "    if (value." + field.name + ") {\n        encode(writer, *value." +
                          field.name + ");\n    }\n"
                    : "    encode(writer, value." + field.name + ");\n";
    }
    return text;
}

std::string decode_structure(const Type& type, std::size_t first_field = 0)
{
    std::string text;
    if (has_optionals(type)) {
        const auto count = static_cast<std::size_t>(
            std::count_if(type.fields.begin(), type.fields.end(),
                          [](const StructureField& field) { return field.is_optional; }));
        text += "    const auto mask = reader.number<std::uint32_t>();\n";
        if (count < 32) {
            text += "    if (mask >> " + std::to_string(count) +
                    "U != 0) {\n"
                    "        // A field that this version does not know cannot be skipped.\n"
                    "        reader.fail(busbar::status::Bad_DecodingError);\n    }\n";
        }
    }
    std::size_t index = 0;
    for (const StructureField& field : std::span{type.fields}.subspan(first_field)) {
        if (!field.is_optional) {
            text += "    decode(reader, value." + field.name + ");\n";
            continue;
        }
        text += "    value." + field.name + ".reset();\n    if ((mask & " + bit(index++) +
                ") != 0) {\n        decode(reader, value." + field.name + ".emplace());\n    }\n";
    }
    return text;
}

std::string encode_union(const Type& type)
{
    std::string text = "    writer.number(static_cast<std::uint32_t>(value.value.index()));\n"
                       "    switch (value.value.index()) {\n";
    for (std::size_t i = 1; i <= type.fields.size(); ++i) {
        const std::string number = std::to_string(i);
        text += "    case " + number + ":\n        encode(writer, *std::get_if<" + number +
                ">(&value.value));\n        break;\n";
    }
    return text + "    default:\n        break;\n    }\n";
}

std::string decode_union(const Type& type)
{
    std::string text = "    switch (reader.number<std::uint32_t>()) {\n"
                       "    case 0:\n        value.value.emplace<0>();\n        break;\n";
    for (std::size_t i = 1; i <= type.fields.size(); ++i) {
        const std::string number = std::to_string(i);
        text += "    case " + number + ":\n        decode(reader, value.value.emplace<" + number +
                ">());\n        break;\n";
    }
    return text +
           "    default:\n        // Part 6, 5.2.8\n"
           "        reader.fail(busbar::status::Bad_DecodingError);\n        break;\n    }\n";
}

/// Emits a decoder for a whole request, which is its header and then its parameters, and one for
/// the parameters alone, for code that has already read the header.
std::string request_decoder(const Type& type)
{
    return "void decode(binary::Reader& reader, " + type.name +
           "& value)\n{\n    decode(reader, value.request_header);\n"
           "    decode_parameters(reader, value);\n}\n\n"
           "void decode_parameters(binary::Reader& " +
           (type.fields.size() == 1 ? "/*reader*/" : "reader") + ", " + type.name + "& " +
           (type.fields.size() == 1 ? "/*value*/" : "value") + ")\n{\n" +
           decode_structure(type, 1) + "}\n\n";
}

std::string decoder(const Schema& schema, const Type& type)
{
    if (is_request(type)) {
        return request_decoder(type);
    }
    const bool is_union = type.kind == Type::Kind::Union;
    const bool is_empty = type.fields.empty();
    return "void decode(" + schema.prefix + "binary::Reader& " +
           (is_empty ? "/*reader*/" : "reader") + ", " + type.name + "& " +
           (is_empty ? "/*value*/" : "value") + ")\n{\n" + enter(type, "reader") +
           (is_union ? decode_union(type) : decode_structure(type)) + leave(type, "reader") +
           "}\n\n";
}

std::string codec(const Schema& schema, const Type& type)
{
    const bool is_empty = type.fields.empty();
    return "void encode(" + schema.prefix + "binary::Writer& " +
           (is_empty ? "/*writer*/" : "writer") + ", const " + type.name + "& " +
           (is_empty ? "/*value*/" : "value") + ")\n{\n" + enter(type, "writer") +
           (type.kind == Type::Kind::Union ? encode_union(type) : encode_structure(type)) +
           leave(type, "writer") + "}\n\n" + decoder(schema, type);
}

} // namespace

std::string emit_source(const Schema& schema, const Schema::Group& group, const Options& options)
{
    std::string text = preamble(schema) + "#include <" + options.include_path + "/" + group.name +
                       ".hpp>\n\n#include <busbar/binary/codec.hpp>\n\nnamespace " +
                       options.cpp_namespace + " {\n\n";
    if (options.cpp_namespace != "busbar") {
        text += "using busbar::decode;\nusing busbar::encode;\n\n";
    }
    for (const Type* type : group.structures) {
        text += structure_type(schema, *type) + codec(schema, *type);
    }
    return text + "} // namespace " + options.cpp_namespace + "\n";
}

} // namespace busbar::generator
