#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
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

/// Makes the problem that a file of the storage has.
[[nodiscard]] Unexpected<Problem> storage_problem(const Storage& storage, std::string_view name,
                                                  StorageError error);
[[nodiscard]] std::string_view memory_folder_of(std::string_view name);
/// Tells whether a file of this name belongs to the item.
[[nodiscard]] bool has_file(const MemoryItem& item, std::string_view name);

/// Names of the item's files that exist.
[[nodiscard]] Configured<std::vector<std::string>>
files_there(Storage& storage, const MemoryItem& item, const MemoryLimits& limits);
/// Reads the file that a part belongs to; a missing file counts as empty.
[[nodiscard]] Configured<std::vector<std::byte>> read_whole(Storage& storage, const FilePart& part,
                                                            const MemoryLimits& limits);
/// Takes the item's part out of a file's bytes: one file for a backup, or none.
[[nodiscard]] Configured<std::vector<SavedFile>> part_of(const MemoryItem& item,
                                                         std::span<const std::byte> whole);
/// Reads all of the item.
[[nodiscard]] Configured<SavedItem> read_item(Storage& storage, const MemoryItem& item,
                                              const MemoryLimits& limits);

/// Changes of a controller's data, collected and then done together.
class MemoryPlan {
public:
    /// All arguments must outlive this object, and so must all that its functions are given.
    MemoryPlan(Storage& storage, const MemoryLimits& limits) : storage_{storage}, limits_{limits} {}

    /// Gives the item these files and no others. They must be files of the item; an item that is
    /// part of a file has at most one.
    [[nodiscard]] Configured<void> put(const MemoryItem& item, const std::vector<SavedFile>& files);
    [[nodiscard]] Configured<void> clear(const MemoryItem& item) { return put(item, {}); }
    /// Checks that the content planned for shared files is valid.
    [[nodiscard]] Configured<void> check_shared() const;
    /// Adds those initial files of the item, as a new controller has them, that would be missing.
    [[nodiscard]] Configured<void> add_initial(const MemoryItem& item);
    /// Writes all changes or, with a problem, none.
    [[nodiscard]] Configured<void> carry_out(const std::string& transaction) const;

private:
    struct NewFile {
        std::span<const std::byte> bytes;
        FileAccess access;
    };
    /// Empty if the file will not exist.
    struct Shared {
        std::vector<std::byte> bytes;
        bool is_there;          // now
        const MemoryItem* item; // one of those
    };

    [[nodiscard]] Configured<void> put_part(const MemoryItem& item,
                                            std::span<const std::byte> part);
    [[nodiscard]] Configured<void> check_limits() const;

    Storage& storage_;
    const MemoryLimits& limits_;
    std::map<std::string_view, NewFile> new_files_;
    std::set<std::string> removed_;
    /// The planned content of shared files, by the items whose parts were put.
    std::map<std::string_view, Shared> shared_;
};

} // namespace busbar::controller::detail
