#pragma once

#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::crypto::detail {

/// Makes a store's folders, removes what writers that died left in them and closes private keys to
/// others than their owner. Bad_ConfigurationError if a folder cannot be made.
[[nodiscard]] Result<void> make_store_folders(Storage& storage, LogSink& log);

} // namespace busbar::crypto::detail
