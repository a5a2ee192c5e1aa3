#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/binary/writer.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/types/common.hpp>

namespace busbar::server::detail {

class Session;

/// The data that an answer refers to.
struct Reply {
    std::uint32_t request_id{0};
    std::uint32_t request_handle{0};
    /// In bytes; 0 if only the channel's limit applies.
    std::uint32_t max_size{0};
    /// The request's bits, as far as the user may use them.
    std::uint32_t return_diagnostics{0};
};

/// The facts about a request before its parameters.
struct Question {
    /// Encoding id of the request's type.
    std::uint32_t encoding_id{0};
    /// Milliseconds, 0 for none (Part 4, 7.32).
    std::uint32_t timeout_hint{0};
    Reply reply;
};

/// The destination of answers: the connection that the requests came by.
class Outbox {
public:
    Outbox() = default;
    Outbox(const Outbox&) = delete;
    Outbox& operator=(const Outbox&) = delete;

    /// Sends a response of this type, which `encode_response` writes completely; a ServiceFault if
    /// it does not fit the client's limits.
    virtual void respond(const Reply& reply, std::uint32_t encoding_id,
                         FunctionRef<void(binary::Writer&)> encode_response) = 0;
    virtual void fault(const Reply& reply, StatusCode status) = 0;
    [[nodiscard]] virtual ResponseHeader response_header(const Reply& reply,
                                                         StatusCode status) const = 0;
    /// In bytes, by the channel.
    [[nodiscard]] virtual std::size_t max_response_size() const = 0;
    /// For the diagnostics: a request of this type ends in a fault. `session` may be null.
    virtual void count_fault(Session* session, std::uint32_t encoding_id, StatusCode status) = 0;
    /// The driver of the connection must look at it: there is output, or an earlier deadline.
    virtual void mark() = 0;
    /// One of the operations has answered and can be destroyed, once none of them is running.
    virtual void wants_sweep() = 0;

protected:
    ~Outbox() = default;
};

} // namespace busbar::server::detail
