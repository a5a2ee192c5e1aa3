#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unistd.h>

#include <busbar/core/storage.hpp>

/// The single steps of a FolderStorage. Paths are those of the operating system.
namespace busbar::storage::detail {

/// Returns the meaning of errno.
[[nodiscard]] StorageError last_error();

/// Returns whether a file of this name, without its folder, is a temporary one.
[[nodiscard]] bool is_unfinished(std::string_view name);

/// Removes a temporary file unless it is being written.
void remove_dead(const std::string& path);

/// Writes the folder to the disk, which a new name needs.
void sync_folder_of(const std::string& path);

/// See Storage::replace.
[[nodiscard]] Stored<void> save(const std::string& path, std::span<const std::byte> bytes,
                                FileAccess access);
/// The event that written bytes survive.
enum class Durability : std::uint8_t { ProgramEnd, PowerCut };

/// See Storage::append and append_unsynced.
[[nodiscard]] Stored<void> append(const std::string& path, std::span<const std::byte> bytes,
                                  FileAccess access, Durability durability);
/// See Storage::sync.
[[nodiscard]] Stored<void> sync(const std::string& path);
/// Renames also to another disk. Replaces a file at `to`.
[[nodiscard]] Stored<void> rename_durably(const std::string& from, const std::string& to);
/// Reads as many bytes as there are from an open file.
[[nodiscard]] Stored<std::size_t> read_from(int file, std::uint64_t offset,
                                            std::span<std::byte> into);

/// An open file; -1 if it could not be opened.
class Descriptor {
public:
    explicit Descriptor(int value) : value_{value} {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor()
    {
        if (value_ >= 0) {
            ::close(value_);
        }
    }

    [[nodiscard]] int get() const { return value_; }
    [[nodiscard]] bool is_open() const { return value_ >= 0; }
    /// Releases the open file to a caller who closes it.
    [[nodiscard]] int release()
    {
        const int value = value_;
        value_ = -1;
        return value;
    }

private:
    int value_;
};

} // namespace busbar::storage::detail
