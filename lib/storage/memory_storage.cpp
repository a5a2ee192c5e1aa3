#include <busbar/storage/memory_storage.hpp>

#include <algorithm>
#include <utility>

#include "names.hpp"

namespace busbar::storage {

namespace {

using detail::is_folder_name;
using detail::last_part;

std::string_view folder_of(std::string_view name)
{
    const std::size_t slash = name.rfind('/');
    return slash == std::string_view::npos ? std::string_view{} : name.substr(0, slash);
}

} // namespace

void MemoryStorage::cut_power_after(std::size_t steps)
{
    end_ = steps_ + steps;
    error_.reset();
}

void MemoryStorage::restore_power()
{
    is_dark_ = false;
    end_ = SIZE_MAX;
    error_.reset();
}

void MemoryStorage::lose_unsynced(std::size_t kept)
{
    for (auto& [name, item] : items_) {
        const std::size_t lost = item.unsynced - std::min(item.unsynced, kept);
        item.bytes.resize(item.bytes.size() - lost);
        item.unsynced = 0;
    }
}

void MemoryStorage::fail_once_after(std::size_t steps, StorageError error)
{
    end_ = steps_ + steps;
    error_ = error;
}

std::vector<std::string> MemoryStorage::names() const
{
    std::vector<std::string> result;
    for (const auto& [name, item] : items_) {
        if (!item.is_folder) {
            result.push_back(name);
        }
    }
    return result;
}

std::vector<std::string> MemoryStorage::unfinished() const
{
    std::vector<std::string> result;
    for (const auto& [name, size] : unfinished_) {
        result.push_back(name);
    }
    return result;
}

bool MemoryStorage::is_open_to_others(std::string_view name) const
{
    const auto found = items_.find(name);
    return found != items_.end() && found->second.access == FileAccess::Everyone;
}

void MemoryStorage::open_to_others(std::string_view name)
{
    if (const auto found = items_.find(name); found != items_.end()) {
        found->second.access = FileAccess::Everyone;
    }
}

std::optional<StorageError> MemoryStorage::refusal(std::string_view name) const
{
    if (!is_storage_name(name)) {
        return StorageError::BadName;
    }
    if (is_away_ || is_dark_) {
        return StorageError::Away;
    }
    return std::nullopt;
}

std::optional<StorageError> MemoryStorage::refusal_of_change(std::string_view name) const
{
    if (const auto refused = refusal(name)) {
        return refused;
    }
    if (is_protected_) {
        return StorageError::Protected;
    }
    if (!is_folder(folder_of(name))) {
        return StorageError::NotFound;
    }
    return std::nullopt;
}

bool MemoryStorage::is_folder(std::string_view name) const
{
    const auto found = items_.find(name);
    return name.empty() || (found != items_.end() && found->second.is_folder);
}

bool MemoryStorage::has_children(std::string_view name) const
{
    const std::string prefix = std::string{name} + "/";
    const auto found = items_.lower_bound(prefix);
    return found != items_.end() && found->first.compare(0, prefix.size(), prefix) == 0;
}

std::uint64_t MemoryStorage::used() const
{
    std::uint64_t bytes = 0;
    for (const auto& [name, item] : items_) {
        bytes += item.bytes.size();
    }
    for (const auto& [name, size] : unfinished_) {
        bytes += size;
    }
    return bytes;
}

std::size_t MemoryStorage::take_bytes(std::size_t count)
{
    const std::size_t taken = std::min(count, end_ - std::min(end_, steps_));
    steps_ += taken;
    return taken;
}

Stored<void> MemoryStorage::take_step()
{
    if (steps_ < end_) {
        ++steps_;
        return {};
    }
    end_ = SIZE_MAX;
    if (error_) {
        return not_stored(*std::exchange(error_, std::nullopt));
    }
    is_dark_ = true;
    return not_stored(StorageError::Away);
}

StorageEntry MemoryStorage::entry_of(std::string_view name, const Item& item) const
{
    StorageEntry entry;
    entry.name = last_part(name);
    entry.kind = item.is_folder ? StorageEntry::Kind::Folder : StorageEntry::Kind::File;
    entry.size = item.bytes.size();
    entry.modified = item.modified;
    entry.touched = item.modified;
    entry.version.parts[0] = item.version;
    return entry;
}

void MemoryStorage::touch(Item& item)
{
    item.modified = now_;
    item.version = ++versions_;
}

void MemoryStorage::touch_folder_of(std::string_view name)
{
    if (const auto found = items_.find(folder_of(name)); found != items_.end()) {
        touch(found->second);
    }
}

Stored<StorageEntry> MemoryStorage::entry(std::string_view name)
{
    if (const auto refused = refusal(name)) {
        return not_stored(*refused);
    }
    const auto found = items_.find(name);
    if (found == items_.end()) {
        return not_stored(StorageError::NotFound);
    }
    return entry_of(name, found->second);
}

Stored<std::size_t> MemoryStorage::read(std::string_view name, std::uint64_t offset,
                                        std::span<std::byte> into)
{
    if (const auto refused = refusal(name)) {
        return not_stored(*refused);
    }
    const auto found = items_.find(name);
    if (found == items_.end() || found->second.is_folder) {
        return not_stored(found == items_.end() ? StorageError::NotFound : StorageError::Failed);
    }
    ++reads_;
    const std::vector<std::byte>& bytes = found->second.bytes;
    const std::uint64_t begin = std::min<std::uint64_t>(offset, bytes.size());
    const std::uint64_t count = std::min<std::uint64_t>(into.size(), bytes.size() - begin);
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), count, into.begin());
    return static_cast<std::size_t>(count);
}

Stored<void> MemoryStorage::replace(std::string_view name, std::span<const std::byte> bytes,
                                    FileAccess access)
{
    if (const auto refused = refusal_of_change(name)) {
        return not_stored(*refused);
    }
    const auto found = items_.find(name);
    if (found != items_.end() && found->second.is_folder) {
        return not_stored(StorageError::Failed);
    }
    // Both versions exist for a moment.
    if (used() + bytes.size() > capacity_) {
        return not_stored(StorageError::Full);
    }
    // Allocate first: without memory the file stays as it was.
    Items made;
    Item& item = made[std::string{name}];
    item.access = access;
    item.bytes.assign(bytes.begin(), bytes.end());
    const std::size_t written = take_bytes(bytes.size());
    if (auto named = take_step(); !named) {
        if (is_dark_) {
            unfinished_[std::string{name}] += written;
        }
        return named;
    }
    touch(item);
    if (found != items_.end()) {
        items_.erase(found);
    }
    items_.insert(made.extract(made.begin()));
    touch_folder_of(name);
    return {};
}

Stored<void> MemoryStorage::append(std::string_view name, std::span<const std::byte> bytes,
                                   FileAccess access)
{
    return add(name, bytes, access, true);
}

Stored<void> MemoryStorage::append_unsynced(std::string_view name, std::span<const std::byte> bytes,
                                            FileAccess access)
{
    return add(name, bytes, access, false);
}

Stored<void> MemoryStorage::sync(std::string_view name)
{
    if (const auto refused = refusal_of_change(name)) {
        return not_stored(*refused);
    }
    const auto found = items_.find(name);
    if (found == items_.end()) {
        return not_stored(StorageError::NotFound);
    }
    if (auto taken = take_step(); !taken) {
        return taken;
    }
    found->second.unsynced = 0;
    return {};
}

Stored<void> MemoryStorage::add(std::string_view name, std::span<const std::byte> bytes,
                                FileAccess access, bool is_synced)
{
    if (const auto refused = refusal_of_change(name)) {
        return not_stored(*refused);
    }
    auto found = items_.find(name);
    if (found == items_.end()) {
        if (auto made = take_step(); !made) {
            return made;
        }
        found = items_.emplace(std::string{name}, Item{false, access, {}, {}, 0}).first;
        touch_folder_of(name);
    }
    if (found->second.is_folder) {
        return not_stored(StorageError::Failed);
    }
    const std::uint64_t room = capacity_ - std::min(capacity_, used());
    const auto fitting = static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), room));
    const auto written = static_cast<std::ptrdiff_t>(take_bytes(fitting));
    found->second.bytes.insert(found->second.bytes.end(), bytes.begin(), bytes.begin() + written);
    found->second.unsynced += static_cast<std::size_t>(written);
    touch(found->second);
    if (static_cast<std::size_t>(written) < fitting) {
        return take_step();
    }
    auto added =
        fitting < bytes.size() ? Stored<void>{not_stored(StorageError::Full)} : take_step();
    if (added && is_synced) {
        found->second.unsynced = 0;
    }
    return added;
}

Stored<void> MemoryStorage::move(std::string_view from, std::string_view to, WhenThere when_there)
{
    for (const std::string_view name : {from, to}) {
        if (const auto refused = refusal_of_change(name)) {
            return not_stored(*refused);
        }
    }
    const auto found = items_.find(from);
    const auto target = items_.find(to);
    if (found == items_.end()) {
        return not_stored(StorageError::NotFound);
    }
    if (target != items_.end() && when_there == WhenThere::Refuse) {
        return not_stored(StorageError::Exists);
    }
    if (found->second.is_folder || (target != items_.end() && target->second.is_folder)) {
        return not_stored(StorageError::Failed);
    }
    std::string new_name{to};
    if (auto taken = take_step(); !taken || from == to) {
        return taken;
    }
    auto item = items_.extract(found);
    item.key() = std::move(new_name);
    item.mapped().version = ++versions_;
    items_.erase(item.key());
    items_.insert(std::move(item));
    touch_folder_of(from);
    touch_folder_of(to);
    return {};
}

Stored<void> MemoryStorage::remove(std::string_view name)
{
    if (const auto refused = refusal_of_change(name)) {
        return not_stored(*refused);
    }
    const auto found = items_.find(name);
    if (found == items_.end() || has_children(name)) {
        return not_stored(found == items_.end() ? StorageError::NotFound : StorageError::Exists);
    }
    if (auto taken = take_step(); !taken) {
        return taken;
    }
    items_.erase(found);
    touch_folder_of(name);
    return {};
}

Stored<StorageListing> MemoryStorage::list(std::string_view folder, std::size_t most)
{
    if (!is_folder_name(folder)) {
        return not_stored(StorageError::BadName);
    }
    if (is_away_ || is_dark_) {
        return not_stored(StorageError::Away);
    }
    if (!is_folder(folder)) {
        return not_stored(StorageError::NotFound);
    }
    StorageListing listing;
    const std::string within = folder.empty() ? std::string{} : std::string{folder} + '/';
    for (auto each = items_.lower_bound(within); each != items_.end(); ++each) {
        const auto& [name, item] = *each;
        if (!name.starts_with(within)) {
            break; // names are sorted
        }
        if (folder_of(name) != folder) {
            continue;
        }
        if (listing.entries.size() == most) {
            listing.is_cut = true;
            break;
        }
        listing.entries.push_back(entry_of(name, item));
    }
    return listing;
}

Stored<void> MemoryStorage::make_folder(std::string_view name, FileAccess access)
{
    if (!is_folder_name(name)) {
        return not_stored(StorageError::BadName);
    }
    if (is_away_ || is_dark_) {
        return not_stored(StorageError::Away);
    }
    for (std::size_t at = 0; at < name.size();) {
        at = std::min(name.find('/', at + 1), name.size());
        const std::string_view part = name.substr(0, at);
        if (is_folder(part)) {
            continue;
        }
        if (is_protected_ || items_.find(part) != items_.end()) {
            return not_stored(is_protected_ ? StorageError::Protected : StorageError::Failed);
        }
        if (auto taken = take_step(); !taken) {
            return taken;
        }
        Item item{true, at == name.size() ? access : FileAccess::Everyone, {}, {}, 0};
        touch(item);
        items_.emplace(std::string{part}, std::move(item));
        touch_folder_of(part);
    }
    return {};
}

Stored<bool> MemoryStorage::close_to_others(std::string_view name)
{
    if (const auto refused = refusal_of_change(name)) {
        return not_stored(*refused);
    }
    const auto found = items_.find(name);
    if (found == items_.end()) {
        return not_stored(StorageError::NotFound);
    }
    if (found->second.access == FileAccess::Owner) {
        return false;
    }
    if (const auto taken = take_step(); !taken) {
        return not_stored(taken.error());
    }
    found->second.access = FileAccess::Owner;
    return true;
}

void MemoryStorage::remove_unfinished(std::string_view folder)
{
    if (!is_away_ && !is_dark_ && !is_protected_) {
        std::erase_if(unfinished_,
                      [&](const auto& each) { return folder_of(each.first) == folder; });
    }
}

Stored<std::uint64_t> MemoryStorage::free_space()
{
    if (is_away_ || is_dark_) {
        return not_stored(StorageError::Away);
    }
    return capacity_ - std::min(capacity_, used());
}

std::string MemoryStorage::place(std::string_view name) const
{
    return "memory:" + std::string{name};
}

} // namespace busbar::storage
