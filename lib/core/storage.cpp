#include <busbar/core/storage.hpp>

#include <algorithm>
#include <array>

#include <busbar/core/status_codes.hpp>

namespace busbar {

namespace {

constexpr std::size_t max_name_size = 1'024;
constexpr std::size_t max_part_size = 255;
/// Number of attempts to read a file that changes while it is read.
constexpr int max_attempts = 8;

bool is_part(std::string_view part)
{
    return !part.empty() && part.size() <= max_part_size && part != "." && part != ".." &&
           part.find('\0') == std::string_view::npos;
}

} // namespace

std::string_view text(StorageError error)
{
    constexpr std::array texts = {
        "there is no such file",
        "a file of that name exists already",
        "it is too large",
        "there is no space left",
        "it is protected",
        "the folder or its medium is missing",
        "the name is not a valid file name",
        "the medium failed",
        "no further changes are accepted before a restart",
    };
    return texts[static_cast<std::size_t>(error)];
}

StatusCode status_of(StorageError error)
{
    switch (error) {
    case StorageError::NotFound:
        return status::Bad_NotFound;
    case StorageError::Exists:
        return status::Bad_EntryExists;
    case StorageError::BadName:
        return status::Bad_InvalidArgument;
    case StorageError::Closed:
        return status::Bad_InvalidState;
    case StorageError::TooLarge:
    case StorageError::Full:
    case StorageError::Protected:
    case StorageError::Away:
    case StorageError::Failed:
        break;
    }
    return status::Bad_ResourceUnavailable;
}

bool is_storage_name(std::string_view name)
{
    if (name.size() > max_name_size) {
        return false;
    }
    for (std::size_t begin = 0;;) {
        const std::size_t end = std::min(name.find('/', begin), name.size());
        if (!is_part(name.substr(begin, end - begin))) {
            return false;
        }
        if (end == name.size()) {
            return true;
        }
        begin = end + 1;
    }
}

Stored<std::vector<std::byte>> read_file(Storage& storage, std::string_view name,
                                         std::size_t max_size)
{
    std::vector<std::byte> bytes;
    for (int i = 0; i < max_attempts; ++i) {
        const auto entry = storage.entry(name);
        if (!entry) {
            return not_stored(entry.error());
        }
        // The size of a link itself is meaningless.
        const bool is_known = entry->kind == StorageEntry::Kind::File && entry->size < max_size;
        // One byte more than the file has: if that is filled too, the file has changed meanwhile.
        bytes.resize((is_known ? static_cast<std::size_t>(entry->size) : max_size) + 1);
        const auto count = storage.read(name, 0, bytes);
        if (!count) {
            return not_stored(count.error());
        }
        if (*count < bytes.size()) {
            bytes.resize(*count);
            return bytes;
        }
        if (!is_known) {
            break;
        }
    }
    return not_stored(StorageError::TooLarge);
}

std::string storage_path(std::string_view folder, std::string_view name)
{
    std::string path{folder};
    if (!path.empty()) {
        path += '/';
    }
    path += name;
    return path;
}

} // namespace busbar
