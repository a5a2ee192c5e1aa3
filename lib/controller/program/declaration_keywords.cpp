#include "declaration_keywords.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <string>

#include "core/ascii_case.hpp"
#include "declaration_lexer.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::array<std::string_view, 22> keywords{
    "ARRAY",
    "AT",
    "CONFIGURATION",
    "CONSTANT",
    "END_CONFIGURATION",
    "END_RESOURCE",
    "END_STRUCT",
    "END_TYPE",
    "END_UNION",
    "END_VAR",
    "FALSE",
    "NON_RETAIN",
    "OF",
    "OVERLAP",
    "PERSISTENT",
    "RETAIN",
    "STRUCT",
    "TRUE",
    "TYPE",
    "UNION",
    "VAR_GLOBAL",
    "VAR",
};

/// Types of the 3rd edition and of vendors, for which there is no DataType here.
constexpr std::array<std::string_view, 4> unknown_types{"ANY", "POINTER", "REF_TO", "REFERENCE"};

struct TypeWord {
    std::string_view word;
    ElementaryType type;
};

constexpr std::array type_names{
    TypeWord{"BOOL", ElementaryType::Bool},
    TypeWord{"SINT", ElementaryType::Sint},
    TypeWord{"INT", ElementaryType::Int},
    TypeWord{"DINT", ElementaryType::Dint},
    TypeWord{"LINT", ElementaryType::Lint},
    TypeWord{"USINT", ElementaryType::Usint},
    TypeWord{"UINT", ElementaryType::Uint},
    TypeWord{"UDINT", ElementaryType::Udint},
    TypeWord{"ULINT", ElementaryType::Ulint},
    TypeWord{"BYTE", ElementaryType::Byte},
    TypeWord{"WORD", ElementaryType::Word},
    TypeWord{"DWORD", ElementaryType::Dword},
    TypeWord{"LWORD", ElementaryType::Lword},
    TypeWord{"REAL", ElementaryType::Real},
    TypeWord{"LREAL", ElementaryType::Lreal},
    TypeWord{"TIME", ElementaryType::Time},
    TypeWord{"DATE", ElementaryType::Date},
    TypeWord{"TIME_OF_DAY", ElementaryType::TimeOfDay},
    TypeWord{"TOD", ElementaryType::TimeOfDay},
    TypeWord{"DATE_AND_TIME", ElementaryType::DateAndTime},
    TypeWord{"DT", ElementaryType::DateAndTime},
    TypeWord{"STRING", ElementaryType::String},
};

constexpr std::array later_type_names{
    TypeWord{"LTIME", ElementaryType::Ltime},
    TypeWord{"LDATE", ElementaryType::Ldate},
    TypeWord{"LTIME_OF_DAY", ElementaryType::LtimeOfDay},
    TypeWord{"LTOD", ElementaryType::LtimeOfDay},
    TypeWord{"LDATE_AND_TIME", ElementaryType::LdateAndTime},
    TypeWord{"LDT", ElementaryType::LdateAndTime},
    TypeWord{"CHAR", ElementaryType::Char},
    TypeWord{"WCHAR", ElementaryType::Wchar},
    TypeWord{"WSTRING", ElementaryType::Wstring},
    // A member of one bit, as vendors have it, has the values of BOOL.
    TypeWord{"BIT", ElementaryType::Bool},
};

template <std::size_t n>
std::optional<ElementaryType> find_type(const std::array<TypeWord, n>& rows, std::string_view word)
{
    for (const TypeWord& row : rows) {
        if (busbar::detail::is_same_ignoring_case(row.word, word)) {
            return row.type;
        }
    }
    return {};
}

template <std::size_t n>
bool is_one_of(const std::array<std::string_view, n>& words, std::string_view word)
{
    return std::any_of(words.begin(), words.end(), [&](std::string_view one) {
        return busbar::detail::is_same_ignoring_case(one, word);
    });
}

bool is_digit_of_address(char c)
{
    return c >= '0' && c <= '9';
}

struct IntegerRange {
    std::int64_t lower;
    std::uint64_t upper;
};

/// Ranges in the order of ElementaryType, up to Lword.
constexpr std::array integer_ranges{
    IntegerRange{0, 1},
    IntegerRange{INT8_MIN, INT8_MAX},
    IntegerRange{INT16_MIN, INT16_MAX},
    IntegerRange{INT32_MIN, INT32_MAX},
    IntegerRange{INT64_MIN, INT64_MAX},
    IntegerRange{0, UINT8_MAX},
    IntegerRange{0, UINT16_MAX},
    IntegerRange{0, UINT32_MAX},
    IntegerRange{0, UINT64_MAX},
    IntegerRange{0, UINT8_MAX},
    IntegerRange{0, UINT16_MAX},
    IntegerRange{0, UINT32_MAX},
    IntegerRange{0, UINT64_MAX},
};
static_assert(integer_ranges.size() == static_cast<std::size_t>(ElementaryType::Lword) + 1);

bool floating_fits(ElementaryType type, const Variant& value)
{
    // Every 64-bit integer is in the range of both.
    const double* number = value.get_if<double>();
    return number == nullptr
               ? value.get_if<std::int64_t>() != nullptr || value.get_if<std::uint64_t>() != nullptr
               : std::isfinite(*number) &&
                     (type == ElementaryType::Lreal || std::fabs(*number) <= FLT_MAX);
}

struct PublishWord {
    std::string_view word;
    NetworkPublish publish;
};

/// The words without the characters allowed between them.
constexpr std::array publish_words{
    PublishWord{"none", NetworkPublish::Hidden},
    PublishWord{"hidden", NetworkPublish::Hidden},
    PublishWord{"donotpublish", NetworkPublish::Hidden},
    PublishWord{"publishonly", NetworkPublish::PublishOnly},
    PublishWord{"publiconly", NetworkPublish::PublishOnly},
    PublishWord{"public", NetworkPublish::PublishOnly},
    PublishWord{"input", NetworkPublish::Input},
    PublishWord{"output", NetworkPublish::Output},
};

/// Longer than any entry of the table with characters between its words.
constexpr std::size_t longest_word = 40;

std::string_view without_quotes(std::string_view text)
{
    const bool is_quoted = text.size() > 1 && text.front() == text.back() &&
                           (text.front() == '\'' || text.front() == '"');
    return is_quoted ? trimmed_text(text.substr(1, text.size() - 2)) : text;
}

/// Removes the word attribute if the text begins with it.
std::string_view without_attribute(std::string_view text)
{
    constexpr std::string_view word = "attribute";
    const bool begins =
        text.size() > word.size() &&
        busbar::detail::is_same_ignoring_case(text.substr(0, word.size()), word) &&
        std::string_view{" \t\r\n'\""}.find(text[word.size()]) != std::string_view::npos;
    return begins ? trimmed_text(text.substr(word.size())) : text;
}

} // namespace

WordKind kind_of_word(std::string_view word)
{
    constexpr std::size_t longest = 17;
    if (word.size() > longest) {
        return WordKind::Name;
    }
    if (is_one_of(keywords, word)) {
        return WordKind::Keyword;
    }
    if (find_type(type_names, word)) {
        return WordKind::ElementaryType;
    }
    if (find_type(later_type_names, word)) {
        return WordKind::LaterType;
    }
    return is_one_of(unknown_types, word) ? WordKind::UnknownType : WordKind::Name;
}

std::optional<ElementaryType> elementary_type(std::string_view word)
{
    const auto found = find_type(type_names, word);
    return found ? found : find_type(later_type_names, word);
}

bool is_integer(ElementaryType type)
{
    return type >= ElementaryType::Sint && type <= ElementaryType::Ulint;
}

bool is_bit_string(ElementaryType type)
{
    return type >= ElementaryType::Byte && type <= ElementaryType::Lword;
}

bool number_fits(ElementaryType type, const Variant& value)
{
    if (type == ElementaryType::Real || type == ElementaryType::Lreal) {
        return floating_fits(type, value);
    }
    if (type > ElementaryType::Lword) {
        return false;
    }
    const IntegerRange& range = integer_ranges[static_cast<std::size_t>(type)];
    if (const auto* number = value.get_if<std::int64_t>()) {
        return *number >= range.lower &&
               (*number < 0 || static_cast<std::uint64_t>(*number) <= range.upper);
    }
    const auto* number = value.get_if<std::uint64_t>();
    return number != nullptr && *number <= range.upper;
}

namespace {

/// Names of devices, which precede the number (SH-082679, 8.3, Collectible devices).
constexpr std::array<std::string_view, 52> device_names{
    "FX", "FY",  "FD",  "SM",  "SD", "X",   "Y",   "M",   "L",   "F",    "V",    "B",    "D",
    "W",  "T",   "TS",  "TC",  "TN", "LT",  "LTS", "LTC", "LTN", "C",    "CS",   "CC",   "CN",
    "LC", "LCS", "LCC", "LCN", "ST", "STS", "STC", "STN", "LST", "LSTS", "LSTC", "LSTN", "SB",
    "SW", "S",   "Z",   "LZ",  "R",  "ZR",  "RD",  "G",   "HG",  "DX",   "DY",   "BL",   "N"};

bool is_hexadecimal(char c)
{
    return is_digit_of_address(c) || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f');
}

/// Tells whether the text names a device of a PLC that has names for its memory: "D100", "W1F",
/// "J1\\X0", "U3E0\\HG5".
bool is_device(std::string_view text)
{
    if (const std::size_t step = text.find('\\'); step != std::string_view::npos) {
        const std::string_view module = text.substr(0, step);
        if (module.size() < 2 || std::string_view{"JUju"}.find(module.front()) == module.npos ||
            !std::all_of(module.begin() + 1, module.end(), is_hexadecimal)) {
            return false;
        }
        text.remove_prefix(step + 1);
    }
    return std::any_of(device_names.begin(), device_names.end(), [&](std::string_view name) {
        const std::string_view number = text.substr(std::min(name.size(), text.size()));
        return busbar::detail::is_same_ignoring_case(text.substr(0, name.size()), name) &&
               !number.empty() && is_digit_of_address(number.front()) &&
               std::all_of(number.begin(), number.end(), is_hexadecimal);
    });
}

} // namespace

bool is_direct_address(std::string_view text)
{
    if (text.starts_with('%') && is_device(text.substr(1))) {
        return true;
    }
    const auto take_one_of = [&](std::string_view letters) {
        const bool is_there = !text.empty() && letters.find(text.front()) != std::string_view::npos;
        text.remove_prefix(is_there ? 1 : 0);
        return is_there;
    };
    if (!take_one_of("%") || !take_one_of("IQMiqm")) {
        return false;
    }
    take_one_of("XBWDLxbwdl");
    if (text == "*") {
        return true;
    }
    bool is_number_before = false;
    for (const char c : text) {
        if (!is_digit_of_address(c) && (c != '.' || !is_number_before)) {
            return false;
        }
        is_number_before = c != '.';
    }
    return is_number_before;
}

std::optional<NetworkPublish> publish_of(std::string_view words)
{
    std::string plain;
    if (words.size() <= longest_word) {
        for (const char c : words) {
            if (c != ' ' && c != '-' && c != '_') {
                plain += busbar::detail::to_ascii_lower(c);
            }
        }
    }
    for (const PublishWord& row : publish_words) {
        if (row.word == plain) {
            return row.publish;
        }
    }
    return {};
}

PublishPragma read_publish_pragma(std::string_view text)
{
    const std::size_t assign = text.find(":=");
    if (assign == std::string_view::npos) {
        return {};
    }
    const std::string_view name =
        without_quotes(without_attribute(trimmed_text(text.substr(0, assign))));
    const std::string_view value = without_quotes(trimmed_text(text.substr(assign + 2)));
    if (busbar::detail::is_same_ignoring_case(name, "OPC.UA.DA")) {
        return {true, value == "1"   ? std::optional{NetworkPublish::PublishOnly}
                      : value == "0" ? std::optional{NetworkPublish::Hidden}
                                     : std::nullopt};
    }
    if (busbar::detail::is_same_ignoring_case(name, "publish")) {
        return {true, publish_of(value)};
    }
    return {};
}

} // namespace busbar::controller::detail
