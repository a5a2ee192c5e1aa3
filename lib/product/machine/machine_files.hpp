#pragma once

#include <string>
#include <string_view>

#include <busbar/core/storage.hpp>
#include <busbar/core/storage_folder.hpp>

namespace busbar::product {

/// The files of a machine as one Storage for its backups: the folder of certificates, which also
/// contains users, roles and settings, and the event log in the folder "event-log", which is stored
/// elsewhere and read only (W588, 8-2-1: saved, not restored). Thread safety and errors are those
/// of both.
class MachineFiles final : public Storage {
public:
    static constexpr std::string_view event_folder = "event-log";

    /// Both must outlive this object; `events` has the event log at its root.
    MachineFiles(Storage& files, Storage& events) : files_{files}, events_{events} {}

    [[nodiscard]] Stored<StorageEntry> entry(std::string_view name) override;
    [[nodiscard]] Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                                           std::span<std::byte> into) override;
    [[nodiscard]] Stored<void> replace(std::string_view name, std::span<const std::byte> bytes,
                                       FileAccess access) override;
    [[nodiscard]] Stored<void> append(std::string_view name, std::span<const std::byte> bytes,
                                      FileAccess access) override;
    [[nodiscard]] Stored<void> move(std::string_view from, std::string_view to,
                                    WhenThere when_there) override;
    [[nodiscard]] Stored<void> remove(std::string_view name) override;
    [[nodiscard]] Stored<StorageListing> list(std::string_view folder, std::size_t most) override;
    [[nodiscard]] Stored<void> make_folder(std::string_view name, FileAccess access) override;
    [[nodiscard]] Stored<bool> close_to_others(std::string_view name) override;
    void remove_unfinished(std::string_view folder) override;
    [[nodiscard]] Stored<std::uint64_t> free_space() override { return files_.free_space(); }
    [[nodiscard]] std::string place(std::string_view name) const override;

private:
    Storage& files_;
    Storage& events_;
};

} // namespace busbar::product
