#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <busbar/core/named_fields.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::administration {

/// What clients may hold and make, of one FileSystem by all sessions together. When there is no
/// room for a handle, or for what is written, the user who has most of it loses some to one who has
/// less, so that none has all by many sessions.
struct FileLimits {
    /// Bytes of one file that is written; it is in memory until it is closed.
    std::size_t max_file_size{16U << 20U};
    /// Bytes of all files that are being written, and of former contents that somebody still reads.
    std::size_t max_written{32U << 20U};
    /// Handles.
    std::size_t max_open{32};
    std::size_t max_open_of_session{8};
    /// Files and folders; what there is beyond them is not shown.
    std::size_t max_entries{1'000};
    std::size_t max_depth{8};
};

/// A folder of a Storage that clients see as FileDirectoryType, and its files as FileType (Part 20,
/// 4.2 and 4.3), below the Object FileSystem (4.3.2), or Objects where namespace 0 has none.
///
/// A file that is written is replaced when it is closed, as a whole: a client that vanishes, a
/// power cut and a full medium leave the old one. Who opened it to read in another session before
/// goes on with what it was, and keeps nobody from writing, moving or deleting it. Nothing outside
/// of the folder can be named, links in it are not shown, nor are names that begin with a point,
/// and those that are no UTF-8, or have control characters or spaces at an end; the log says once
/// that there are such.
struct FileSystem {
    [[no_unique_address]] NamedFields named_fields{};

    /// BrowseName of the root, and a part of all NodeIds: "Files/recipes/press/4.csv".
    std::string name;
    /// Whose root it is; see StorageFolder. Must outlive the Administration.
    Storage* storage{nullptr};
    FileLimits limits{};
    /// Roles that see and read files, over encrypted channels.
    std::vector<NodeId> readers{};
    /// Roles that make, write, move and delete them, and read, too.
    std::vector<NodeId> writers{};
    /// The program alone makes and writes them, such as logs: writers may only delete them.
    bool is_written_by_program{false};
};

} // namespace busbar::administration
