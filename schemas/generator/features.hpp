#pragma once

#include <set>

#include <model/nodeset/document.hpp>
#include <tl/expected.hpp>

#include "options.hpp"

namespace busbar::generator {

/// The instances that belong to features which the options do not name: those in the file of
/// features and what they consist of or organize. Types stay.
[[nodiscard]] tl::expected<std::set<NodeId>, Failure>
nodes_of_other_features(const nodeset::Document& document, const Options& options);

} // namespace busbar::generator
