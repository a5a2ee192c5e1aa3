#pragma once

#include <busbar/controller/mapping_check.hpp>
#include <busbar/controller/project_models.hpp>

#include "tool/connection/context.hpp"

namespace busbar::tool::project {

/// The project's models; throws Failure.
[[nodiscard]] controller::ModelSet open_models(const controller::Project& project);
/// controller::check_mapping that knows what a label may be called (seed 001, 8.3), with the
/// project's preset by its characters too (Appendix 6).
[[nodiscard]] controller::MappingCheck check_models(const controller::Project& project,
                                                    const controller::ModelSet& models);
/// On standard error, a line each.
void print_reports(Context& context, const controller::ModelReports& reports);

} // namespace busbar::tool::project
