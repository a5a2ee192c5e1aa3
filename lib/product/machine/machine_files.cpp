#include "machine_files.hpp"

#include <algorithm>

namespace busbar::product {

namespace {

bool is_of_events(std::string_view name)
{
    constexpr std::string_view folder = MachineFiles::event_folder;
    return name == folder || (name.starts_with(folder) && name[folder.size()] == '/');
}

/// Returns the name in the event log's own Storage.
std::string_view event_name(std::string_view name)
{
    return name.substr(std::min(name.size(), MachineFiles::event_folder.size() + 1));
}

} // namespace

Stored<StorageEntry> MachineFiles::entry(std::string_view name)
{
    return is_of_events(name) ? events_.entry(event_name(name)) : files_.entry(name);
}

Stored<std::size_t> MachineFiles::read(std::string_view name, std::uint64_t offset,
                                       std::span<std::byte> into)
{
    return is_of_events(name) ? events_.read(event_name(name), offset, into)
                              : files_.read(name, offset, into);
}

Stored<void> MachineFiles::replace(std::string_view name, std::span<const std::byte> bytes,
                                   FileAccess access)
{
    return is_of_events(name) ? Stored<void>{not_stored(StorageError::Protected)}
                              : files_.replace(name, bytes, access);
}

Stored<void> MachineFiles::append(std::string_view name, std::span<const std::byte> bytes,
                                  FileAccess access)
{
    return is_of_events(name) ? Stored<void>{not_stored(StorageError::Protected)}
                              : files_.append(name, bytes, access);
}

Stored<void> MachineFiles::move(std::string_view from, std::string_view to, WhenThere when_there)
{
    return is_of_events(from) || is_of_events(to)
               ? Stored<void>{not_stored(StorageError::Protected)}
               : files_.move(from, to, when_there);
}

Stored<void> MachineFiles::remove(std::string_view name)
{
    return is_of_events(name) ? Stored<void>{not_stored(StorageError::Protected)}
                              : files_.remove(name);
}

Stored<StorageListing> MachineFiles::list(std::string_view folder, std::size_t most)
{
    return is_of_events(folder) ? events_.list(event_name(folder), most)
                                : files_.list(folder, most);
}

Stored<void> MachineFiles::make_folder(std::string_view name, FileAccess access)
{
    return is_of_events(name) ? Stored<void>{not_stored(StorageError::Protected)}
                              : files_.make_folder(name, access);
}

Stored<bool> MachineFiles::close_to_others(std::string_view name)
{
    return is_of_events(name) ? Stored<bool>{not_stored(StorageError::Protected)}
                              : files_.close_to_others(name);
}

void MachineFiles::remove_unfinished(std::string_view folder)
{
    if (!is_of_events(folder)) {
        files_.remove_unfinished(folder);
    }
}

std::string MachineFiles::place(std::string_view name) const
{
    return is_of_events(name) ? events_.place(event_name(name)) : files_.place(name);
}

} // namespace busbar::product
