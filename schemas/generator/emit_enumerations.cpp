#include "emit.hpp"

namespace busbar::generator {

namespace {

std::string enumerators(const Type& type, bool are_bits, const std::string& indent)
{
    std::string text;
    for (const Enumerator& enumerator : type.enumerators) {
        const std::string value = std::to_string(enumerator.value);
        // The smallest Int32 cannot be written as a literal.
        const bool is_least = enumerator.value == INT32_MIN;
        text += indent + enumerator.name + " = " +
                (are_bits ? type.underlying + "{1} << " + value + "U"
                          : (is_least ? "INT32_MIN" : value)) +
                ",\n";
    }
    return text;
}

std::string enumeration(const Type& type)
{
    const bool is_option_set = type.kind == Type::Kind::OptionSet;
    return "/// " + type.node->browse_name + ", " + to_string(type.node->id) + ".\nenum class " +
           type.name + " : " + type.underlying + " {\n" + enumerators(type, is_option_set, "    ") +
           "};\n\n";
}

} // namespace

std::string emit_enumerations(const Schema& schema, const Options& options)
{
    std::string text = preamble(schema) +
                       "#pragma once\n\n#include <cstdint>\n\n"
                       "#include <busbar/binary/option_set.hpp>\n\nnamespace " +
                       options.cpp_namespace + " {\n\n";
    std::string traits;
    for (const Type& type : schema.types) {
        if (type.is_structure()) {
            continue;
        }
        text += enumeration(type);
        if (type.kind == Type::Kind::OptionSet) {
            traits += "template <>\ninline constexpr bool is_option_set<" + options.cpp_namespace +
                      "::" + type.name + "> = true;\n";
        }
    }
    if (options.cpp_namespace != "busbar") {
        for (const char* name :
             {"operator|", "operator&", "operator~", "operator|=", "operator&=", "has_bits"}) {
            text += std::string{"using busbar::"} + name + ";\n";
        }
        text += '\n';
    }
    text += "} // namespace " + options.cpp_namespace + "\n";
    if (!traits.empty()) {
        text += "\nnamespace busbar {\n\n" + traits + "\n} // namespace busbar\n";
    }
    return text;
}

std::string structure_bits(const Type& type)
{
    if (type.enumerators.empty()) {
        return {};
    }
    return "    /// The numbers of the bits in `value`, from the lowest of the first byte.\n"
           "    enum class Bit : std::uint16_t {\n" +
           enumerators(type, false, "        ") + "    };\n\n";
}

} // namespace busbar::generator
