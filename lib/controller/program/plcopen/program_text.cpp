#include <busbar/controller/program_text.hpp>

#include <optional>

#include "controller/program/declaration_lexer.hpp"
#include "controller/program/gx_table.hpp"
#include "controller/program/sysmac_table.hpp"
#include "twincat_reader.hpp"

namespace busbar::controller {

namespace {

/// Removes what begins with `first` up to the end of `last`; false if it does not begin so.
bool remove_between(std::string_view& text, std::string_view first, std::string_view last)
{
    if (!text.starts_with(first)) {
        return false;
    }
    const std::size_t end = text.find(last, first.size());
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + last.size());
    return true;
}

/// Returns the name of the root of an XML document without its prefix; nothing if it is none.
std::optional<std::string_view> root_of(std::string_view text)
{
    do {
        text = detail::trimmed_text(text);
    } while (remove_between(text, "<?", "?>") || remove_between(text, "<!--", "-->"));
    if (!text.starts_with('<')) {
        return {};
    }
    const std::size_t end = text.find_first_of(" \t\r\n/>", 1);
    const std::string_view name = text.substr(1, end == text.npos ? end : end - 1);
    const std::size_t colon = name.find(':');
    return colon == name.npos ? name : name.substr(colon + 1);
}

} // namespace

Configured<Program> read_program_text(std::string_view text, std::string_view file_name,
                                      const DeclarationLimits& limits, Unserved unserved,
                                      TextEncoding encoding)
{
    const auto decoded = decode_text(text, file_name, limits.max_text_size, encoding);
    if (!decoded) {
        return Unexpected{decoded.error()};
    }
    const auto with_encoding = [&](Program program) {
        program.encoding = decoded->encoding();
        return program;
    };
    const auto root = root_of(decoded->text());
    if (root == "TcPlcObject") {
        return detail::read_twincat(decoded->text(), file_name, limits, unserved)
            .transform(with_encoding);
    }
    if (!root && detail::is_sysmac_table(decoded->text())) {
        return detail::read_sysmac_table(decoded->text(), file_name, limits, unserved)
            .transform(with_encoding);
    }
    if (!root && detail::is_gx_table(decoded->text())) {
        return detail::read_gx_table(decoded->text(), file_name, limits, unserved)
            .transform(with_encoding);
    }
    constexpr std::string_view ending = ".xml";
    return root || file_name.ends_with(ending)
               ? read_plcopen_xml(text, file_name, limits, unserved, encoding)
               : read_declarations(text, file_name, limits, unserved, encoding);
}

} // namespace busbar::controller
