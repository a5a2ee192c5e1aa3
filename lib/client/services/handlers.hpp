#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <utility>

#include <busbar/client/requester.hpp>
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

/// A request that is never sent, because it cannot be encoded.
struct NoRequest {
    static constexpr std::uint32_t binary_encoding_id = 0;
    RequestHeader request_header;

    friend void encode(binary::Writer& writer, const NoRequest& /*request*/)
    {
        writer.fail(status::Bad_NothingToDo);
    }
};

/// Calls `task` as the Requester calls handlers: later, for operations that need no request.
inline RequestId later(Requester& requester, std::function<void()> task)
{
    RequestOptions options;
    options.waits_for_session = false;
    return requester.call<ServiceFault>(
        NoRequest{}, [task = std::move(task)](const Result<ServiceFault>&) { task(); }, options);
}

/// Returns the handler of a request in an operation of several steps: `step` gets the operation and
/// the answer. A step that runs out of memory is the last one: no_memory() ends the operation, so
/// that its own handler is called nevertheless.
template <typename Operation, typename Step>
auto step_of(std::shared_ptr<Operation> operation, Step step)
{
    return [operation = std::move(operation), step = std::move(step)](auto&&... answer) {
        busbar::detail::Undo undo{[&] { operation->no_memory(); }};
        step(*operation, std::forward<decltype(answer)>(answer)...);
        undo.keep();
    };
}

} // namespace busbar::client::detail
