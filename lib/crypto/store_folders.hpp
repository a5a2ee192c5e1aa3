#pragma once

#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::crypto::detail {

/// Creates a store's folders, removes what interrupted writers left in them and restricts private
/// keys to their owner. Bad_ConfigurationError if a folder cannot be created.
[[nodiscard]] Result<void> make_store_folders(Storage& storage, LogSink& log);

} // namespace busbar::crypto::detail
