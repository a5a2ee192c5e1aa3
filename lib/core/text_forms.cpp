#include <busbar/core/text_forms.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>

namespace busbar {

namespace {

/// Splits a text from its front; fails for good at the first missing part.
class Parts {
public:
    explicit Parts(std::string_view text) : text_{text} {}

    /// Reads a number of exactly `count` digits.
    int digits(std::size_t count)
    {
        int number = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const char c = text_.empty() ? '\0' : text_.front();
            ok_ = ok_ && c >= '0' && c <= '9';
            if (!ok_) {
                return 0;
            }
            number = number * 10 + (c - '0');
            text_.remove_prefix(1);
        }
        return number;
    }
    bool skip(char c)
    {
        const bool is_there = !text_.empty() && text_.front() == c;
        text_.remove_prefix(is_there ? 1 : 0);
        return is_there;
    }
    void expect(char c) { ok_ = skip(c) && ok_; }
    /// Reads the digits after a decimal point as ticks; digits finer than a tick are cut off.
    std::int64_t fraction()
    {
        std::int64_t ticks = 0;
        std::int64_t unit = DateTime::ticks_per_second / 10;
        ok_ = ok_ && is_at_digit();
        while (is_at_digit()) {
            ticks += unit * (text_.front() - '0');
            unit /= 10;
            text_.remove_prefix(1);
        }
        return ticks;
    }
    [[nodiscard]] bool ok() const { return ok_; }
    [[nodiscard]] bool is_over() const { return text_.empty(); }

private:
    [[nodiscard]] bool is_at_digit() const
    {
        return !text_.empty() && text_.front() >= '0' && text_.front() <= '9';
    }

    std::string_view text_;
    bool ok_{true};
};

/// Reads the offset of local time from UTC: "Z" or nothing for 0, else "+01:00".
std::chrono::minutes read_offset(Parts& parts)
{
    if (parts.is_over() || parts.skip('Z')) {
        return std::chrono::minutes{0};
    }
    const bool is_behind = parts.skip('-');
    if (!is_behind) {
        parts.expect('+');
    }
    const int hours = parts.digits(2);
    parts.expect(':');
    const std::chrono::minutes offset{hours * 60 + parts.digits(2)};
    return is_behind ? -offset : offset;
}

} // namespace

std::optional<DateTime> parse_date_time(std::string_view text)
{
    Parts parts{text};
    const std::chrono::year year{parts.digits(4)};
    parts.expect('-');
    const std::chrono::month month{static_cast<unsigned>(parts.digits(2))};
    parts.expect('-');
    const std::chrono::day day{static_cast<unsigned>(parts.digits(2))};
    int hour = 0;
    int minute = 0;
    int second = 0;
    std::int64_t fraction = 0;
    if (parts.skip('T')) {
        hour = parts.digits(2);
        parts.expect(':');
        minute = parts.digits(2);
        parts.expect(':');
        second = parts.digits(2);
        fraction = parts.skip('.') ? parts.fraction() : 0;
    }
    const std::chrono::minutes offset = read_offset(parts);
    const std::chrono::year_month_day date{year, month, day};
    const bool is_midnight = hour == 24 && minute == 0 && second == 0 && fraction == 0;
    if (!parts.ok() || !parts.is_over() || !date.ok() || (hour > 23 && !is_midnight) ||
        minute > 59 || second > 60) {
        return std::nullopt;
    }
    const auto seconds = std::chrono::sys_days{date}.time_since_epoch() + std::chrono::hours{hour} +
                         std::chrono::minutes{minute} - offset + std::chrono::seconds{second};
    const DateTime time = DateTime::from_unix_seconds(std::chrono::seconds{seconds}.count());
    return DateTime{DateTime{time.ticks + fraction}.clamped()};
}

std::optional<ExpandedNodeId> parse_expanded_node_id(std::string_view text)
{
    ExpandedNodeId result;
    if (text.starts_with("svr=")) {
        text.remove_prefix(4);
        const std::size_t end = std::min(text.find(';'), text.size());
        const auto [stop, error] =
            std::from_chars(text.data(), text.data() + end, result.server_index);
        if (error != std::errc{} || stop != text.data() + end || end == text.size()) {
            return std::nullopt;
        }
        text.remove_prefix(end + 1);
    }
    if (text.starts_with("nsu=")) {
        text.remove_prefix(4);
        const std::size_t end = text.find(';');
        if (end == 0 || end == std::string_view::npos) {
            return std::nullopt;
        }
        result.namespace_uri = String{text.substr(0, end)};
        text.remove_prefix(end + 1);
    }
    auto id = NodeId::parse(text);
    if (!id || (!result.namespace_uri.is_null() && id->namespace_index() != 0)) {
        return std::nullopt;
    }
    result.node_id = *std::move(id);
    return result;
}

} // namespace busbar
