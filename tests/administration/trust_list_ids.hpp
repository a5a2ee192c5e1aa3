#pragma once

#include <cstdint>

namespace busbar::test {

inline constexpr std::uint32_t trust_list = 12642; // of DefaultApplicationGroup
inline constexpr std::uint32_t open_method = 12647;
inline constexpr std::uint32_t close_method = 12650;
inline constexpr std::uint32_t read_method = 12652;
inline constexpr std::uint32_t write_method = 12655;
inline constexpr std::uint32_t get_position = 12657;
inline constexpr std::uint32_t set_position = 12660;
inline constexpr std::uint32_t open_with_masks = 12663;
inline constexpr std::uint32_t close_and_update = 12666;
inline constexpr std::uint32_t add_certificate = 12668;
inline constexpr std::uint32_t remove_certificate = 12670;
inline constexpr std::uint32_t open_count = 12646;
inline constexpr std::uint32_t user_trust_list = 14123;
inline constexpr std::uint32_t user_add_certificate = 14151;

} // namespace busbar::test
