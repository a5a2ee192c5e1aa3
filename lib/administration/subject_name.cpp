#include "subject_name.hpp"

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
};

constexpr std::array fields{
    Field{"CN", &CertificateSubject::common_name},
    Field{"O", &CertificateSubject::organization},
    Field{"OU", &CertificateSubject::organizational_unit},
    Field{"L", &CertificateSubject::locality},
    Field{"S", &CertificateSubject::state},
    Field{"ST", &CertificateSubject::state},
    Field{"C", &CertificateSubject::country},
    Field{"DC", &CertificateSubject::domain_component},
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

/// Takes the value off the front of `rest`; nothing if a quote is not closed.
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
        if (field == fields.end() || !value || !busbar::detail::is_name(*value)) {
            return refuse({status::Bad_InvalidArgument, "subject name", "found " + printable(text),
                           "Part 12, 7.9.4", "Write it as CN=Press 4/O=Works"});
        }
        subject.*field->member = *value;
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
