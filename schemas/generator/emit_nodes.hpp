#pragma once

#include <string>

#include <busbar/core/expected.hpp>

#include <model/nodeset/document.hpp>

#include "options.hpp"

namespace busbar::generator {

/// Writes nodes.hpp and nodes.cpp: the nodes of `options.namespace_uri` as a model::StaticNodes.
///
/// For namespace 0 that is `busbar::model::namespace0_nodes()`, for any other `nodes()` in the C++
/// namespace of the options.
[[nodiscard]] Expected<void, Failure> emit_nodes(const nodeset::Document& document,
                                                 const Options& options);

} // namespace busbar::generator
