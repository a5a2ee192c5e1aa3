#pragma once

#include <vector>

#include <busbar/controller/backup.hpp>

#include "backup_file.hpp"

namespace busbar::controller::detail {

[[nodiscard]] bool is_restored(MemoryGroup group, const RestoreChoice& choice);
/// Tells whether any of the items belongs to the security profile.
[[nodiscard]] bool has_profile(const std::vector<SavedItem>& items);
[[nodiscard]] bool has_profile(const std::vector<MemoryItem>& items);

/// A problem with what a backup has, not with the controller.
[[nodiscard]] Unexpected<Problem> wrong_in_backup(Problem problem);

/// Gives each part of a shared file its own item: earlier versions saved such a file whole, in one
/// item. Items that were not chosen stay as they are.
[[nodiscard]] Configured<void> divide_parts(SavedMemory& memory,
                                            const std::vector<MemoryItem>& items,
                                            const RestoreChoice& choice);

} // namespace busbar::controller::detail
