#pragma once

#include <span>
#include <string>
#include <string_view>

#include <busbar/administration/setting_list.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

/// Settings that a machine takes in PROGRAM only: those of its server and of its security (seed
/// 000, 3-2-2 and 3-2-6: "Changes in RUN mode").
[[nodiscard]] std::span<const std::string_view> program_only_settings();

/// Of a machine that is in RUN: Bad_InvalidState if one of those is another one in `next` than
/// `now`, by its name.
[[nodiscard]] Configured<void> check_in_run(const administration::SettingValues& now,
                                            const administration::SettingValues& next);

/// Why a machine that is in RUN does not change that.
[[nodiscard]] Unexpected<Problem> refused_in_run(std::string what);

} // namespace busbar::product
