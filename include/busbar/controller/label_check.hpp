#pragma once

#include <busbar/controller/model_report.hpp>
#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// Checks whether a project's labels exist in a PLC's program, before a server asks the PLC. In the
/// target busbar::model_mode, which needs pugixml.
namespace busbar::controller {

class ModelSet;

/// Returns the nodes that are mapped to labels that the program does not have, or whose type does
/// not fit the node: where a server would report the errors 1921H and 1A00H (manual of model mode,
/// 8.3). A problem is one with the program.
[[nodiscard]] BUSBAR_API Configured<ModelReports> check_labels(const ModelSet& models,
                                                               Program program);

} // namespace busbar::controller
