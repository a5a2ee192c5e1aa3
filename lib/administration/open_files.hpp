#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/file_system.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/result.hpp>

#include "permissions.hpp"

namespace busbar::administration::detail {

// Bits of the mode of Open (Part 20, 4.2.2).
inline constexpr std::uint8_t open_read = 1;
inline constexpr std::uint8_t open_write = 2;
inline constexpr std::uint8_t open_erase = 4;
inline constexpr std::uint8_t open_append = 8;

/// Maximum number of bytes in one Read; the client asks again for the rest (Part 20, 4.2.4).
inline constexpr std::size_t max_read_size = 65'536;

/// The files of one Storage that sessions have opened. Closing a file replaces it by what was
/// written. A session that opened it for reading before that continues with the old content, as
/// long as there is room for it in FileLimits::max_written.
///
/// By Part 20, 4.2.2 an open file, even if it is only read, cannot be opened for writing. Here that
/// applies within one session only, since another session can last as long as its client wants.
/// When all handles or all memory are taken, the user with the largest share gives way to one with
/// a smaller share.
class OpenFiles {
public:
    /// Identifies an open file: a handle is valid only for its file, and for the user and the
    /// session that opened it.
    struct Key {
        std::string_view path;
        std::uint32_t handle;
        const Holder& holder;
    };

    OpenFiles(Storage& storage, const FileLimits& limits) : storage_{storage}, limits_{limits} {}

    /// Opens a file and returns its handle. Bad_InvalidArgument for an invalid mode,
    /// Bad_NotWritable if the file is open for writing or open in the same session, Bad_NotReadable
    /// if it is open for writing, Bad_NotFound, Bad_TooManyOperations, Bad_OutOfMemory if too much
    /// is written already, Bad_EncodingLimitsExceeded for a file that is too large to be changed,
    /// or the status of the Storage's error.
    [[nodiscard]] Result<std::uint32_t> open(std::string_view path, std::uint8_t mode,
                                             const Holder& holder);
    /// Saves what was written. Bad_InvalidState if the file was changed otherwise in the meantime.
    /// After an error of the Storage the file stays open, so that the client can try again.
    [[nodiscard]] StatusCode close(const Key& key);
    /// Closes the file and drops what was written.
    void discard(const Key& key);
    /// Tells whether close() would change the file.
    [[nodiscard]] bool is_changed(const Key& key);
    /// Reads at most `length` bytes, none at the end. Bad_InvalidState if the file is not open for
    /// reading, or was changed and its old content is lost.
    [[nodiscard]] Result<std::vector<std::byte>> read(const Key& key, std::int32_t length);
    [[nodiscard]] StatusCode write(const Key& key, std::span<const std::byte> bytes);
    [[nodiscard]] Result<std::uint64_t> position(const Key& key);
    /// Moves to this position, or to the end of the file if that comes first (Part 20, 4.2.7).
    [[nodiscard]] StatusCode set_position(const Key& key, std::uint64_t position);

    /// Number of handles that are open for the file.
    [[nodiscard]] std::size_t count(std::string_view path) const;
    /// Tells whether the file, or one in the folder, is open for writing or open in this session.
    [[nodiscard]] bool is_in_use(std::string_view path, const Holder& holder) const;
    /// Closes all handles of a file that no longer exists.
    void drop(std::string_view path);
    /// Closes the files of holders that are gone, and drops what they wrote.
    void expire(FunctionRef<bool(const Holder&)> is_there);

private:
    struct Open {
        std::uint32_t handle;
        std::string path;
        Holder holder;
        bool is_read;
        bool is_written;
        bool is_changed;
        StorageEntry::Version version;
        std::uint64_t size;
        std::uint64_t position;
        /// The content of a file that is open for writing.
        std::vector<std::byte> bytes;
    };

    /// The content of a file before it was replaced.
    struct Former {
        std::string path;
        StorageEntry::Version version;
        std::vector<std::byte> bytes;

        [[nodiscard]] bool is_of(const Open& open) const
        {
            return !open.is_written && open.path == path && open.version == version;
        }
    };

    [[nodiscard]] Open* find(const Key& key);
    [[nodiscard]] StatusCode check_mode(std::string_view path, std::uint8_t mode,
                                        const Holder& holder) const;
    /// Makes room for one handle, for which another may give way.
    [[nodiscard]] bool make_room(const Holder& holder);
    /// Makes room for bytes.
    [[nodiscard]] bool make_room(const Holder& holder, std::uint64_t bytes);
    [[nodiscard]] StatusCode load(Open& open);
    /// Number of bytes in memory.
    [[nodiscard]] std::uint64_t held() const;
    /// True if the file is still the one that was opened.
    [[nodiscard]] bool is_same(const Open& open) const;
    /// Reads the present content, if a reader needs it after the file is replaced and there is
    /// room.
    [[nodiscard]] std::optional<Former> former_of(const Open& writer) const;
    /// Fills `bytes` from the file's position on.
    [[nodiscard]] StatusCode read_stored(const Open& open, std::span<std::byte> bytes) const;
    /// Removes these, and the old content that no other handle needs.
    void forget(FunctionRef<bool(const Open&)> which);

    Storage& storage_;
    FileLimits limits_;
    std::list<Open> open_; // oldest first
    std::vector<Former> former_;
    std::uint32_t last_handle_{0};
};

} // namespace busbar::administration::detail
