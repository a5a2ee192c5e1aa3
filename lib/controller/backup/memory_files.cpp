#include "memory_files.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

tl::unexpected<Problem> storage_problem(const Storage& storage, std::string_view name,
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

Configured<SavedItem> read_item(Storage& storage, const MemoryItem& item,
                                const MemoryLimits& limits)
{
    auto names = files_there(storage, item, limits);
    if (!names) {
        return tl::unexpected{std::move(names.error())};
    }
    SavedItem saved{item.name, item.group, {}};
    for (std::string& name : *names) {
        if (!is_saved_name(name)) {
            return misconfigured(storage.place(memory_folder_of(name)),
                                 "found a file whose name is no text: " + printable(name));
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
