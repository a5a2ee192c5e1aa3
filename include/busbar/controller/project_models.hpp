#pragma once

#include <busbar/controller/model_set.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// The information models of a project as an AddressSpace. In the target busbar::model_mode, which
/// needs pugixml.
namespace busbar::controller {

struct MappingCheck;

/// Returns the limits of the project's preset; without a preset the defaults.
[[nodiscard]] BUSBAR_API ModelLimits model_limits(const Project& project);

/// Imports all models in their order; the problem is the first error of the first model that cannot
/// be imported, with file, line and node. Warnings, and mapping that cannot be read, are added to
/// `reports`, if it is not null.
[[nodiscard]] BUSBAR_API Configured<ModelSet> load_models(const Project& project,
                                                          ModelReports* reports = nullptr);

/// Replaces the project's models with these, including their present mapping.
BUSBAR_API void keep_models(const ModelSet& models, Project& project);

/// Like load_models, as ProjectStore::Check: checks whether a server could load the project. Nodes
/// that cannot be mapped are not a problem.
[[nodiscard]] BUSBAR_API Configured<void> check_models(const Project& project);
/// Also checks whether everything that is mapped could be served (SH-082679, 8.3: a
/// wrong mapping is unavailable): by check_mapping, and by the rules for names of labels.
[[nodiscard]] BUSBAR_API Configured<void> check_mapped_models(const Project& project);
/// Calls check_mapping for a project's models, with the names of labels; with a preset also with
/// their characters (Appendix 6).
[[nodiscard]] BUSBAR_API MappingCheck check_project_mapping(const Project& project,
                                                            const ModelSet& models);

} // namespace busbar::controller
