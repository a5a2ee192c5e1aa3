#include <array>
#include <charconv>
#include <cmath>

#include <busbar/controller/mapping.hpp>

#include "core/number_text.hpp"

namespace busbar::controller {

namespace {

constexpr std::string_view between = "..";

/// Writes the shortest text that reads as the same number.
std::string number_text(double number)
{
    std::array<char, 64> text{};
    for (int digits = 6; digits <= 17; ++digits) {
        std::snprintf(text.data(), text.size(), "%.*g", digits, number);
        double again = 0;
        const std::string_view written{text.data()};
        const auto read =
            busbar::detail::read_number(written.data(), written.data() + written.size(), again);
        if (read.ec == std::errc{} && again == number) {
            break;
        }
    }
    return text.data();
}

bool read_one(std::string_view text, double& to)
{
    const char* const end = text.data() + text.size();
    const auto [stop, error] = busbar::detail::read_number(text.data(), end, to);
    return error == std::errc{} && stop == end && std::isfinite(to);
}

/// Parses a range such as "0..100".
bool read_range(std::string_view text, double& low, double& high)
{
    const std::size_t at = text.find(between);
    return at != std::string_view::npos && read_one(text.substr(0, at), low) &&
           read_one(text.substr(at + between.size()), high) && low != high &&
           std::isfinite(high - low);
}

} // namespace

std::string to_text(const Scaling& scaling)
{
    const auto range = [](double low, double high) {
        return number_text(low) + std::string{between} + number_text(high);
    };
    if (!scaling.is_set()) {
        return {};
    }
    return range(scaling.raw_low, scaling.raw_high) +
           (scaling.has_range() ? "=" + range(scaling.low, scaling.high) : "");
}

std::optional<Scaling> parse_scaling(std::string_view text)
{
    Scaling scaling;
    const std::size_t equals = text.find('=');
    const bool is_read = read_range(text.substr(0, equals), scaling.raw_low, scaling.raw_high) &&
                         (equals == std::string_view::npos ||
                          read_range(text.substr(equals + 1), scaling.low, scaling.high));
    return is_read ? std::optional{scaling} : std::nullopt;
}

} // namespace busbar::controller
