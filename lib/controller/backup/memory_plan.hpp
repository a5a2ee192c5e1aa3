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
