#include "machine_medium.hpp"

#include <utility>

#include <busbar/product/runtime.hpp>

namespace busbar::product {

MachineMedium::MachineMedium(std::string configured, const StorageMedium* card)
    : configured_{std::move(configured)}, card_{card}
{
}

bool MachineMedium::is_configured() const
{
    return card_ == nullptr || card_->folder().empty();
}

std::optional<StorageError> MachineMedium::refusal(Use use) const
{
    using State = StorageMedium::State;
    switch (card_ != nullptr ? card_->state() : State::Usable) {
    case State::Usable:
        break;
    case State::Away:
        return StorageError::Away;
    case State::Full:
        return use == Use::Add ? std::optional{StorageError::Full} : std::nullopt;
    case State::Protected:
        return use != Use::Read ? std::optional{StorageError::Protected} : std::nullopt;
    }
    return std::nullopt;
}

std::shared_ptr<storage::FolderStorage> MachineMedium::folder() const
{
    std::string place = is_configured() ? configured_ : card_->folder();
    const std::lock_guard lock{mutex_};
    if (folder_ == nullptr || place != lies_in_) {
        folder_ =
            std::make_shared<storage::FolderStorage>(place, storage::FolderStorage::Root::Medium);
        lies_in_ = std::move(place);
    }
    return folder_;
}

template <typename T>
Stored<T> MachineMedium::used(Use use, FunctionRef<Stored<T>(Storage&)> act) const
{
    if (const auto refused = refusal(use)) {
        return not_stored(*refused);
    }
    return act(*folder());
}

Stored<StorageEntry> MachineMedium::entry(std::string_view name)
{
    return used<StorageEntry>(Use::Read, [&](Storage& all) { return all.entry(name); });
}

Stored<std::size_t> MachineMedium::read(std::string_view name, std::uint64_t offset,
                                        std::span<std::byte> into)
{
    return used<std::size_t>(Use::Read, [&](Storage& all) { return all.read(name, offset, into); });
}

Stored<void> MachineMedium::replace(std::string_view name, std::span<const std::byte> bytes,
                                    FileAccess access)
{
    return used<void>(Use::Add, [&](Storage& all) { return all.replace(name, bytes, access); });
}

Stored<void> MachineMedium::append(std::string_view name, std::span<const std::byte> bytes,
                                   FileAccess access)
{
    return used<void>(Use::Add, [&](Storage& all) { return all.append(name, bytes, access); });
}

Stored<void> MachineMedium::append_unsynced(std::string_view name, std::span<const std::byte> bytes,
                                            FileAccess access)
{
    return used<void>(Use::Add,
                      [&](Storage& all) { return all.append_unsynced(name, bytes, access); });
}

Stored<void> MachineMedium::sync(std::string_view name)
{
    return used<void>(Use::Change, [&](Storage& all) { return all.sync(name); });
}

Stored<void> MachineMedium::move(std::string_view from, std::string_view to, WhenThere when_there)
{
    return used<void>(Use::Change, [&](Storage& all) { return all.move(from, to, when_there); });
}

Stored<void> MachineMedium::remove(std::string_view name)
{
    return used<void>(Use::Change, [&](Storage& all) { return all.remove(name); });
}

Stored<StorageListing> MachineMedium::list(std::string_view folder, std::size_t most)
{
    return used<StorageListing>(Use::Read, [&](Storage& all) { return all.list(folder, most); });
}

Stored<void> MachineMedium::make_folder(std::string_view name, FileAccess access)
{
    return used<void>(Use::Add, [&](Storage& all) { return all.make_folder(name, access); });
}

Stored<bool> MachineMedium::close_to_others(std::string_view name)
{
    return used<bool>(Use::Change, [&](Storage& all) { return all.close_to_others(name); });
}

void MachineMedium::remove_unfinished(std::string_view folder)
{
    static_cast<void>(used<void>(Use::Change, [&](Storage& all) {
        all.remove_unfinished(folder);
        return Stored<void>{};
    }));
}

Stored<std::uint64_t> MachineMedium::free_space()
{
    const bool is_full = refusal(Use::Add) == StorageError::Full;
    return used<std::uint64_t>(Use::Read, [&](Storage& all) {
        return is_full ? Stored<std::uint64_t>{0} : all.free_space();
    });
}

std::string MachineMedium::place(std::string_view name) const
{
    return folder()->place(name);
}

} // namespace busbar::product
