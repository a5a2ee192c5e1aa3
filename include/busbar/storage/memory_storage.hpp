#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <busbar/core/storage.hpp>

namespace busbar::storage {

/// Files in memory, for tests: a medium that fails on request.
///
/// Each written byte is a step, and so is each other change. Used by one thread.
class BUSBAR_API MemoryStorage final : public Storage {
public:
    /// Sets the time of `modified` and `touched` for later changes.
    void set_time(DateTime now) { now_ = now; }

    // Faults.

    /// Limits the bytes of all files together; Full beyond.
    void set_capacity(std::uint64_t bytes) { capacity_ = bytes; }
    /// Makes all changes fail with Protected.
    void set_protected(bool is_protected) { is_protected_ = is_protected; }
    /// Makes all reads and changes fail with Away.
    void set_away(bool is_away) { is_away_ = is_away; }
    /// Cuts the power after this many more steps: every call fails with Away until restore_power().
    void cut_power_after(std::size_t steps);
    void restore_power();
    /// Makes a power failure take all but the first `kept` bytes that append_unsynced has added to
    /// each file since its last sync().
    void lose_unsynced(std::size_t kept);
    /// Makes the change after this many more steps fail, once.
    void fail_once_after(std::size_t steps, StorageError error);
    /// Number of steps since construction.
    [[nodiscard]] std::size_t steps() const { return steps_; }
    /// Number of file reads.
    [[nodiscard]] std::size_t reads() const { return reads_; }

    /// The names of all files, for a test to compare.
    [[nodiscard]] std::vector<std::string> names() const;
    /// Names of files whose replacement a power failure interrupted, until remove_unfinished. They
    /// take space.
    [[nodiscard]] std::vector<std::string> unfinished() const;
    /// True if other users than its owner may read it. False for a missing file.
    [[nodiscard]] bool is_open_to_others(std::string_view name) const;
    /// Lets other users read the file, as a person can.
    void open_to_others(std::string_view name);

    Stored<StorageEntry> entry(std::string_view name) override;
    Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                             std::span<std::byte> into) override;
    Stored<void> replace(std::string_view name, std::span<const std::byte> bytes,
                         FileAccess access) override;
    Stored<void> append(std::string_view name, std::span<const std::byte> bytes,
                        FileAccess access) override;
    Stored<void> append_unsynced(std::string_view name, std::span<const std::byte> bytes,
                                 FileAccess access) override;
    Stored<void> sync(std::string_view name) override;
    Stored<void> move(std::string_view from, std::string_view to, WhenThere when_there) override;
    Stored<void> remove(std::string_view name) override;
    Stored<StorageListing> list(std::string_view folder, std::size_t most) override;
    Stored<void> make_folder(std::string_view name, FileAccess access) override;
    Stored<bool> close_to_others(std::string_view name) override;
    void remove_unfinished(std::string_view folder) override;
    Stored<std::uint64_t> free_space() override;
    [[nodiscard]] std::string place(std::string_view name) const override;

private:
    struct Item {
        bool is_folder{false};
        FileAccess access{FileAccess::Everyone};
        std::vector<std::byte> bytes;
        DateTime modified;
        std::uint64_t version{0};
        std::size_t unsynced{0}; // bytes at the end that a power failure may take
    };
    using Items = std::map<std::string, Item, std::less<>>;

    [[nodiscard]] std::optional<StorageError> refusal(std::string_view name) const;
    [[nodiscard]] std::optional<StorageError> refusal_of_change(std::string_view name) const;
    [[nodiscard]] bool is_folder(std::string_view name) const;
    [[nodiscard]] bool has_children(std::string_view name) const;
    [[nodiscard]] std::uint64_t used() const;
    /// Returns how many of `count` bytes are written before the power or the medium fails.
    [[nodiscard]] std::size_t take_bytes(std::size_t count);
    [[nodiscard]] Stored<void> take_step();
    [[nodiscard]] Stored<void> add(std::string_view name, std::span<const std::byte> bytes,
                                   FileAccess access, bool is_synced);
    [[nodiscard]] StorageEntry entry_of(std::string_view name, const Item& item) const;
    void touch(Item& item);
    /// Updates the folder's time after a name came or went.
    void touch_folder_of(std::string_view name);

    Items items_;
    /// Bytes of each unfinished file that are on the medium.
    std::map<std::string, std::size_t, std::less<>> unfinished_;
    DateTime now_;
    std::uint64_t capacity_{UINT64_MAX};
    bool is_protected_{false};
    bool is_away_{false};
    bool is_dark_{false};
    std::size_t steps_{0};
    std::size_t reads_{0};
    std::uint64_t versions_{0};
    std::size_t end_{SIZE_MAX};
    std::optional<StorageError>
        error_; // what happens after the last step, instead of a power failure
};

} // namespace busbar::storage
