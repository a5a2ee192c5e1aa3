#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/clock.hpp>
#include <busbar/core/record.hpp>

/// Text functions that both logs share.
namespace busbar::controller::detail {

/// Maximum number of bytes of a name in a log (W588, 7-1-6).
inline constexpr std::size_t max_logged_name = 60;

/// Writes a number with at least `width` digits.
[[nodiscard]] std::string padded(std::int64_t number, std::size_t width);

/// Cuts a text after whole characters, to at most so many bytes.
[[nodiscard]] std::string_view cut_text(std::string_view text, std::size_t max_bytes);
/// Cuts a text and replaces control characters and bytes that are not UTF-8 by "?", so that it
/// cannot split a column or line.
[[nodiscard]] std::string clean_text(std::string_view text, std::size_t max_bytes);

// Fields of records.

/// Empty if the field is missing or not a text.
[[nodiscard]] std::string_view text_field(const Record& record, std::string_view name);
/// 0 if the field is missing or not a non-negative integer.
[[nodiscard]] std::uint64_t number_field(const Record& record, std::string_view name);
[[nodiscard]] bool flag_field(const Record& record, std::string_view name, bool otherwise);

/// A local time: "2017-06-23", "15:33:45" and "010".
struct LocalTimeTexts {
    std::string date;
    std::string time;
    std::string millisecond;
};
[[nodiscard]] LocalTimeTexts local_time_texts(DateTime time, TimeZone zone);
/// "2017-06-23T15:33:45Z"; empty for a time of zero.
[[nodiscard]] std::string utc_text(DateTime time);

/// The facts of a certificate that both logs record.
struct CertificateFacts {
    std::string common_name; // the subject if the certificate has none
    DateTime valid_from;
    DateTime valid_to;
    std::string first_host; // of subjectAltName, addresses before names; empty if there is none
    std::string application_uri;
};
/// Nothing if `der` is not a certificate.
[[nodiscard]] std::optional<CertificateFacts> facts_of(std::span<const std::byte> der);

/// "BadCertificateUntrusted".
[[nodiscard]] std::string status_text(StatusCode status);

} // namespace busbar::controller::detail
