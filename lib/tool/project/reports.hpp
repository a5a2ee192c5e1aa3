#pragma once

#include <vector>

#include <busbar/controller/mapping_check.hpp>
#include <busbar/controller/project_compare.hpp>
#include <busbar/controller/project_models.hpp>

#include "tool/connection/context.hpp"

namespace busbar::tool::project {

/// The project's models; throws Failure.
[[nodiscard]] controller::ModelSet open_models(const controller::Project& project);
/// All that is wrong with the project's models and mapping, and how full it is.
[[nodiscard]] controller::MappingCheck check_project_models(const controller::Project& project);
/// Lists the differences between two projects, including their models.
[[nodiscard]] std::vector<controller::ProjectDifference>
differences_of(const controller::Project& first, const controller::Project& second);
/// Prints differences as a table, or as JSON with members named like the titles in lower case.
/// Returns Failed if there are any.
Exit print_differences(Context& context,
                       const std::vector<controller::ProjectDifference>& differences,
                       const char* first, const char* second);
/// On standard error, a line each.
void print_reports(Context& context, const controller::ModelReports& reports);

} // namespace busbar::tool::project
