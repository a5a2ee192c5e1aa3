#pragma once

#include <string>
#include <vector>

#include "product/configuration/reading.hpp"

namespace busbar::product {

/// What --explain prints of a key of the configuration: its value in force, what says so and what
/// would count without that, the range, and when a change counts. Of "all" a line for each key.
/// Empty for a key that there is not.
[[nodiscard]] std::string explain(const Provenance& provenance, const std::string& key);
/// The keys that may have been meant: those that have the word in them, else the most alike.
[[nodiscard]] std::vector<std::string> keys_like(const Provenance& provenance,
                                                 const std::string& word);
/// Prints that of what `configuration` says; 0, or 2 for a key that there is not.
[[nodiscard]] int print_explanation(const Configuration& configuration, const std::string& key);

} // namespace busbar::product
