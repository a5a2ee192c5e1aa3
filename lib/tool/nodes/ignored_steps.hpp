#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/crypto/certificate_validator.hpp>

namespace busbar::tool {

/// Steps of the check of a server's certificate that `--ignore` suppresses, by their names.
[[nodiscard]] std::vector<std::string> ignorable_steps();
/// Returns settings that suppress the steps with these names and no others.
[[nodiscard]] crypto::ValidationSettings settings_of(const std::vector<std::string>& steps);
/// "--ignore host-name" for the step that fails with this status; empty for one that always counts.
[[nodiscard]] std::string switch_for(StatusCode status);

} // namespace busbar::tool
