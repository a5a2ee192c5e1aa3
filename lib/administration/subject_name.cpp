#include "own_certificate_methods.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include <busbar/core/text.hpp>

#include "core/utf8.hpp"

namespace busbar::administration::detail {

namespace {

using crypto::CertificateSubject;

struct Field {
    std::string_view name;
    std::string CertificateSubject::*member;
    /// Maximum number of characters (RFC 5280, Appendix A.1).
    std::size_t longest;
};

constexpr std::array fields{
    Field{"CN", &CertificateSubject::common_name, 64},
    Field{"O", &CertificateSubject::organization, 64},
    Field{"OU", &CertificateSubject::organizational_unit, 64},
    Field{"L", &CertificateSubject::locality, 128},
    Field{"S", &CertificateSubject::state, 128},
    Field{"ST", &CertificateSubject::state, 128},
    Field{"C", &CertificateSubject::country, 2},
    Field{"DC", &CertificateSubject::domain_component, 128},
};

constexpr std::string_view separators = "/,";

std::string_view trim(std::string_view text)
{
    while (!text.empty() && text.front() == ' ') {
        text.remove_prefix(1);
    }
    while (!text.empty() && text.back() == ' ') {
        text.remove_suffix(1);
    }
    return text;
}

/// Takes the value at the front of `rest`; nothing if a quote is not closed.
std::optional<std::string_view> take_value(std::string_view& rest)
{
    rest = trim(rest);
    if (!rest.empty() && rest.front() == '"') {
        const std::size_t end = rest.find('"', 1);
        if (end == std::string_view::npos) {
            return std::nullopt;
        }
        const std::string_view value = rest.substr(1, end - 1);
        rest = trim(rest.substr(end + 1));
        return rest.empty() || separators.find(rest.front()) != std::string_view::npos
                   ? std::optional{value}
                   : std::nullopt;
    }
    const std::size_t end = std::min(rest.find_first_of(separators), rest.size());
    const std::string_view value = trim(rest.substr(0, end));
    rest.remove_prefix(end);
    return value;
}

/// Describes what is expected instead of the value; empty if the value is valid.
std::string fault_of(const Field& field, std::string_view value)
{
    const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
    const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
    const bool is_country = field.member == &CertificateSubject::country;
    if (is_country && (value.size() != 2 || !std::all_of(value.begin(), value.end(), is_letter))) {
        return "two letters, such as JP";
    }
    if (field.member == &CertificateSubject::domain_component &&
        !std::all_of(value.begin(), value.end(), is_ascii)) {
        return "ASCII characters only";
    }
    const auto characters = std::count_if(value.begin(), value.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; // not a continuation
    });
    return static_cast<std::size_t>(characters) <= field.longest
               ? std::string{}
               : "at most " + std::to_string(field.longest) + " characters";
}

} // namespace

Checked<CertificateSubject> with_names(CertificateSubject subject, std::string_view text)
{
    if (trim(text).empty()) {
        return subject;
    }
    for (const Field& field : fields) {
        (subject.*field.member).clear();
    }
    std::string_view rest = trim(text);
    const auto wrong = [&](std::string found) {
        return refuse({status::Bad_InvalidArgument, "subject name",
                       std::move(found) + " in " + printable(text), "Part 12, 7.9.4",
                       "Write it as CN=Press 4/O=Works, a value that has / or , in double quotes"});
    };
    while (!rest.empty()) {
        if (separators.find(rest.front()) != std::string_view::npos) {
            rest = trim(rest.substr(1));
            continue;
        }
        const std::size_t equals = std::min(rest.find('='), rest.size());
        const std::string_view name = trim(rest.substr(0, equals));
        const auto* const field = std::find_if(
            fields.begin(), fields.end(), [&](const Field& each) { return each.name == name; });
        rest.remove_prefix(std::min(equals + 1, rest.size()));
        const auto value = take_value(rest);
        if (field == fields.end()) {
            return wrong("found \"" + printable(name) +
                         "\", expected one of CN, O, OU, L, S, C and DC");
        }
        if (!value || !busbar::detail::is_name(*value)) {
            return wrong(std::string{name} +
                         " has no value, or one without its closing quote or with control "
                         "characters");
        }
        if (const std::string fault = fault_of(*field, *value); !fault.empty()) {
            return wrong(std::string{name} + " is \"" + printable(*value) + "\", expected " +
                         fault);
        }
        subject.*field->member = *value;
    }
    if (subject.common_name.empty()) {
        return wrong("found no CN");
    }
    return subject;
}

std::string text_of_names(const CertificateSubject& subject)
{
    std::string text;
    for (const Field& field : fields) {
        const std::string& value = subject.*field.member;
        if (!value.empty() && field.name != "ST") { // another name of S
            text += (text.empty() ? "" : "/") + std::string{field.name} + "=\"" + value + "\"";
        }
    }
    return text;
}

} // namespace busbar::administration::detail
