#include "memory_files.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

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
