#pragma once

#include <cstdint>
#include <string>

#include <busbar/core/storage.hpp>

namespace busbar::storage {

/// A folder of a POSIX system. Folders may be links; callers that list files skip links by their
/// kind.
///
/// A file is written under a temporary name next to its own, "name.PID-N.busbar-new", which remains
/// if the writer dies. Such files are never listed or read. Other processes may use the same
/// folder: remove_unfinished spares files that are being written, if the medium has locks.
///
/// Called from any thread. NotFound of a whole folder means Away if the root itself is missing.
class BUSBAR_API FolderStorage final : public Storage {
public:
    /// Whether the folder is always there.
    enum class Root : std::uint8_t {
        Made,   // created with the first folder in it, if it does not exist
        Medium, // comes and goes: while it is missing all calls fail with Away, except that
                // make_folder("") creates it
    };

    /// Changes nothing on the medium; make_folder("") creates the folder. If empty, it is the
    /// working folder.
    explicit FolderStorage(std::string folder, Root root = Root::Made);

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
    /// Turns NotFound into Away if the root is missing.
    [[nodiscard]] StorageError checked(StorageError error) const;

    std::string root_;
    Root kind_;
};

} // namespace busbar::storage
