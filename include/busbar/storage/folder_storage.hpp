#pragma once

#include <cstdint>
#include <string>

#include <busbar/core/storage.hpp>

namespace busbar::storage {

/// A folder of a POSIX system. Folders may be links; what lists files skips links by their kind.
///
/// A file is written under a temporary name beside its own, which stays behind if the writer dies:
/// "name.PID-N.busbar-new". Such files are never listed or read. Other processes may use the same
/// folder: remove_unfinished spares what somebody is about to write, where the medium has locks.
///
/// Any thread. NotFound of a whole folder means Away if the root itself is gone.
class BUSBAR_API FolderStorage final : public Storage {
public:
    enum class Root : std::uint8_t {
        Made,   // with the first folder in it, if it is not there
        Medium, // comes and goes: while it is not there all is Away, but make_folder("") makes it
    };

    /// Nothing is touched; make_folder("") makes the folder. Empty: the working folder.
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
    /// NotFound is Away if there is no root.
    [[nodiscard]] StorageError checked(StorageError error) const;

    std::string root_;
    Root kind_;
};

} // namespace busbar::storage
