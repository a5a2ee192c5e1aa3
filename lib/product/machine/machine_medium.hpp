#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/function_ref.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/storage/folder_storage.hpp>

namespace busbar::product {

class StorageMedium;

/// The medium of a machine's execution log: the configured folder or the runtime's own, which may
/// be away, full or protected as the runtime says. Thread-safe.
class MachineMedium final : public Storage {
public:
    /// `card` is the runtime's medium, which must outlive this object; null for none.
    MachineMedium(std::string configured, const StorageMedium* card);

    /// True if the configured folder is used.
    [[nodiscard]] bool is_configured() const;

    [[nodiscard]] Stored<StorageEntry> entry(std::string_view name) override;
    [[nodiscard]] Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                                           std::span<std::byte> into) override;
    [[nodiscard]] Stored<void> replace(std::string_view name, std::span<const std::byte> bytes,
                                       FileAccess access) override;
    [[nodiscard]] Stored<void> append(std::string_view name, std::span<const std::byte> bytes,
                                      FileAccess access) override;
    [[nodiscard]] Stored<void> append_unsynced(std::string_view name,
                                               std::span<const std::byte> bytes,
                                               FileAccess access) override;
    [[nodiscard]] Stored<void> sync(std::string_view name) override;
    [[nodiscard]] Stored<void> move(std::string_view from, std::string_view to,
                                    WhenThere when_there) override;
    [[nodiscard]] Stored<void> remove(std::string_view name) override;
    [[nodiscard]] Stored<StorageListing> list(std::string_view folder, std::size_t most) override;
    [[nodiscard]] Stored<void> make_folder(std::string_view name, FileAccess access) override;
    [[nodiscard]] Stored<bool> close_to_others(std::string_view name) override;
    void remove_unfinished(std::string_view folder) override;
    [[nodiscard]] Stored<std::uint64_t> free_space() override;
    [[nodiscard]] std::string place(std::string_view name) const override;

private:
    /// The kind of access: full media can be read, and files on them removed.
    enum class Use : std::uint8_t { Read, Change, Add };

    [[nodiscard]] std::optional<StorageError> refusal(Use use) const;
    /// The present folder.
    [[nodiscard]] std::shared_ptr<storage::FolderStorage> folder() const;
    template <typename T>
    [[nodiscard]] Stored<T> used(Use use, FunctionRef<Stored<T>(Storage&)> act) const;

    std::string configured_;
    const StorageMedium* card_;
    mutable std::mutex mutex_; // guards the two below
    mutable std::string lies_in_;
    mutable std::shared_ptr<storage::FolderStorage> folder_;
};

} // namespace busbar::product
