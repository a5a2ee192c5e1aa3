#pragma once

#include <set>

#include <busbar/core/expected.hpp>
#include <model/nodeset/document.hpp>

#include "options.hpp"

namespace busbar::generator {

/// The instances that belong to features which the options do not name: those in the file of
/// features and what they consist of or organize. Types stay.
[[nodiscard]] Expected<std::set<NodeId>, Failure>
nodes_of_other_features(const nodeset::Document& document, const Options& options);

} // namespace busbar::generator
