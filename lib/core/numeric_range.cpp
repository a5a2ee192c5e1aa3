#include <busbar/core/numeric_range.hpp>

#include <charconv>

namespace busbar {

namespace {

bool parse_number(std::string_view text, std::uint32_t& number)
{
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, number);
    return !text.empty() && error == std::errc{} && stopped == end;
}

/// "3" or "1:4" (Part 4, A.3).
bool parse_bounds(std::string_view text, NumericRange::Bounds& bounds)
{
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) {
        const bool is_number = parse_number(text, bounds.first);
        bounds.last = bounds.first;
        return is_number;
    }
    // Part 4, 7.27: of two numbers the second is the larger.
    return parse_number(text.substr(0, colon), bounds.first) &&
           parse_number(text.substr(colon + 1), bounds.last) && bounds.first < bounds.last;
}

} // namespace

Result<NumericRange> NumericRange::parse(std::string_view text)
{
    NumericRange range;
    while (!text.empty()) {
        const std::size_t comma = text.find(',');
        const bool is_last = comma == std::string_view::npos;
        Bounds bounds;
        if (range.count_ == max_dimensions || !parse_bounds(text.substr(0, comma), bounds) ||
            (!is_last && comma + 1 == text.size())) {
            return fail(status::Bad_IndexRangeInvalid);
        }
        range.bounds_[range.count_++] = bounds;
        text.remove_prefix(is_last ? text.size() : comma + 1);
    }
    return range;
}

} // namespace busbar
