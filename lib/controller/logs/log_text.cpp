#include "log_text.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <busbar/core/string.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/self_signed.hpp>

#include "core/utf8.hpp"

namespace busbar::controller::detail {

namespace {

/// Size of the next character, or 1 for an invalid byte.
std::size_t size_of_next(std::string_view text)
{
    return std::max<std::size_t>(busbar::detail::utf8_sequence(text), 1);
}

bool is_control(char c)
{
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7F;
}

template <typename... T>
std::uint64_t integer_of(const Variant& value)
{
    std::uint64_t result = 0;
    const auto take = [&](const auto* number) {
        if (number != nullptr && std::cmp_greater(*number, 0)) {
            result = static_cast<std::uint64_t>(*number);
        }
    };
    (take(value.get_if<T>()), ...);
    return result;
}

bool is_address(const std::string& host)
{
    const bool is_v4 = std::all_of(host.begin(), host.end(),
                                   [](char c) { return c == '.' || (c >= '0' && c <= '9'); });
    return is_v4 || host.find(':') != std::string::npos;
}

} // namespace

std::string padded(std::int64_t number, std::size_t width)
{
    const std::string text = std::to_string(number);
    return std::string(width - std::min(width, text.size()), '0') + text;
}

std::string_view cut_text(std::string_view text, std::size_t max_bytes)
{
    std::size_t size = 0;
    while (size < text.size()) {
        const std::size_t next = size_of_next(text.substr(size));
        if (size + next > max_bytes) {
            break;
        }
        size += next;
    }
    return text.substr(0, size);
}

std::string clean_text(std::string_view text, std::size_t max_bytes)
{
    std::string result;
    for (std::string_view rest = cut_text(text, max_bytes); !rest.empty();) {
        const std::size_t size = busbar::detail::utf8_sequence(rest);
        if (size == 0 || is_control(rest.front())) {
            result += '?';
        } else {
            result += rest.substr(0, size);
        }
        rest.remove_prefix(std::max<std::size_t>(size, 1));
    }
    return result;
}

std::string_view text_field(const Record& record, std::string_view name)
{
    const Variant* const value = field(record, name);
    const String* const text = value == nullptr ? nullptr : value->get_if<String>();
    return text == nullptr ? std::string_view{} : text->view();
}

std::uint64_t number_field(const Record& record, std::string_view name)
{
    const Variant* const value = field(record, name);
    return value == nullptr
               ? 0
               : integer_of<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                            std::int32_t, std::uint64_t, std::int64_t>(*value);
}

bool flag_field(const Record& record, std::string_view name, bool otherwise)
{
    const Variant* const value = field(record, name);
    return value == nullptr ? otherwise : value->value_or(otherwise);
}

LocalTimeTexts local_time_texts(DateTime time, TimeZone zone)
{
    using namespace std::chrono;
    constexpr std::int64_t minute = 60 * DateTime::ticks_per_second;
    const std::int64_t ticks =
        std::clamp<std::int64_t>(time.ticks, minute * INT16_MAX, DateTime::latest) +
        zone.offset * minute;
    using Ticks = duration<std::int64_t, std::ratio<1, DateTime::ticks_per_second>>;
    const sys_time<milliseconds> moment{floor<milliseconds>(Ticks{ticks - DateTime::unix_epoch})};
    const auto day = floor<days>(moment);
    const year_month_day date{day};
    const hh_mm_ss clock{moment - day};
    return {padded(static_cast<int>(date.year()), 4) + "-" +
                padded(static_cast<unsigned>(date.month()), 2) + "-" +
                padded(static_cast<unsigned>(date.day()), 2),
            padded(clock.hours().count(), 2) + ":" + padded(clock.minutes().count(), 2) + ":" +
                padded(clock.seconds().count(), 2),
            padded(clock.subseconds().count(), 3)};
}

std::string utc_text(DateTime time)
{
    if (time.is_null()) {
        return {};
    }
    const LocalTimeTexts texts = local_time_texts(time, {});
    return texts.date + "T" + texts.time + "Z";
}

std::optional<CertificateFacts> facts_of(std::span<const std::byte> der)
{
    const auto certificate = crypto::Certificate::parse(der);
    if (!certificate) {
        return std::nullopt;
    }
    CertificateFacts facts{crypto::subject_of(*certificate).common_name, certificate->valid_from(),
                           certificate->valid_to(), "", certificate->application_uri()};
    if (facts.common_name.empty()) {
        facts.common_name = certificate->subject();
    }
    auto hosts = certificate->host_names();
    std::stable_partition(hosts.begin(), hosts.end(), is_address);
    facts.first_host = hosts.empty() ? "" : std::move(hosts.front());
    return facts;
}

std::string status_text(StatusCode status)
{
    std::string text{name(status)};
    text.erase(std::remove(text.begin(), text.end(), '_'), text.end());
    return text;
}

} // namespace busbar::controller::detail
