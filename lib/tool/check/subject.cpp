#include "subject.hpp"

#include <algorithm>

#include <busbar/client/attributes.hpp>

namespace busbar::tool::rules {

namespace {

std::string seconds_text(Duration time)
{
    char text[32];
    std::snprintf(text, sizeof text, "%g s", std::chrono::duration<double>{time}.count());
    return text;
}

client::ConnectionConfig config_of(const Connection& connection,
                                   const EndpointDescription& endpoint)
{
    client::ConnectionConfig config;
    config.channel.endpoint_url = endpoint.endpoint_url.str();
    config.channel.security.policy = crypto::find_policy(endpoint.security_policy_uri.view());
    config.channel.security.mode = endpoint.security_mode;
    if (const auto chain = crypto::parse_chain(endpoint.server_certificate.span())) {
        config.channel.server_certificate = chain->front();
    }
    config.application_name = "busbar check";
    config.session_name = "busbar check";
    config.application_uri = connection.application_uri();
    config.identity = connection.user();
    return config;
}

} // namespace

Duration Limit::left() const
{
    const Duration time = end_ - Clock::now();
    if (time <= Duration::zero()) {
        throw NoAnswer{status::Bad_Timeout, "no answer within " + seconds_text(time_)};
    }
    return time;
}

Line::Line(const client::ConnectionConfig& config, const channel::ChannelEnvironment& environment,
           const Limit& limit)
    : limit_{&limit}
{
    const auto connected = loop_.connect(config, environment, limit.left());
    if (!connected) {
        throw Unreachable{connected.error()};
    }
    while (const auto event = loop_.wait(limit.left())) {
        if (event->kind == client::ConnectionEvent::Kind::Ready) {
            return;
        }
        if (event->kind == client::ConnectionEvent::Kind::Closed) {
            throw NoAnswer{event->status, config.wants_session ? "no session" : "no channel"};
        }
    }
    static_cast<void>(limit.left());
    throw NoAnswer{status::Bad_Timeout, "no connection"};
}

std::uint32_t Line::send_encoded(FunctionRef<void(binary::Writer&, const RequestHeader&)> encode)
{
    const auto handle = client().send_encoded(encode, limit_->left());
    if (!handle) {
        throw NoAnswer{handle.error(), "the request was not sent"};
    }
    return *handle;
}

bool Line::take_event(Duration time)
{
    auto event = loop_.wait(time);
    if (!event) {
        return false;
    }
    if (event->kind == client::ConnectionEvent::Kind::Response) {
        const std::uint32_t handle = event->handle;
        answers_.insert_or_assign(handle, *std::move(event));
    } else if (event->kind == client::ConnectionEvent::Kind::Closed) {
        is_closed_ = true;
        why_closed_ = event->status;
    }
    return true;
}

client::ConnectionEvent Line::wait(std::uint32_t handle)
{
    for (;;) {
        if (const auto found = answers_.find(handle); found != answers_.end()) {
            client::ConnectionEvent event = std::move(found->second);
            answers_.erase(found);
            if (event.body.empty()) { // the reason why there is no response
                if (event.status == status::Bad_Timeout) {
                    throw NoAnswer{event.status, "no answer in time"};
                }
                while (!is_closed_) {
                    static_cast<void>(take_event(limit_->left()));
                }
                throw NoAnswer{why_closed_, "the connection was closed"};
            }
            return event;
        }
        if (is_closed_) {
            throw NoAnswer{why_closed_, "the connection was closed"};
        }
        static_cast<void>(take_event(limit_->left()));
    }
}

bool Line::has_answer(std::uint32_t handle, Duration time)
{
    const auto end = Clock::now() + time;
    while (!answers_.contains(handle) && !is_closed_ && Clock::now() < end) {
        static_cast<void>(take_event(std::min<Duration>(end - Clock::now(), limit_->left())));
    }
    return answers_.contains(handle);
}

Subject::Subject(Connection& connection, Duration rule_timeout,
                 const std::optional<NodeId>& writable)
    : limit_{rule_timeout}, environment_{&connection.environment()},
      endpoint_{*connection.client().endpoint()}, limits_{
                                                      connection.client().server().operation_limits}
{
    config_ = config_of(connection, endpoint_);
    config_.request_timeout = std::chrono::duration_cast<std::chrono::milliseconds>(rule_timeout);
    if (writable) {
        ReadRequest request;
        request.nodes_to_read = {client::attribute_of(*writable)};
        auto response =
            connection.call<ReadResponse>(std::move(request), "reading the node for writing");
        if (response.results.size() != 1 || response.results[0].status.is_bad()) {
            throw Failure{response.results.empty() ? StatusCode{status::Bad_UnknownResponse}
                                                   : response.results[0].status,
                          to_string(*writable), "its value must be readable to be restored"};
        }
        writable_ = WritableNode{*writable, std::move(response.results[0])};
    }
    connection.close();
}

Subject::~Subject()
{
    if (session_) {
        session_->close();
    }
}

std::string Subject::lacks(RuleNeed need)
{
    if (need == RuleNeed::Writable && !writable_) {
        return "no node may be written: --allow-write NODE";
    }
    if (need == RuleNeed::Security && endpoint_.security_mode == MessageSecurityMode::None) {
        return "the session has no security";
    }
    if (need == RuleNeed::OpenChannel && !open_refusal_) {
        open_refusal_.emplace();
        try {
            open_channel().close();
        } catch (const NoAnswer& none) {
            *open_refusal_ =
                "a channel without security is refused: " + std::string{name(none.status)};
        }
    }
    return need == RuleNeed::OpenChannel ? *open_refusal_ : std::string{};
}

Line& Subject::session()
{
    if (!has_session()) {
        session_.reset();
        try {
            session_.emplace(config_, *environment_, limit_);
        } catch (const NoAnswer& none) {
            throw Unreachable{none.status};
        }
    }
    return *session_;
}

Line Subject::other_session()
{
    return Line{config_, *environment_, limit_};
}

Line Subject::channel()
{
    client::ConnectionConfig config = config_;
    config.wants_session = false;
    return Line{config, *environment_, limit_};
}

Line Subject::open_channel()
{
    client::ConnectionConfig config = config_;
    config.wants_session = false;
    config.channel.security = {};
    return Line{config, *environment_, limit_};
}

} // namespace busbar::tool::rules
