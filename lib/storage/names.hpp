#pragma once

#include <string_view>

#include <busbar/core/storage.hpp>

namespace busbar::storage::detail {

[[nodiscard]] inline std::string_view last_part(std::string_view name)
{
    return name.substr(name.rfind('/') + 1);
}

/// The root or a folder below it.
[[nodiscard]] inline bool is_folder_name(std::string_view name)
{
    return name.empty() || is_storage_name(name);
}

} // namespace busbar::storage::detail
