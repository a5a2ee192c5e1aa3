#pragma once

#include <functional>

#include <busbar/client/requester.hpp>

namespace busbar::client::detail {

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

} // namespace busbar::client::detail
