#include "memory_plan.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/file_transaction.hpp>
#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

Configured<void> MemoryPlan::put(const MemoryItem& item, const std::vector<SavedFile>& files)
{
    if (item.part) {
        return put_part(item, files.empty() ? std::span<const std::byte>{} : files.front().bytes);
    }
    auto there = files_there(storage_, item, limits_);
    if (!there) {
        return Unexpected{std::move(there.error())};
    }
    removed_.insert(there->begin(), there->end());
    for (const SavedFile& file : files) {
        new_files_[file.name] = {file.bytes, item.access};
        removed_.erase(file.name);
    }
    return {};
}

Configured<void> MemoryPlan::put_part(const MemoryItem& item, std::span<const std::byte> part)
{
    const std::string& file = item.part->file;
    auto found = shared_.find(file);
    if (found == shared_.end()) {
        auto whole = read_whole(storage_, *item.part, limits_);
        if (!whole) {
            return Unexpected{std::move(whole.error())};
        }
        const bool is_there = !whole->empty();
        found = shared_.emplace(file, Shared{*std::move(whole), is_there, &item}).first;
    }
    Shared& shared = found->second;
    auto joined = item.part->put(shared.bytes, part);
    if (!joined) {
        return Unexpected{std::move(joined.error())};
    }
    shared.bytes = *std::move(joined);
    new_files_.erase(file);
    removed_.erase(file);
    if (!shared.bytes.empty()) {
        new_files_[file] = {shared.bytes, item.access};
    } else if (shared.is_there) {
        removed_.insert(file);
    }
    return {};
}

Configured<void> MemoryPlan::check_shared() const
{
    for (const auto& [file, shared] : shared_) {
        if (!shared.bytes.empty() && shared.item->check) {
            if (auto checked = shared.item->check(file, shared.bytes); !checked) {
                return checked;
            }
        }
    }
    return {};
}

Configured<void> MemoryPlan::add_initial(const MemoryItem& item)
{
    const auto there = files_there(storage_, item, limits_);
    if (!there) {
        return Unexpected{there.error()};
    }
    for (const MemoryItem::InitialFile& file : item.initial) {
        const bool is_there = std::find(there->begin(), there->end(), file.name) != there->end() &&
                              removed_.count(file.name) == 0;
        if (!is_there && new_files_.count(file.name) == 0) {
            new_files_[file.name] = {std::as_bytes(std::span{file.content}), item.access};
            removed_.erase(file.name);
        }
    }
    return {};
}

/// Checks the limits of a transaction's journal; a removed file counts as much as a new one.
Configured<void> MemoryPlan::check_limits() const
{
    std::size_t names_size = 0;
    for (const std::string& name : removed_) {
        names_size += name.size();
    }
    if (removed_.size() > limits_.max_files || names_size > limits_.max_names_size) {
        return misconfigured("memory", "found " + std::to_string(removed_.size()) +
                                           " files to remove, expected at most " +
                                           std::to_string(limits_.max_files) + ", with names of " +
                                           std::to_string(limits_.max_names_size) + " bytes");
    }
    return {};
}

Configured<void> MemoryPlan::carry_out(const std::string& transaction) const
{
    if (auto checked = check_limits(); !checked) {
        return checked;
    }
    FileTransaction change{storage_, transaction};
    for (const auto& [name, file] : new_files_) {
        const std::string_view folder = memory_folder_of(name);
        const auto made =
            folder.empty() ? Stored<void>{} : storage_.make_folder(folder, file.access);
        const auto staged = made ? change.replace(name, file.bytes, file.access) : made;
        if (!staged) {
            return storage_problem(storage_, name, staged.error());
        }
    }
    for (const std::string& name : removed_) {
        if (const auto staged = change.remove(name); !staged) {
            return storage_problem(storage_, name, staged.error());
        }
    }
    const auto done = change.commit();
    // A change that is decided is finished by the next recover().
    if (!done && !change.is_decided()) {
        return storage_problem(storage_, transaction, done.error());
    }
    return {};
}

Unexpected<Problem> storage_problem(const Storage& storage, std::string_view name,
                                    StorageError error)
{
    return misconfigured(storage.place(name), std::string{text(error)}, status_of(error));
}

std::string_view memory_folder_of(std::string_view name)
{
    const std::size_t slash = name.rfind('/');
    return slash == std::string_view::npos ? std::string_view{} : name.substr(0, slash);
}

bool has_file(const MemoryItem& item, std::string_view name)
{
    const auto has = [](const std::vector<std::string>& names, std::string_view one) {
        return std::find(names.begin(), names.end(), one) != names.end();
    };
    return has(item.files, name) || has(item.folders, memory_folder_of(name));
}

Configured<std::vector<std::string>> files_there(Storage& storage, const MemoryItem& item,
                                                 const MemoryLimits& limits)
{
    std::vector<std::string> names;
    for (const std::string& file : item.files) {
        const auto entry = storage.entry(file);
        if (!entry && entry.error() != StorageError::NotFound) {
            return storage_problem(storage, file, entry.error());
        }
        if (entry && entry->kind != StorageEntry::Kind::Folder) {
            names.push_back(file);
        }
    }
    for (const std::string& folder : item.folders) {
        const auto listing = storage.list(folder, limits.max_files);
        if (!listing && listing.error() == StorageError::NotFound) {
            continue;
        }
        if (!listing || listing->is_cut) {
            return storage_problem(storage, folder,
                                   listing ? StorageError::TooLarge : listing.error());
        }
        for (const StorageEntry& entry : listing->entries) {
            if (entry.kind != StorageEntry::Kind::Folder) {
                names.push_back(storage_path(folder, entry.name));
            }
        }
    }
    return names;
}

Configured<std::vector<std::byte>> read_whole(Storage& storage, const FilePart& part,
                                              const MemoryLimits& limits)
{
    auto bytes = read_file(storage, part.file, limits.max_file_size);
    if (!bytes && bytes.error() != StorageError::NotFound) {
        return storage_problem(storage, part.file, bytes.error());
    }
    return bytes ? *std::move(bytes) : std::vector<std::byte>{};
}

Configured<std::vector<SavedFile>> part_of(const MemoryItem& item, std::span<const std::byte> whole)
{
    std::vector<SavedFile> files;
    auto taken = item.part->take(whole);
    if (!taken) {
        return Unexpected{std::move(taken.error())};
    }
    if (!taken->empty()) {
        files.push_back({item.files.front(), *std::move(taken)});
    }
    return files;
}

namespace {

Configured<SavedItem> read_part(Storage& storage, const MemoryItem& item,
                                const MemoryLimits& limits)
{
    const auto whole = read_whole(storage, *item.part, limits);
    auto files = whole ? part_of(item, *whole)
                       : Configured<std::vector<SavedFile>>{Unexpected{whole.error()}};
    if (!files) {
        return Unexpected{std::move(files.error())};
    }
    return SavedItem{item.name, item.group, *std::move(files)};
}

} // namespace

Configured<SavedItem> read_item(Storage& storage, const MemoryItem& item,
                                const MemoryLimits& limits)
{
    if (item.part) {
        return read_part(storage, item, limits);
    }
    auto names = files_there(storage, item, limits);
    if (!names) {
        return Unexpected{std::move(names.error())};
    }
    SavedItem saved{item.name, item.group, {}};
    for (std::string& name : *names) {
        if (!is_saved_name(name)) {
            return misconfigured(storage.place(memory_folder_of(name)),
                                 "found a file whose name is not text: " + printable(name));
        }
        auto bytes = read_file(storage, name, limits.max_file_size);
        if (!bytes) {
            return storage_problem(storage, name, bytes.error());
        }
        saved.files.push_back({std::move(name), *std::move(bytes)});
    }
    return saved;
}

} // namespace busbar::controller::detail
