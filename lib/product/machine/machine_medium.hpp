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

/// The medium of a machine's execution log: the folder that the configuration names, or where the
/// runtime has its own, which may be away, full or protected as that says. Any thread.
class MachineMedium final : public Storage {
public:
    /// `card` is the runtime's, which must outlive it; null: it has none.
    MachineMedium(std::string configured, const StorageMedium* card);

    /// Whether it lies where the configuration says.
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
    /// What is done with it: full media are read, and files on them may be removed.
    enum class Use : std::uint8_t { Read, Change, Add };

    [[nodiscard]] std::optional<StorageError> refusal(Use use) const;
    /// Where it lies now.
    [[nodiscard]] std::shared_ptr<storage::FolderStorage> folder() const;
    template <typename T>
    [[nodiscard]] Stored<T> used(Use use, FunctionRef<Stored<T>(Storage&)> act) const;

    std::string configured_;
    const StorageMedium* card_;
    mutable std::mutex mutex_; // of the two below
    mutable std::string lies_in_;
    mutable std::shared_ptr<storage::FolderStorage> folder_;
};

} // namespace busbar::product
