#pragma once

#include <functional>
#include <string_view>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::client::detail {

/// `handler` of a user so that what it throws goes no further than to the log, which may be null.
/// An empty one stays empty.
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
