#pragma once

#include <string_view>

#include <busbar/controller/backup.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::product {

/// Values of RETAIN variables in backups. They are stored in `state`. A restore, which changes
/// several files together or not at all, leaves them beside the other files, and take_up_values()
/// moves them to their place before the next program starts.
inline constexpr std::string_view restored_values_name = "retained.restored";

/// Returns the item for a MachineMemory of the other files; `state` must outlive it.
[[nodiscard]] controller::MemoryItem values_item(Storage& state);
/// Replaces the values in `state` by those that a restore or a clearing left in `files`. Succeeds
/// if there are none; after a problem the next call continues.
[[nodiscard]] Configured<void> take_up_values(Storage& files, Storage& state);

} // namespace busbar::product
