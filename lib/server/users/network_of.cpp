#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>

#include "login_guard.hpp"

namespace busbar::server::detail {

namespace {

constexpr std::size_t group_count = 8;

/// Reads the groups of hexadecimal digits in a part of an IPv6 address, until another character.
std::size_t read_groups(std::string_view text, std::array<std::uint16_t, group_count>& groups)
{
    std::size_t count = 0;
    while (count < groups.size() && !text.empty()) {
        const char* const last = text.data() + text.size();
        const auto [end, error] = std::from_chars(text.data(), last, groups[count], 16);
        if (error != std::errc{} || (end != last && *end != ':')) {
            break;
        }
        ++count;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        text.remove_prefix(std::min<std::size_t>(text.size(), 1));
    }
    return count;
}

std::string hexadecimal(std::uint16_t group)
{
    std::array<char, 4> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), group, 16).ptr;
    return {digits.data(), end};
}

} // namespace

std::string network_of(std::string_view address)
{
    constexpr std::string_view mapped = "::ffff:";
    if (address.starts_with(mapped) && address.find('.') != std::string_view::npos) {
        return std::string{address.substr(mapped.size())};
    }
    if (address.find(':') == std::string_view::npos) {
        return std::string{address};
    }
    // The groups that "::" omits are zeros; those after it count from the end.
    std::array<std::uint16_t, group_count> groups{};
    std::array<std::uint16_t, group_count> back{};
    const std::size_t gap = address.find("::");
    const std::size_t front = read_groups(address.substr(0, gap), groups);
    if (gap != std::string_view::npos) {
        const std::size_t count = read_groups(address.substr(gap + 2), back);
        const std::size_t kept = std::min(count, group_count - front);
        std::copy_n(back.begin(), kept, groups.end() - static_cast<std::ptrdiff_t>(kept));
    }
    std::string network;
    for (std::size_t i = 0; i < group_count / 2; ++i) {
        network += hexadecimal(groups[i]) + ":";
    }
    return network + ":/64";
}

} // namespace busbar::server::detail
