#pragma once

#include <atomic>
#include <mutex>
#include <shared_mutex>
#include <string>

#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/storage.hpp>

namespace busbar {

/// A Storage that can be closed while a program uses it: for a time in which its files are replaced
/// from elsewhere, and for good once the program's memory is out of date. Reading stays possible.
/// Threads and errors are those of the other one.
class BUSBAR_API StorageGate final : public Storage {
public:
    /// `storage` must outlive this object.
    explicit StorageGate(Storage& storage) : storage_{&storage} {}

    /// Runs `act`, which works on the other Storage, while changes through this one wait. Called
    /// from any thread.
    void hold(FunctionRef<void()> act)
    {
        const std::unique_lock lock{mutex_};
        act();
    }
    /// Refuses changes from now on with StorageError::Closed, including those that wait for the end
    /// of hold(). Called from any thread.
    void close() { is_closed_ = true; }
    [[nodiscard]] bool is_closed() const { return is_closed_; }

    [[nodiscard]] Stored<StorageEntry> entry(std::string_view name) override
    {
        return storage_->entry(name);
    }
    [[nodiscard]] Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                                           std::span<std::byte> into) override
    {
        return storage_->read(name, offset, into);
    }
    [[nodiscard]] Stored<void> replace(std::string_view name, std::span<const std::byte> bytes,
                                       FileAccess access) override
    {
        return change<void>([&] { return storage_->replace(name, bytes, access); });
    }
    [[nodiscard]] Stored<void> append(std::string_view name, std::span<const std::byte> bytes,
                                      FileAccess access) override
    {
        return change<void>([&] { return storage_->append(name, bytes, access); });
    }
    [[nodiscard]] Stored<void> append_unsynced(std::string_view name,
                                               std::span<const std::byte> bytes,
                                               FileAccess access) override
    {
        return change<void>([&] { return storage_->append_unsynced(name, bytes, access); });
    }
    [[nodiscard]] Stored<void> sync(std::string_view name) override { return storage_->sync(name); }
    [[nodiscard]] Stored<void> move(std::string_view from, std::string_view to,
                                    WhenThere when_there) override
    {
        return change<void>([&] { return storage_->move(from, to, when_there); });
    }
    [[nodiscard]] Stored<void> remove(std::string_view name) override
    {
        return change<void>([&] { return storage_->remove(name); });
    }
    [[nodiscard]] Stored<StorageListing> list(std::string_view folder, std::size_t most) override
    {
        return storage_->list(folder, most);
    }
    [[nodiscard]] Stored<void> make_folder(std::string_view name, FileAccess access) override
    {
        return change<void>([&] { return storage_->make_folder(name, access); });
    }
    [[nodiscard]] Stored<bool> close_to_others(std::string_view name) override
    {
        return change<bool>([&] { return storage_->close_to_others(name); });
    }
    void remove_unfinished(std::string_view folder) override
    {
        static_cast<void>(change<void>([&] {
            storage_->remove_unfinished(folder);
            return Stored<void>{};
        }));
    }
    [[nodiscard]] Stored<std::uint64_t> free_space() override { return storage_->free_space(); }
    [[nodiscard]] std::string place(std::string_view name) const override
    {
        return storage_->place(name);
    }

private:
    template <typename T>
    [[nodiscard]] Stored<T> change(FunctionRef<Stored<T>()> act)
    {
        const std::shared_lock lock{mutex_};
        return is_closed_ ? Stored<T>{not_stored(StorageError::Closed)} : act();
    }

    Storage* storage_;
    std::atomic<bool> is_closed_{false};
    std::shared_mutex mutex_;
};

} // namespace busbar
