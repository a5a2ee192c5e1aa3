#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/clock.hpp>
#include <busbar/core/record.hpp>

/// What both logs write of a record.
namespace busbar::controller::detail {

/// Bytes that a name may have in a log (W588, 7-1-6).
inline constexpr std::size_t max_logged_name = 60;

/// At least so many digits.
[[nodiscard]] std::string padded(std::int64_t number, std::size_t width);

/// The front of `text`, at most so many bytes and whole characters.
[[nodiscard]] std::string_view cut_text(std::string_view text, std::size_t max_bytes);
/// That, with "?" for each byte that is a control character's or not UTF-8: it can neither part
/// columns nor lines.
[[nodiscard]] std::string clean_text(std::string_view text, std::size_t max_bytes);

// Fields of records, whoever told them.

/// Empty if there is none, or no text.
[[nodiscard]] std::string_view text_field(const Record& record, std::string_view name);
/// 0 if there is none, or no integer that is 0 or more.
[[nodiscard]] std::uint64_t number_field(const Record& record, std::string_view name);
[[nodiscard]] bool flag_field(const Record& record, std::string_view name, bool otherwise);

/// "2017-06-23", "15:33:45" and "010" in the time of a place.
struct LocalTimeTexts {
    std::string date;
    std::string time;
    std::string millisecond;
};
[[nodiscard]] LocalTimeTexts local_time_texts(DateTime time, TimeZone zone);
/// "2017-06-23T15:33:45Z"; empty for no time.
[[nodiscard]] std::string utc_text(DateTime time);

/// What both logs say of a certificate.
struct CertificateFacts {
    std::string common_name; // the subject if there is none
    DateTime valid_from;
    DateTime valid_to;
    std::string first_host; // of subjectAltName, addresses before names; empty if there is none
    std::string application_uri;
};
/// Nothing if `der` is no certificate.
[[nodiscard]] std::optional<CertificateFacts> facts_of(std::span<const std::byte> der);

/// "BadCertificateUntrusted".
[[nodiscard]] std::string status_text(StatusCode status);

} // namespace busbar::controller::detail
