#include "foreign_format.hpp"

#include <algorithm>
#include <array>

#include "controller/program/declaration_lexer.hpp"

namespace busbar::controller::detail {

namespace {

using namespace std::string_view_literals;

struct ForeignFormat {
    std::string_view mark;
    std::string_view words;
};

/// The first bytes of files that are not texts.
constexpr std::array foreign_bytes{
    ForeignFormat{"PK\x03\x04"sv, "a ZIP archive, such as a project or an Excel file"},
    ForeignFormat{"\xD0\xCF\x11\xE0"sv, "a compound file, such as a project or an old Excel file"},
    ForeignFormat{"\x1F\x8B"sv, "a file compressed with gzip"},
    ForeignFormat{"7z\xBC\xAF"sv, "a 7z archive"},
    ForeignFormat{"SQLite format 3"sv, "a database of SQLite"},
    ForeignFormat{"%PDF-"sv, "a PDF"},
    ForeignFormat{"\x7F"
                  "ELF"sv,
                  "a program for a processor (ELF)"},
    ForeignFormat{"MZ\x90"sv, "a program of Windows"},
};

/// Roots of XML documents.
constexpr std::array foreign_roots{
    ForeignFormat{"RSLogix5000Content", "an export of Studio 5000 (L5X)"},
    ForeignFormat{"UANodeSet", "an information model, which has no variables of a PLC"},
    ForeignFormat{"TcSmProject", "a project of TwinCAT, whose PLC has a .plcproj of its own"},
    ForeignFormat{"TcSmItem", "a part of a TwinCAT project, whose PLC has a .plcproj of its own"},
    ForeignFormat{"TcModuleClass", "the description of a module of TwinCAT"},
    ForeignFormat{"Document", "an export of TIA Portal Openness; its texts of declarations are "
                              "exported as .scl or .udt"},
    ForeignFormat{"FEFExchangeFile", "an exchange file of Control Expert"},
    ForeignFormat{"VariablesExchangeFile", "variables of Control Expert (XSY)"},
    ForeignFormat{"DDTExchangeFile", "types of Control Expert (XDD)"},
    ForeignFormat{"STExchangeFile", "a program of Control Expert (XST)"},
    ForeignFormat{"SMC", "a project of Sysmac Studio, which exports IEC 61131-10"},
    ForeignFormat{"ExportObject",
                  "an export of CODESYS in its own XML; it exports PLCopen XML, too"},
    ForeignFormat{"Symbolconfiguration", "a symbol file of CODESYS"},
    ForeignFormat{"html", "a web page"},
};

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

bool is_json(std::string_view text)
{
    const std::string_view begin = trimmed_text(text.substr(0, 256));
    return begin.starts_with('{') && trimmed_text(begin.substr(1)).starts_with('"');
}

} // namespace

std::string_view xml_root(std::string_view text)
{
    do {
        text = trimmed_text(text);
    } while (remove_between(text, "<?", "?>") || remove_between(text, "<!--", "-->"));
    if (!text.starts_with('<')) {
        return {};
    }
    const std::size_t end = text.find_first_of(" \t\r\n/>", 1);
    if (text.size() == 1 || end == 1) {
        return text.substr(0, 1);
    }
    const std::string_view name = text.substr(1, end == text.npos ? end : end - 1);
    const std::size_t colon = name.find(':');
    return colon == name.npos ? name : name.substr(colon + 1);
}

std::string foreign_format(std::string_view bytes)
{
    for (const ForeignFormat& each : foreign_bytes) {
        if (bytes.starts_with(each.mark)) {
            return std::string{each.words};
        }
    }
    const std::string_view root = xml_root(bytes);
    for (const ForeignFormat& each : foreign_roots) {
        if (root == each.mark) {
            return "<" + std::string{root} + ">, " + std::string{each.words};
        }
    }
    if (root == "Project" && bytes.find("<ItemGroup") != bytes.npos) {
        return "a list of files (.plcproj) without its files, which are taken from its folder when "
               "it is given by its path";
    }
    return is_json(bytes) ? "JSON" : "";
}

} // namespace busbar::controller::detail
