#pragma once

#include <span>
#include <string>
#include <string_view>

#include <busbar/administration/setting_list.hpp>
#include <busbar/core/problem.hpp>

#include "toml.hpp"

namespace busbar::product {

/// Settings that a machine takes in PROGRAM only: those of its server and of its security
/// (W588, 3-2-2 and 3-2-6: "Changes in RUN mode").
[[nodiscard]] std::span<const std::string_view> program_only_settings();

/// Of a machine that is in RUN: Bad_InvalidState if one of those is another one in `next` than
/// `now`, by its name.
[[nodiscard]] Configured<void> check_in_run(const administration::SettingValues& now,
                                            const administration::SettingValues& next);

/// The same of a file that is read again: `now` and `next` are its tables. Of its security only
/// ([users], [[endpoint]] and [security]), which counts at once; all else of those settings waits
/// for a restart.
[[nodiscard]] Configured<void> check_file_in_run(const toml::table& now, const toml::table& next);

/// Why a machine that is in RUN does not change that.
[[nodiscard]] Unexpected<Problem> refused_in_run(std::string what);

} // namespace busbar::product
