#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <busbar/client/connection.hpp>
#include <busbar/net/client_loop.hpp>
#include <busbar/types/attribute.hpp>

#include "rule.hpp"
#include "tool/connection/connection.hpp"

namespace busbar::tool::rules {

using Clock = std::chrono::steady_clock;

/// No answer to a request of a rule, or no connection; ends the rule.
struct NoAnswer {
    StatusCode status;
    /// "no answer within 5 s".
    std::string text;
};

/// No connection to the server, or no session for the rules; ends the rule.
struct Unreachable {
    StatusCode status;
};

/// The server refuses something that a rule stands on; ends the rule.
struct Refused {
    StatusCode status;
    /// "CreateSubscription".
    std::string what;
};

/// The time that the present rule has.
class Limit {
public:
    explicit Limit(Duration time) : time_{time} {}

    void begin() { end_ = Clock::now() + time_; }
    /// Throws NoAnswer if there is none.
    [[nodiscard]] Duration left() const;

private:
    Duration time_;
    Clock::time_point end_{};
};

/// One connection to the server, with or without a session, on which requests are sent as they are.
class Line {
public:
    /// Changes the header of a request.
    using Change = std::function<void(RequestHeader&)>;

    /// Connects; throws NoAnswer or Unreachable.
    Line(const client::ConnectionConfig& config, const channel::ChannelEnvironment& environment,
         const Limit& limit);

    /// Sends a request; its response is waited for later.
    template <typename Request>
    [[nodiscard]] std::uint32_t send(Request request, const Change& change = {})
    {
        return send_encoded([&](binary::Writer& writer, const RequestHeader& header) {
            request.request_header = header;
            if (change) {
                change(request.request_header);
            }
            encode(writer, NodeId{0, Request::binary_encoding_id});
            encode(writer, request);
        });
    }
    /// Sends a body that `encode` writes.
    [[nodiscard]] std::uint32_t
    send_encoded(FunctionRef<void(binary::Writer&, const RequestHeader&)> encode);
    /// Waits for a response; the ServiceResult if that is bad. Throws NoAnswer.
    template <typename Response>
    [[nodiscard]] Result<Response> wait_for(std::uint32_t handle)
    {
        const client::ConnectionEvent event = wait(handle);
        if (event.status.is_bad()) {
            return fail(event.status);
        }
        auto response = client::decode_response<Response>(event.body, binary::Strings::Own,
                                                          client::response_limits);
        if (!response) {
            throw NoAnswer{response.error(), "the response cannot be decoded"};
        }
        return response;
    }
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> ask(Request request, const Change& change = {})
    {
        return wait_for<Response>(send(std::move(request), change));
    }
    /// The ServiceFault that answers a request; nothing if another response came.
    [[nodiscard]] Result<ServiceFault> fault_of(std::uint32_t handle)
    {
        return client::decode_response<ServiceFault>(wait(handle).body, binary::Strings::Own,
                                                     client::response_limits);
    }
    /// True if a response has come, or comes within the time.
    [[nodiscard]] bool has_answer(std::uint32_t handle, Duration time);

    [[nodiscard]] bool is_closed() { return is_closed_ || loop_.client().is_closed(); }
    [[nodiscard]] client::Connection& client() { return loop_.client(); }
    void close() { loop_.close(); }

private:
    [[nodiscard]] client::ConnectionEvent wait(std::uint32_t handle);
    /// Takes one event of the connection; false after the time.
    bool take_event(Duration time);

    const Limit* limit_;
    bool is_closed_{false};
    StatusCode why_closed_;
    std::map<std::uint32_t, client::ConnectionEvent> answers_;
    net::ClientLoop loop_;
};

/// A Variable that rules may write.
struct WritableNode {
    NodeId id;
    DataValue value;
};

/// The server that rules are applied to.
class Subject {
public:
    /// Takes endpoint, user and certificates of `connection`, which must outlive this and is
    /// closed.
    Subject(Connection& connection, Duration rule_timeout, const std::optional<NodeId>& writable);
    ~Subject();

    /// Begins another rule: it has the time of a rule.
    void begin() { limit_.begin(); }
    [[nodiscard]] const Limit& limit() const { return limit_; }
    /// The reason why a rule with this need cannot be applied; empty if it can.
    [[nodiscard]] std::string lacks(RuleNeed need);

    /// Notes that no connection can be made any more; false if that was known.
    [[nodiscard]] bool note_unreachable() { return !std::exchange(is_unreachable_, true); }
    /// True if session() would not have to connect.
    [[nodiscard]] bool has_session() { return session_ && !session_->is_closed(); }
    /// The session of all rules that do not harm it; another one if it was lost. Throws
    /// Unreachable.
    [[nodiscard]] Line& session();
    /// A connection with a session of its own.
    [[nodiscard]] Line other_session();
    /// A connection with the channel of the session, but without one.
    [[nodiscard]] Line channel();
    /// A connection without security.
    [[nodiscard]] Line open_channel();
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> ask(Request request, const Line::Change& change = {})
    {
        return session().ask<Response>(std::move(request), change);
    }

    [[nodiscard]] const client::ConnectionConfig& config() const { return config_; }
    [[nodiscard]] const channel::ChannelEnvironment& environment() const { return *environment_; }
    [[nodiscard]] const EndpointDescription& endpoint() const { return endpoint_; }
    [[nodiscard]] const WritableNode& writable() const { return *writable_; }
    /// OperationLimits of the server; 0: none.
    [[nodiscard]] const client::ServerOperationLimits& limits() const { return limits_; }

private:
    Limit limit_;
    bool is_unreachable_{false};
    client::ConnectionConfig config_;
    const channel::ChannelEnvironment* environment_;
    EndpointDescription endpoint_;
    client::ServerOperationLimits limits_;
    std::optional<WritableNode> writable_;
    std::optional<std::string> open_refusal_;
    std::optional<Line> session_;
};

} // namespace busbar::tool::rules
