#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <busbar/controller/backup.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// A file in a backup.
struct SavedFile {
    std::string name;
    std::vector<std::byte> bytes;
};

/// An item in a backup.
struct SavedItem {
    std::string name;
    MemoryGroup group{MemoryGroup::ServerSettings};
    std::vector<SavedFile> files;
};

/// A backup file (see MachineMemory).
struct SavedMemory {
    BackupLabel label{};
    bool has_opc_ua{true};
    std::vector<SavedItem> items;
};

/// Encodes a backup; every name of a file must have passed is_saved_name.
[[nodiscard]] std::vector<std::byte> write_backup(const SavedMemory& memory);
/// Decodes a backup within the limits. Checks that names are valid in a storage and unique, but
/// compares nothing with what a controller has. `created` is not parsed: it is for people.
[[nodiscard]] BUSBAR_API Configured<SavedMemory> read_backup(std::span<const std::byte> file,
                                                             const MemoryLimits& limits);

/// Tells whether a name survives a round trip through JSON.
[[nodiscard]] bool is_saved_name(const std::string& name);

} // namespace busbar::controller::detail
