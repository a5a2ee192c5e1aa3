#pragma once

#include <span>
#include <string>
#include <string_view>

#include <busbar/administration/setting_list.hpp>
#include <busbar/core/problem.hpp>

#include "toml.hpp"

namespace busbar::product {

/// Settings that a machine accepts in PROGRAM mode only: those of its server and its security
/// (W588, 3-2-2 and 3-2-6: "Changes in RUN mode").
[[nodiscard]] std::span<const std::string_view> program_only_settings();

/// Checks a change on a machine in RUN: Bad_InvalidState, with the name, if one of those settings
/// differs between `now` and `next`.
[[nodiscard]] Configured<void> check_in_run(const administration::SettingValues& now,
                                            const administration::SettingValues& next);

/// The same for a file that is read again, with its tables as `now` and `next`. Checks only its
/// security ([users], [[endpoint]] and [security]), which takes effect at once; the other settings
/// wait for a restart.
[[nodiscard]] Configured<void> check_file_in_run(const toml::table& now, const toml::table& next);

/// The problem with a change on a machine in RUN.
[[nodiscard]] Unexpected<Problem> refused_in_run(std::string what);

} // namespace busbar::product
