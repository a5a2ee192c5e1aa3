#pragma once

#include <string>
#include <vector>

#include "product/configuration/reading.hpp"

namespace busbar::product {

/// The text of --explain for a key of the configuration: its value in force, where it comes from
/// and what it would be otherwise, the range, and when a change takes effect. For "all" a line for
/// each key. Empty for an unknown key.
[[nodiscard]] std::string explain(const Provenance& provenance, const std::string& key);
/// Suggests keys: those that contain the word, otherwise the most similar ones.
[[nodiscard]] std::vector<std::string> keys_like(const Provenance& provenance,
                                                 const std::string& word);
/// Prints the explanation for `configuration`; returns 0, or 2 for an unknown key.
[[nodiscard]] int print_explanation(const Configuration& configuration, const std::string& key);

} // namespace busbar::product
