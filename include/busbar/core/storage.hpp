#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/status_code.hpp>

namespace busbar {

/// The reason why a Storage failed. Nothing has changed then, unless stated otherwise.
enum class StorageError : std::uint8_t {
    NotFound,  // no file or folder of this name
    Exists,    // the name is in use already
    TooLarge,  // longer than the caller allows
    Full,      // no space left
    Protected, // may not be written, or not be read
    Away,      // the medium is missing
    BadName,   // see is_storage_name
    Failed,    // anything else: a defective medium, a folder where a file was expected
    Closed,    // accepts no more changes, see StorageGate
};

template <typename T>
/// A value, or the reason why the storage could not give it.
using Stored = Expected<T, StorageError>;

/// `return not_stored(...);` in a function that returns a Stored.
[[nodiscard]] inline Unexpected<StorageError> not_stored(StorageError error)
{
    return Unexpected<StorageError>{error};
}

/// For people: "there is no space left".
[[nodiscard]] BUSBAR_API std::string_view text(StorageError error);
/// Bad_NotFound, Bad_EntryExists, Bad_InvalidArgument for BadName, Bad_InvalidState for Closed;
/// Bad_ResourceUnavailable for all others.
[[nodiscard]] BUSBAR_API StatusCode status_of(StorageError error);

/// The users that may read a written file, on a medium that knows users.
enum class FileAccess : std::uint8_t { Owner, Everyone };

/// Says what happens to a file that has the name already.
enum class WhenThere : std::uint8_t { Refuse, Replace };

/// One name in a folder.
struct StorageEntry {
    /// The kind of entry.
    enum class Kind : std::uint8_t {
        File,
        Folder,
        Other, // a link, a pipe, a device
    };

    std::string name; // without its folder
    Kind kind{Kind::File};
    std::uint64_t size{0}; // bytes of a file
    DateTime modified;     // change of its contents; of a folder, change of its names
    /// The last change of contents, name or rights. A file may be touched again a moment later
    /// without a difference in `version`, since the clocks of media go in steps.
    DateTime touched;
    /// Differs when the file was changed. Has no meaning by itself.
    struct Version {
        std::uint64_t parts[4]{};

        friend bool operator==(const Version&, const Version&) = default;
    } version;
};

/// The entries of a folder.
struct StorageListing {
    std::vector<StorageEntry> entries; // sorted by name
    bool is_cut{false};                // the folder has more entries than requested
};

/// The place of everything persistent: certificates, users, settings, logs, projects. On a computer
/// it is a folder (storage::FolderStorage), in tests memory (storage::MemoryStorage); firmware
/// brings its flash.
///
/// Names are paths below one root, separated by "/": "trusted/certs/Press 4.der"; the root is "".
/// See is_storage_name. People or tools may change files at any time if the medium allows it.
///
/// A change that returns success is on the medium and survives a power failure. After a power
/// failure during a call the state is the one before or after it, except for `append` and
/// `append_unsynced`, as described there.
///
/// All functions block on the medium. Several threads may call them at the same time for different
/// names.
class BUSBAR_API Storage {
public:
    Storage() = default;
    Storage(const Storage&) = delete;
    Storage& operator=(const Storage&) = delete;
    virtual ~Storage() = default;

    /// Describes the file or folder of this name. A link is Kind::Other, whatever it points to.
    [[nodiscard]] virtual Stored<StorageEntry> entry(std::string_view name) = 0;
    /// Fills `into` with the bytes from `offset` on and returns their number, which is less than
    /// the size of `into` if the file ends before. All of them are of one version of the file.
    /// Follows a link that an administrator made to a file.
    [[nodiscard]] virtual Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                                                   std::span<std::byte> into) = 0;
    /// Creates the file, or replaces its contents by `bytes` in one step: every reader sees the old
    /// file or the new one. With FileAccess::Owner no other user can read it at any time. If two
    /// threads replace it at the same time, one of them wins. NotFound if the folder does not
    /// exist.
    [[nodiscard]] virtual Stored<void>
    replace(std::string_view name, std::span<const std::byte> bytes, FileAccess access) = 0;
    /// Appends to a file, which is created if it does not exist. After an error or a power failure
    /// any number of the first `bytes` may have been appended.
    [[nodiscard]] virtual Stored<void>
    append(std::string_view name, std::span<const std::byte> bytes, FileAccess access) = 0;
    /// Appends likewise, but the bytes survive only the end of the program at once, and a power
    /// failure after the next sync(): after one before that the file may have any bytes instead of
    /// them, or none. Takes as long as the operating system needs to take the bytes over. The
    /// default calls append().
    [[nodiscard]] virtual Stored<void>
    append_unsynced(std::string_view name, std::span<const std::byte> bytes, FileAccess access)
    {
        return append(name, bytes, access);
    }
    /// Makes everything that append_unsynced has added to a file survive a power failure.
    [[nodiscard]] virtual Stored<void> sync(std::string_view /*name*/) { return {}; }
    /// Renames a file, also into another folder. At every moment it has one of both names.
    [[nodiscard]] virtual Stored<void> move(std::string_view from, std::string_view to,
                                            WhenThere when_there) = 0;
    /// Removes a file, or an empty folder.
    [[nodiscard]] virtual Stored<void> remove(std::string_view name) = 0;
    /// Lists at most `most` names of a folder, without unfinished files.
    [[nodiscard]] virtual Stored<StorageListing> list(std::string_view folder,
                                                      std::size_t most) = 0;
    /// Creates a folder and its parents, including the root; succeeds if it exists. `access`
    /// applies to the last one, if it is created.
    [[nodiscard]] virtual Stored<void> make_folder(std::string_view name, FileAccess access) = 0;
    /// Restricts the file or folder to its owner. Returns true if others had access before.
    [[nodiscard]] virtual Stored<bool> close_to_others(std::string_view name) = 0;
    /// Removes what interrupted calls of `replace` left in a folder. A call that is running then
    /// fails.
    virtual void remove_unfinished(std::string_view folder) = 0;
    /// Bytes that can still be written.
    [[nodiscard]] virtual Stored<std::uint64_t> free_space() = 0;

    /// The place where people find the file: the path of the operating system.
    [[nodiscard]] virtual std::string place(std::string_view name) const = 0;
};

/// True if a file may have this name: at most 1,024 bytes, each part between two "/" 1 to 255
/// bytes, none of them "." or ".." and none with a zero byte.
[[nodiscard]] BUSBAR_API bool is_storage_name(std::string_view name);

/// Reads the whole file; TooLarge if it has more than `max_size` bytes.
[[nodiscard]] BUSBAR_API Stored<std::vector<std::byte>>
read_file(Storage& storage, std::string_view name, std::size_t max_size);

/// "folder/name"; the name alone in the root.
[[nodiscard]] BUSBAR_API std::string storage_path(std::string_view folder, std::string_view name);

} // namespace busbar
