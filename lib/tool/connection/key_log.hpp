#pragma once

#include <memory>

#include <busbar/channel/key_log.hpp>
#include <busbar/core/log.hpp>

#include "context.hpp"

namespace busbar::tool {

/// Returns the file of --key-log, which only its owner can read, after a warning; null if the
/// option is not given. Throws Failure, also in a build that does not export keys. `log` must
/// outlive the result.
[[nodiscard]] std::unique_ptr<channel::KeyLog> open_key_log(Context& context, LogSink& log);

} // namespace busbar::tool
