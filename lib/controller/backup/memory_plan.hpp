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
    /// All must outlive it, and so must what is given to it.
    MemoryPlan(Storage& storage, const MemoryLimits& limits) : storage_{storage}, limits_{limits} {}

    /// The item has these files and no other. They must be files of it, and of one that is a part
    /// at most its one.
    [[nodiscard]] Configured<void> put(const MemoryItem& item, const std::vector<SavedFile>& files);
    [[nodiscard]] Configured<void> clear(const MemoryItem& item) { return put(item, {}); }
    /// Whether what shared files will have makes sense.
    [[nodiscard]] Configured<void> check_shared() const;
    /// What would be missing of what a new controller has.
    [[nodiscard]] Configured<void> add_initial(const MemoryItem& item);
    /// All of it or, with a problem, nothing.
    [[nodiscard]] Configured<void> carry_out(const std::string& transaction) const;

private:
    struct NewFile {
        std::span<const std::byte> bytes;
        FileAccess access;
    };
    /// Empty: there will be none.
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
    /// Shared files as they will be, by the items whose parts were put.
    std::map<std::string_view, Shared> shared_;
};

} // namespace busbar::controller::detail
