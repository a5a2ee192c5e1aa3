#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <busbar/controller/backup.hpp>
#include <busbar/core/function_ref.hpp>

#include "backup_file.hpp"

namespace busbar::controller::detail {

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
