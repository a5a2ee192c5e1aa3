#pragma once

#include <busbar/controller/model_report.hpp>
#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// Whether the labels of a project are those of a PLC's program, before a server asks the PLC. Of
/// the target busbar::model_mode, which needs pugixml.
namespace busbar::controller {

class ModelSet;

/// What is mapped to labels that the program does not have, or has of a type that the node cannot
/// have: what a server would answer with the errors 1921H and 1A00H (seed 001, 8.3). A problem is
/// one of the program.
[[nodiscard]] BUSBAR_API Configured<ModelReports> check_labels(const ModelSet& models,
                                                               Program program);

} // namespace busbar::controller
