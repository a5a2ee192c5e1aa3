#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/backup.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>

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

/// The manifest of this version of the format.
inline constexpr std::string_view backup_version = "2";
inline constexpr std::size_t max_manifest_size = 4U << 20U;

/// Lists what the memory has, without the bytes of its files.
[[nodiscard]] std::string manifest_of(const SavedMemory& memory);

/// Returns the bytes of a file that a manifest names, in its order.
using TakeFile =
    FunctionRef<Configured<std::span<const std::byte>>(const std::string& name, std::size_t size)>;

enum class ManifestForm { Earlier, WithVersion };
/// Reads a manifest and takes its files, within the limits.
[[nodiscard]] Configured<SavedMemory> read_manifest(std::span<const std::byte> manifest,
                                                    ManifestForm form, const MemoryLimits& limits,
                                                    TakeFile take);

[[nodiscard]] Unexpected<Problem> wrong_backup(std::string text);

} // namespace busbar::controller::detail
