#pragma once

#include <span>
#include <string>
#include <string_view>

#include <busbar/controller/model_report.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/array.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/types/data_types.hpp>

/// The access of roles to single nodes of a project's models: RolePermissions (Part 3, 4.9 and
/// 8.55) as people write them. In the target busbar::model_mode.
namespace busbar::controller {

class ModelSet;

/// Returns "Observer=read Operator=write+call", in the order of the array, or "none" if that is
/// empty. Writes permissions without a word as a number, "Engineer=4147", and other roles than the
/// well-known ones as their NodeIds.
[[nodiscard]] BUSBAR_API std::string roles_text(std::span<const RolePermissionType> permissions);

/// Parses such a text. The words: `browse` shows the node and its attributes but the Value; `read`,
/// `write` and `call` include that, and `write` includes `read`; `all` is everything. Users with
/// none of the roles do not see the node. `where` of a problem is the role.
[[nodiscard]] BUSBAR_API Configured<Array<RolePermissionType>> parse_roles(std::string_view text);

/// Warns of RolePermissions in the models that name an unknown role, or that allow what the node
/// itself does not.
[[nodiscard]] BUSBAR_API ModelReports check_roles(const ModelSet& models);

} // namespace busbar::controller
