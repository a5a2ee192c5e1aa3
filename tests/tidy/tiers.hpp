#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "rules.hpp"

namespace busbar::tidy {

/// The entries of one "## Tier" of include/busbar/README.md, in order: "net/server_app.hpp" for a
/// header, "net/" for all of a folder that no tier names.
using Tier = std::vector<std::string>;

/// Every "- `entry`: text" below a heading that begins with "## Tier".
[[nodiscard]] std::vector<Tier> read_tiers(const File& readme);

/// What is wrong with the tiers of `headers`, which are the public ones with paths from
/// include/busbar: an entry that stands for nothing or is there twice, a header in no tier.
[[nodiscard]] Findings check_tiers(const std::vector<Tier>& tiers,
                                   const std::vector<File>& headers);

/// The lines of the headers that a tier names.
[[nodiscard]] std::size_t lines_of(const Tier& tier, const std::vector<File>& headers);

/// Includes of headers of the library that no entry of `allowed` names.
[[nodiscard]] Findings check_first_programs(const std::vector<File>& programs, const Tier& allowed);

} // namespace busbar::tidy
