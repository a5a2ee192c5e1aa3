#pragma once

#include <string>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/storage.hpp>

namespace busbar {

/// A Storage whose root is a folder of another Storage. Threads and errors are those of the other
/// one.
class BUSBAR_API StorageFolder : public Storage {
public:
    /// `storage` must outlive this object.
    StorageFolder(Storage& storage, std::string folder)
        : storage_{&storage}, folder_{std::move(folder)}
    {
    }

    [[nodiscard]] Stored<StorageEntry> entry(std::string_view name) override
    {
        return storage_->entry(in_folder(name));
    }
    [[nodiscard]] Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                                           std::span<std::byte> into) override
    {
        return storage_->read(in_folder(name), offset, into);
    }
    [[nodiscard]] Stored<void> replace(std::string_view name, std::span<const std::byte> bytes,
                                       FileAccess access) override
    {
        return storage_->replace(in_folder(name), bytes, access);
    }
    [[nodiscard]] Stored<void> append(std::string_view name, std::span<const std::byte> bytes,
                                      FileAccess access) override
    {
        return storage_->append(in_folder(name), bytes, access);
    }
    [[nodiscard]] Stored<void> append_unsynced(std::string_view name,
                                               std::span<const std::byte> bytes,
                                               FileAccess access) override
    {
        return storage_->append_unsynced(in_folder(name), bytes, access);
    }
    [[nodiscard]] Stored<void> sync(std::string_view name) override
    {
        return storage_->sync(in_folder(name));
    }
    [[nodiscard]] Stored<void> move(std::string_view from, std::string_view to,
                                    WhenThere when_there) override
    {
        return storage_->move(in_folder(from), in_folder(to), when_there);
    }
    [[nodiscard]] Stored<void> remove(std::string_view name) override
    {
        return storage_->remove(in_folder(name));
    }
    [[nodiscard]] Stored<StorageListing> list(std::string_view folder, std::size_t most) override
    {
        return storage_->list(in_folder(folder), most);
    }
    [[nodiscard]] Stored<void> make_folder(std::string_view name, FileAccess access) override
    {
        return storage_->make_folder(in_folder(name), access);
    }
    [[nodiscard]] Stored<bool> close_to_others(std::string_view name) override
    {
        return storage_->close_to_others(in_folder(name));
    }
    void remove_unfinished(std::string_view folder) override
    {
        storage_->remove_unfinished(in_folder(folder));
    }
    [[nodiscard]] Stored<std::uint64_t> free_space() override { return storage_->free_space(); }
    [[nodiscard]] std::string place(std::string_view name) const override
    {
        return storage_->place(in_folder(name));
    }

private:
    [[nodiscard]] std::string in_folder(std::string_view name) const
    {
        return name.empty() ? folder_ : storage_path(folder_, name);
    }

    Storage* storage_;
    std::string folder_;
};

} // namespace busbar
