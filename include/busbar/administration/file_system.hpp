#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/named_fields.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::administration {

/// Limits what clients may hold and create in one FileSystem, for all sessions together. If there
/// is no room for a handle, or for written data, the user with most of it loses some to one who has
/// less, so that no user gets everything by opening many sessions.
struct FileLimits {
    /// Bytes of one file that is being written; it is in memory until it is closed.
    std::size_t max_file_size{16U << 20U};
    /// Bytes of all files that are being written, and of previous contents that are still being
    /// read.
    std::size_t max_written{32U << 20U};
    /// Number of handles.
    std::size_t max_open{32};
    std::size_t max_open_of_session{8};
    /// Files and folders; further ones are not shown.
    std::size_t max_entries{1'000};
    std::size_t max_depth{8};
};

/// A folder of a Storage that clients see as FileDirectoryType, and its files as FileType (Part 20,
/// 4.2 and 4.3), below the Object FileSystem (4.3.2), or below Objects if namespace 0 has none.
///
/// A written file is replaced when it is closed, as a whole: a client that vanishes, a power
/// failure and a full medium leave the old one. A client that opened it for reading before
/// continues with the old contents, and does not prevent writing, moving or deleting it. Nothing
/// outside of the folder can be named. Links in it are not shown, nor names that begin with a dot,
/// that are not UTF-8, or that have control characters or spaces at an end; the log reports once
/// that there are such names.
struct FileSystem {
    [[no_unique_address]] NamedFields named_fields{};

    /// BrowseName of the root, and a part of all NodeIds: "Files/recipes/press/4.csv".
    std::string name;
    /// The storage whose root it is; see StorageFolder. Must outlive the Administration.
    Storage* storage{nullptr};
    FileLimits limits{};
    /// Roles that see and read files, over encrypted channels.
    std::vector<NodeId> readers{};
    /// Roles that create, write, move and delete them, and read them too.
    std::vector<NodeId> writers{};
    /// Only the program creates and writes them, such as logs: writers may only delete them.
    bool is_written_by_program{false};
    /// Tells whether the file or folder at this path may be deleted; if it is empty, all may. A log
    /// refuses the file that it is writing.
    std::function<bool(std::string_view path)> may_delete{};
    /// Completes the file that the program is writing and begins a new one. If it is not empty, the
    /// folder has the Method BeginNewFile, without arguments, for the roles that may delete.
    std::function<Stored<void>()> begin_new_file{};
};

} // namespace busbar::administration
