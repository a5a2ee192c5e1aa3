#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace busbar::bench {

/// Loads NodeSet2 files together and prints what that costs.
void print_load(const std::vector<std::string>& files);

/// Writes machines of these sizes to a temporary file each, loads it, and prints what that costs.
void print_load_growth(std::span<const std::uint32_t> sizes);

} // namespace busbar::bench
