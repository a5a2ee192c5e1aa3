#pragma once

#include <functional>
#include <string_view>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::client::detail {

/// Wraps a user's `handler` so that its exceptions are only logged, to a log that may be null. An
/// empty one stays empty.
template <typename... Args>
std::function<void(Args...)> guarded_handler(LogSink* log, std::string_view name,
                                             std::function<void(Args...)> handler)
{
    if (!handler) {
        return {};
    }
    return [log, name, handler = std::move(handler)](Args... args) {
        NullLog nowhere;
        busbar::detail::guarded(log != nullptr ? *log : nowhere, name,
                                [&] { handler(std::forward<Args>(args)...); });
    };
}

} // namespace busbar::client::detail
