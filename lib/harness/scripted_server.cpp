#include <busbar/harness/scripted_server.hpp>

#include <algorithm>
#include <utility>

#include <busbar/crypto/security_policy.hpp>
#include <busbar/types/session.hpp>

#include "dissector.hpp"

namespace busbar::harness {

namespace {

constexpr std::size_t max_unexpected = 100;
constexpr std::size_t max_came = 10'000;

/// Every request begins with its header (Part 4, 7.32).
Result<std::vector<std::byte>> make_fault(std::span<const std::byte> request, StatusCode status,
                                          DateTime now)
{
    binary::Reader reader{request};
    NodeId id;
    RequestHeader header;
    decode(reader, id);
    decode(reader, header);
    ServiceFault fault;
    fault.response_header.timestamp = now;
    fault.response_header.request_handle = header.request_handle;
    fault.response_header.service_result = status;
    return detail::encode_body(fault);
}

} // namespace

/// The server's end of one connection.
class ScriptedServer::Peer final : public LinkEnd {
public:
    Peer(ScriptedServer& server, channel::ServerChannelConfig config,
         const channel::ChannelEnvironment& environment, std::shared_ptr<Link> link)
        : server_{server}, link_{std::move(link)}, channel_{std::move(config), environment,
                                                            server.world_.now()},
          deadline_{scheduler(),
                    [this] {
                        channel_.handle_deadline(scheduler().now());
                        update();
                    }},
          answers_{scheduler(), [this] { answer_due(); }}
    {
        deadline_.set(channel_.next_deadline());
    }
    ~Peer() override
    {
        if (link_ != nullptr) {
            link_->leave(Side::Server);
        }
    }

    [[nodiscard]] bool has_ended() const { return link_ == nullptr; }
    [[nodiscard]] std::span<const std::byte> output() const override { return channel_.output(); }
    void consume(std::size_t size) override { channel_.consume(size); }
    void feed(std::span<const std::byte> in) override
    {
        static_cast<void>(channel_.feed(in, scheduler().now()));
        update();
    }
    void link_lost() override
    {
        link_.reset();
        deadline_.cancel();
        answers_.cancel();
    }

private:
    struct Due {
        TimePoint time;
        std::uint32_t request_id{0};
        std::vector<std::byte> body;
        std::optional<StatusCode> end;
    };

    [[nodiscard]] Scheduler& scheduler() const { return server_.world_.scheduler(); }
    void update()
    {
        while (auto event = channel_.next_event()) {
            if (event->kind == channel::ChannelEvent::Kind::Message) {
                handle(event->request_id, event->body);
            }
        }
        answer_due();
    }
    void handle(std::uint32_t request_id, std::span<const std::byte> request)
    {
        const DateTime now = server_.world_.clock().now();
        const auto step = server_.take_step(request);
        Due due{scheduler().now(), request_id, {}, {}};
        if (!step) {
            due.body = make_fault(request, status::Bad_ServiceUnsupported, now).value_or(due.body);
        } else {
            due.time += step->delay;
            due.end = step->end;
            if (step->answer) {
                server_.channel_ = &channel_;
                auto body = step->answer(request, now);
                server_.channel_ = nullptr;
                due.body = body ? *std::move(body)
                                : make_fault(request, body.error(), now).value_or(due.body);
            }
        }
        const auto place = std::upper_bound(
            due_.begin(), due_.end(), due.time,
            [](TimePoint time, const Due& other_due) { return time < other_due.time; });
        due_.insert(place, std::move(due));
    }
    void answer_due()
    {
        while (!due_.empty() && due_.front().time <= scheduler().now() && link_ != nullptr) {
            const Due due = std::move(due_.front());
            due_.pop_front();
            answer(due);
        }
        if (link_ == nullptr) {
            return;
        }
        link_->flush(Side::Server);
        if (channel_.is_closed()) {
            std::exchange(link_, nullptr)->close(Side::Server);
            deadline_.cancel();
            return;
        }
        deadline_.set(channel_.next_deadline());
        answers_.set(due_.empty() ? no_deadline : due_.front().time);
    }
    void answer(const Due& due)
    {
        if (!due.body.empty()) {
            static_cast<void>(channel_.send(due.request_id, [&](binary::Writer& writer) { //
                writer.bytes(due.body);
            }));
        }
        if (!due.end) {
            return;
        }
        if (due.end->is_bad()) {
            channel_.close(*due.end, "as the script says");
        } else {
            link_->cut(); // both ends are notified
        }
    }

    ScriptedServer& server_;
    std::shared_ptr<Link> link_;
    channel::ServerChannel channel_;
    std::deque<Due> due_;
    Alarm deadline_;
    Alarm answers_;
};

ScriptedServer::ScriptedServer(World& world, std::string_view url, const ScriptedServerParts& parts)
    : world_{world}, url_{url}, parts_{parts}, log_{world.new_log(Actor::Server)},
      random_{world.new_chance(Actor::Server).next()}
{
    if (!world.network().listen(url, *this)) {
        unexpected_.emplace_back("the URL is none: " + url_);
    }
}

ScriptedServer::~ScriptedServer()
{
    world_.network().unlisten(*this);
}

detail::ScriptStep& ScriptedServer::add(detail::ScriptStep& step, std::uint32_t encoding_id)
{
    step.encoding_id = encoding_id;
    step.name = detail::encoding_name(NodeId{0, encoding_id});
    return step;
}

void ScriptedServer::accept_session()
{
    expect<CreateSessionRequest>().reply([](const CreateSessionRequest& request) {
        CreateSessionResponse response;
        response.session_id = NodeId{1, 1U};
        response.authentication_token = NodeId{1, 2U};
        response.revised_session_timeout = request.requested_session_timeout;
        response.server_nonce = ByteString{std::vector<std::byte>(32, std::byte{1})};
        EndpointDescription& endpoint = response.server_endpoints.emplace_back();
        endpoint.endpoint_url = request.endpoint_url;
        endpoint.security_mode = MessageSecurityMode::None;
        endpoint.security_policy_uri = String{crypto::policy_none().uri};
        endpoint.transport_profile_uri =
            "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
        UserTokenPolicy& policy = endpoint.user_identity_tokens.emplace_back();
        policy.policy_id = "anonymous";
        policy.token_type = UserTokenType::Anonymous;
        response.max_request_message_size = 0;
        return response;
    });
    ActivateSessionResponse activated;
    activated.server_nonce = ByteString{std::vector<std::byte>(32, std::byte{2})};
    expect<ActivateSessionRequest>().reply(std::move(activated));
}

bool ScriptedServer::accept(const std::shared_ptr<Link>& link, std::string_view /*peer_address*/)
{
    peers_.erase(std::remove_if(peers_.begin(), peers_.end(),
                                [](const auto& peer) { return peer->has_ended(); }),
                 peers_.end());
    channel::ServerChannelConfig config;
    config.allowed = parts_.allowed;
    config.channel_id = ++last_channel_id_;
    const channel::ChannelEnvironment environment{
        .random = &random_,
        .wall_clock = &world_.clock(),
        .log = &log_,
        .validator = parts_.validator != nullptr ? parts_.validator : &accept_any_,
        .identity = parts_.identity};
    peers_.push_back(std::make_unique<Peer>(*this, std::move(config), environment, link));
    link->attach(Side::Server, *peers_.back());
    return true;
}

std::optional<detail::ScriptStep> ScriptedServer::take_step(std::span<const std::byte> body)
{
    const NodeId id = detail::encoding_of(body);
    if (came_.size() < max_came) {
        came_.push_back(detail::encoding_name(id));
    }
    if (!steps_.empty() && id.is(steps_.front().encoding_id)) {
        auto step = std::move(steps_.front());
        steps_.pop_front();
        return step;
    }
    const auto found =
        std::find_if(allowed_.begin(), allowed_.end(),
                     [&](const detail::ScriptStep& step) { return id.is(step.encoding_id); });
    if (found != allowed_.end()) {
        return *found;
    }
    if (unexpected_.size() < max_unexpected) {
        const std::string expected = steps_.empty() ? "nothing more" : steps_.front().name;
        const auto time = std::chrono::duration<double>{world_.now().time_since_epoch()};
        unexpected_.push_back("expected " + expected + ", came " + detail::encoding_name(id) +
                              " at " + std::to_string(time.count()) + " s");
    }
    return std::nullopt;
}

std::string ScriptedServer::report() const
{
    std::string text;
    for (const std::string& line : unexpected_) {
        text += line + "\n";
    }
    for (const detail::ScriptStep& step : steps_) {
        text += "expected " + step.name + ", came nothing\n";
    }
    return text;
}

} // namespace busbar::harness
