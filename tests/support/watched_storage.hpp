#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/core/storage.hpp>

namespace busbar::test {

/// Another Storage, of which it notes what was changed there. Threads are those of the other one,
/// but for what is noted: one at a time.
class WatchedStorage final : public Storage {
public:
    /// `storage` must outlive this.
    explicit WatchedStorage(Storage& storage) : storage_{storage} {}

    /// The names of what was changed since the last call, and of where it was moved from.
    [[nodiscard]] std::set<std::string> take_changed() { return std::exchange(changed_, {}); }

    [[nodiscard]] Stored<StorageEntry> entry(std::string_view name) override
    {
        return storage_.entry(name);
    }
    [[nodiscard]] Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                                           std::span<std::byte> into) override
    {
        return storage_.read(name, offset, into);
    }
    [[nodiscard]] Stored<void> replace(std::string_view name, std::span<const std::byte> bytes,
                                       FileAccess access) override
    {
        if (meanwhile) {
            meanwhile();
        }
        return noted(name, storage_.replace(name, bytes, access));
    }
    [[nodiscard]] Stored<void> append(std::string_view name, std::span<const std::byte> bytes,
                                      FileAccess access) override
    {
        return noted(name, storage_.append(name, bytes, access));
    }
    [[nodiscard]] Stored<void> move(std::string_view from, std::string_view to,
                                    WhenThere when_there) override
    {
        return noted(from, noted(to, storage_.move(from, to, when_there)));
    }
    [[nodiscard]] Stored<void> remove(std::string_view name) override
    {
        return noted(name, storage_.remove(name));
    }
    [[nodiscard]] Stored<StorageListing> list(std::string_view folder, std::size_t most) override
    {
        return storage_.list(folder, most);
    }
    [[nodiscard]] Stored<void> make_folder(std::string_view name, FileAccess access) override
    {
        const bool was_there = storage_.entry(name).has_value();
        auto made = storage_.make_folder(name, access);
        return was_there ? made : noted(name, std::move(made));
    }
    [[nodiscard]] Stored<bool> close_to_others(std::string_view name) override
    {
        return storage_.close_to_others(name);
    }
    void remove_unfinished(std::string_view folder) override { storage_.remove_unfinished(folder); }
    [[nodiscard]] Stored<std::uint64_t> free_space() override { return storage_.free_space(); }
    [[nodiscard]] std::string place(std::string_view name) const override
    {
        return storage_.place(name);
    }

    /// Called while a file is being replaced. May be empty.
    std::function<void()> meanwhile;

private:
    [[nodiscard]] Stored<void> noted(std::string_view name, Stored<void> done)
    {
        if (done) {
            changed_.emplace(name);
        }
        return done;
    }

    Storage& storage_;
    std::set<std::string> changed_;
};

} // namespace busbar::test
