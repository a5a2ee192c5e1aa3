#pragma once

#include <string_view>

#include <busbar/controller/backup.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::product {

/// Values of RETAIN variables in backups. They lie in `state`, and a restore, which changes other
/// files too and all or none, leaves them beside those: take_up_values() brings them to their
/// place before the next program begins.
inline constexpr std::string_view restored_values_name = "retained.restored";

/// The item of a MachineMemory of the other files; `state` must outlive it.
[[nodiscard]] controller::MemoryItem values_item(Storage& state);
/// Puts what a restore or a clearing has left in `files` in the place of what `state` has. Nothing
/// to do is success; after a problem it is done by the next call.
[[nodiscard]] Configured<void> take_up_values(Storage& files, Storage& state);

} // namespace busbar::product
