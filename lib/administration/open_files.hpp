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

/// Bytes of one Read; the client asks again for the rest (Part 20, 4.2.4).
inline constexpr std::size_t max_read_size = 65'536;

/// Files of one Storage that sessions have open. What is written replaces the file when it is
/// closed; who opened it to read before that reads what it was, as long as there is room for it in
/// FileLimits::max_written.
///
/// Whoever has the file open, also to read, keeps all writers out by Part 20, 4.2.2: here only
/// those of the same session, since another session can last as long as its client wants. When all
/// handles are taken, or all memory, the user who has most gives way to one who has less.
class OpenFiles {
public:
    /// Which one a client means: its handle holds for the file, and for the user and the session
    /// that opened it.
    struct Key {
        std::string_view path;
        std::uint32_t handle;
        const Holder& holder;
    };

    OpenFiles(Storage& storage, const FileLimits& limits) : storage_{storage}, limits_{limits} {}

    /// The handle. Bad_InvalidArgument for a mode that is none, Bad_NotWritable where it is open to
    /// be written, or in the same session, Bad_NotReadable where it is open to be written,
    /// Bad_NotFound, Bad_TooManyOperations, Bad_OutOfMemory where too much is written already,
    /// Bad_EncodingLimitsExceeded for a file too large to be written, or what the Storage's error
    /// is.
    [[nodiscard]] Result<std::uint32_t> open(std::string_view path, std::uint8_t mode,
                                             const Holder& holder);
    /// Keeps what was written. Bad_InvalidState if somebody else changed the file meanwhile; what
    /// the Storage's error is leaves it open, so that it can be tried again.
    [[nodiscard]] StatusCode close(const Key& key);
    /// Closes it and forgets what was written.
    void discard(const Key& key);
    /// Whether close() would change the file.
    [[nodiscard]] bool is_changed(const Key& key);
    /// At most `length` bytes, none at the end. Bad_InvalidState if it is not open for reading, or
    /// if the file was changed meanwhile and what it was is not there any more.
    [[nodiscard]] Result<std::vector<std::byte>> read(const Key& key, std::int32_t length);
    [[nodiscard]] StatusCode write(const Key& key, std::span<const std::byte> bytes);
    [[nodiscard]] Result<std::uint64_t> position(const Key& key);
    /// At most the end of the file (Part 20, 4.2.7).
    [[nodiscard]] StatusCode set_position(const Key& key, std::uint64_t position);

    /// How often the file is open.
    [[nodiscard]] std::size_t count(std::string_view path) const;
    /// Whether the file, or one in the folder, is open to be written, or open in this session.
    [[nodiscard]] bool is_in_use(std::string_view path, const Holder& holder) const;
    /// Closes the file for all who have it open, since there is none any more.
    void drop(std::string_view path);
    /// Forgets what holders that are gone had open, and wrote.
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
        /// Of a file that is written.
        std::vector<std::byte> bytes;
    };

    /// What a file was before it was replaced.
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
    /// One handle more; another one may give way.
    [[nodiscard]] bool make_room(const Holder& holder);
    /// The same for bytes.
    [[nodiscard]] bool make_room(const Holder& holder, std::uint64_t bytes);
    [[nodiscard]] StatusCode load(Open& open);
    /// Bytes in memory.
    [[nodiscard]] std::uint64_t held() const;
    /// The file is the one that was opened.
    [[nodiscard]] bool is_same(const Open& open) const;
    /// What the file still is, if somebody will read that after it is replaced, and if there is
    /// room.
    [[nodiscard]] std::optional<Former> former_of(const Open& writer) const;
    /// Fills `bytes` from the position on.
    [[nodiscard]] StatusCode read_stored(const Open& open, std::span<std::byte> bytes) const;
    /// Removes those, and what is kept for nobody else.
    void forget(FunctionRef<bool(const Open&)> which);

    Storage& storage_;
    FileLimits limits_;
    std::list<Open> open_; // the oldest in front
    std::vector<Former> former_;
    std::uint32_t last_handle_{0};
};

} // namespace busbar::administration::detail
