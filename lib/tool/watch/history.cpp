#include "history.hpp"

#include <algorithm>
#include <cmath>

namespace busbar::tool::watch {

namespace {

template <typename... T>
std::optional<double> first_of(const Variant& value)
{
    std::optional<double> number;
    const auto take = [&number](const auto* found) {
        if (found != nullptr) {
            number = static_cast<double>(*found);
        }
        return found != nullptr;
    };
    static_cast<void>((take(value.get_if<T>()) || ...));
    return number;
}

std::uint8_t level_of(double number, double least, double greatest)
{
    if (!std::isfinite(number)) {
        return 0;
    }
    // Halves: the difference of two finite numbers may be infinite.
    const double range = greatest / 2 - least / 2;
    const double share = range > 0 ? (number / 2 - least / 2) / range : 0;
    const double steps = History::highest_level - 1;
    return static_cast<std::uint8_t>(1 + std::lround(share * steps));
}

} // namespace

void History::add(double number)
{
    if (numbers_.size() == capacity) {
        numbers_.pop_front();
    }
    numbers_.push_back(number);
}

std::vector<std::uint8_t> History::levels(std::size_t width) const
{
    const std::size_t count = std::min(width, numbers_.size());
    const std::vector<double> newest(numbers_.end() - static_cast<std::ptrdiff_t>(count),
                                     numbers_.end());
    std::vector<double> finite;
    std::ranges::copy_if(newest, std::back_inserter(finite),
                         [](double number) { return std::isfinite(number); });
    const auto [least, greatest] = std::ranges::minmax_element(finite);
    std::vector<std::uint8_t> levels;
    for (const double number : newest) {
        levels.push_back(finite.empty() ? 0 : level_of(number, *least, *greatest));
    }
    return levels;
}

std::optional<double> number_of(const Variant& value)
{
    return first_of<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
                    std::uint32_t, std::int64_t, std::uint64_t, float, double>(value);
}

} // namespace busbar::tool::watch
