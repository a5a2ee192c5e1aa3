#pragma once

#include <busbar/controller/model_set.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// The information models of a project as an AddressSpace. Of the target busbar::model_mode, which
/// needs pugixml.
namespace busbar::controller {

struct MappingCheck;

/// What the project's preset allows; without one the default.
[[nodiscard]] BUSBAR_API ModelLimits model_limits(const Project& project);

/// Imports all models in their order; the problem is the first error of the first that cannot be
/// imported, with file, line and node. Warnings, and mapping that cannot be read, are added to
/// `reports`, if there is such.
[[nodiscard]] BUSBAR_API Configured<ModelSet> load_models(const Project& project,
                                                          ModelReports* reports = nullptr);

/// Puts the models with their mapping as it is now in the place of those that the project has.
BUSBAR_API void keep_models(const ModelSet& models, Project& project);

/// The same as load_models, as ProjectStore::Check: whether a server could load the project. What
/// cannot be mapped is no problem of it.
[[nodiscard]] BUSBAR_API Configured<void> check_models(const Project& project);
/// Whether all that is mapped could be served, too (seed 001, 8.3: mapping that is wrong is
/// unavailable): what check_mapping says, and what a label may be called.
[[nodiscard]] BUSBAR_API Configured<void> check_mapped_models(const Project& project);
/// check_mapping of a project's models with the names of labels: with its preset by their
/// characters too (Appendix 6).
[[nodiscard]] BUSBAR_API MappingCheck check_project_mapping(const Project& project,
                                                            const ModelSet& models);

} // namespace busbar::controller
