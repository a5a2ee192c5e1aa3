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

/// Why a Storage did not do what it was asked for. Nothing has changed then, unless said otherwise.
enum class StorageError : std::uint8_t {
    NotFound,  // no file or folder of this name
    Exists,    // there is one already
    TooLarge,  // longer than asked for
    Full,      // no space left
    Protected, // it may not be written, or not be read
    Away,      // the medium is not there
    BadName,   // see is_storage_name
    Failed,    // anything else: a defect medium, a folder where a file was expected
    Closed,    // it takes no changes any more, see StorageGate
};

template <typename T>
using Stored = Expected<T, StorageError>;

[[nodiscard]] inline Unexpected<StorageError> not_stored(StorageError error)
{
    return Unexpected<StorageError>{error};
}

/// For people: "there is no space left".
[[nodiscard]] BUSBAR_API std::string_view text(StorageError error);
/// Bad_NotFound, Bad_EntryExists, Bad_InvalidArgument for BadName, Bad_InvalidState for Closed;
/// Bad_ResourceUnavailable for all others.
[[nodiscard]] BUSBAR_API StatusCode status_of(StorageError error);

/// Who may read a file that is written, where a medium knows users.
enum class FileAccess : std::uint8_t { Owner, Everyone };

/// What to do with a file that has the name already.
enum class WhenThere : std::uint8_t { Refuse, Replace };

/// One name in a folder.
struct StorageEntry {
    enum class Kind : std::uint8_t {
        File,
        Folder,
        Other, // a link, a pipe, a device
    };

    std::string name; // without its folder
    Kind kind{Kind::File};
    std::uint64_t size{0}; // bytes of a file
    DateTime modified;     // its contents; those of a folder are names
    /// Contents, name or rights, whichever was last. What was touched a moment ago can be touched
    /// again without a difference in `version`, since the clocks of media go in steps.
    DateTime touched;
    /// Is another one when the file is. Means nothing by itself.
    struct Version {
        std::uint64_t parts[4]{};

        friend bool operator==(const Version&, const Version&) = default;
    } version;
};

struct StorageListing {
    std::vector<StorageEntry> entries; // sorted by name
    bool is_cut{false};                // there are more than were asked for
};

/// Where everything persistent lies: certificates, users, settings, logs, projects. On a computer
/// it is a folder (storage::FolderStorage), in tests memory (storage::MemoryStorage); firmware
/// brings its flash.
///
/// Names are paths below one root, parted by "/": "trusted/certs/Press 4.der"; the root is "". See
/// is_storage_name. People or tools may change files at any time where the medium allows it.
///
/// What returns success is on the medium and outlasts a power cut. After a power cut within a call
/// there is the state before it or the one after it, but for `append` and
/// `append_unsynced` as said there.
///
/// All functions block on the medium. Several threads may call them at the same time for different
/// names.
class BUSBAR_API Storage {
public:
    Storage() = default;
    Storage(const Storage&) = delete;
    Storage& operator=(const Storage&) = delete;
    virtual ~Storage() = default;

    /// What there is under a name. A link is Kind::Other, whatever it leads to.
    [[nodiscard]] virtual Stored<StorageEntry> entry(std::string_view name) = 0;
    /// Fills `into` with the bytes from `offset` on; how many that were: fewer than `into` has, if
    /// the file ends before. All of them are of one version of the file. A file that an
    /// administrator linked is read.
    [[nodiscard]] virtual Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                                                   std::span<std::byte> into) = 0;
    /// Makes the file, or replaces what it has by `bytes` in one step: every reader sees the old
    /// file or the new one. With FileAccess::Owner no other user can read it at any time. If two do
    /// that at the same time, one of them wins. NotFound if there is no such folder.
    [[nodiscard]] virtual Stored<void>
    replace(std::string_view name, std::span<const std::byte> bytes, FileAccess access) = 0;
    /// Adds to the end of a file, which is made if it is not there. After an error or a power cut
    /// the file may have gained any first part of `bytes`.
    [[nodiscard]] virtual Stored<void>
    append(std::string_view name, std::span<const std::byte> bytes, FileAccess access) = 0;
    /// The same, but what was added outlasts the end of the program alone, and a power cut only
    /// from the next sync() on: after one before that the file may have any bytes instead of them,
    /// or none. Takes as long as the medium's system needs to remember the bytes. A Storage that
    /// does not override it appends.
    [[nodiscard]] virtual Stored<void>
    append_unsynced(std::string_view name, std::span<const std::byte> bytes, FileAccess access)
    {
        return append(name, bytes, access);
    }
    /// What append_unsynced has added to a file outlasts a power cut.
    [[nodiscard]] virtual Stored<void> sync(std::string_view /*name*/) { return {}; }
    /// Gives a file another name, also in another folder. At no moment is it under neither.
    [[nodiscard]] virtual Stored<void> move(std::string_view from, std::string_view to,
                                            WhenThere when_there) = 0;
    /// Removes a file, or a folder in which there is nothing.
    [[nodiscard]] virtual Stored<void> remove(std::string_view name) = 0;
    /// At most `most` names of a folder, without those of files that are not finished.
    [[nodiscard]] virtual Stored<StorageListing> list(std::string_view folder,
                                                      std::size_t most) = 0;
    /// Makes a folder and those that it lies in, the root too; success if it is there. `access` is
    /// that of the last one, if it is made.
    [[nodiscard]] virtual Stored<void> make_folder(std::string_view name, FileAccess access) = 0;
    /// From now on only its owner may use the file or folder. True if others could before.
    [[nodiscard]] virtual Stored<bool> close_to_others(std::string_view name) = 0;
    /// Removes what calls of `replace` left in a folder when their power was cut. One that is at
    /// work then fails.
    virtual void remove_unfinished(std::string_view folder) = 0;
    /// Bytes that can still be written.
    [[nodiscard]] virtual Stored<std::uint64_t> free_space() = 0;

    /// Where people find the file: the path of the operating system.
    [[nodiscard]] virtual std::string place(std::string_view name) const = 0;
};

/// Whether a name can be given to a file: at most 1,024 bytes, in each part between two "/" 1 to
/// 255, none of them "." or ".." and none with a zero byte.
[[nodiscard]] BUSBAR_API bool is_storage_name(std::string_view name);

/// The whole file; TooLarge if it has more than `max_size` bytes.
[[nodiscard]] BUSBAR_API Stored<std::vector<std::byte>>
read_file(Storage& storage, std::string_view name, std::size_t max_size);

/// "folder/name"; the name alone in the root.
[[nodiscard]] BUSBAR_API std::string storage_path(std::string_view folder, std::string_view name);

} // namespace busbar
