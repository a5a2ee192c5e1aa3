#include <busbar/harness/scripted_client.hpp>

#include <utility>

#include "chunks.hpp"
#include "dissector.hpp"
#include "session_proof.hpp"

namespace busbar::harness {

ScriptedClient::ScriptedClient(World& world, channel::ClientChannelConfig config,
                               const ClientParts& parts)
    : world_{world}, config_{std::move(config)}, parts_{parts}, log_{world.new_log(Actor::Client)},
      random_{world.new_chance(Actor::Client).next()},
      chunks_{std::make_unique<detail::WrongChunks>(world.network().chunk_hook())},
      deadline_{world.scheduler(), [this] {
                    channel_->handle_deadline(world_.now());
                    update();
                }}
{
}

ScriptedClient::~ScriptedClient()
{
    if (link_ != nullptr) {
        link_->leave(Side::Client);
    }
}

Result<void> ScriptedClient::connect()
{
    if (link_ != nullptr) {
        std::exchange(link_, nullptr)->leave(Side::Client);
    }
    deadline_.cancel();
    raw_.clear();
    channel_.reset();
    is_open_ = false;
    closed_by_.reset();
    messages_.clear();
    received_.clear();
    authentication_token_ = {};
    auto link = world_.network().connect(config_.endpoint_url, *this, parts_.address);
    if (!link) {
        return fail(link.error());
    }
    link_ = *std::move(link);
    return {};
}

Result<void> ScriptedClient::dial()
{
    return connect();
}

Result<void> ScriptedClient::open(Duration limit)
{
    if (auto connected = connect(); !connected) {
        return connected;
    }
    const channel::ChannelEnvironment environment{
        .random = &random_,
        .wall_clock = &world_.clock(),
        .log = &log_,
        .validator = parts_.validator != nullptr ? parts_.validator : &accept_any_,
        .identity = parts_.identity,
        .key_log = parts_.key_log,
        .chunk_hook = chunks_.get()};
    channel_.emplace(config_, environment, world_.now());
    update();
    if (!world_.run_until([this] { return is_open_ || closed_by_; }, limit)) {
        return fail(status::Bad_Timeout);
    }
    if (!is_open_) {
        return fail(closed_by_->is_bad() ? *closed_by_ : status::Bad_ConnectionClosed);
    }
    return {};
}

std::uint32_t ScriptedClient::token_id() const
{
    return chunks_->token_id();
}

Result<void> ScriptedClient::open_session(Duration limit)
{
    if (!is_open_) {
        return fail(status::Bad_NotConnected);
    }
    authentication_token_ = {};
    CreateSessionRequest create;
    create.endpoint_url = String{config_.endpoint_url};
    create.session_name = "scripted";
    create.client_description.application_uri = String{parts_.application_uri};
    create.client_description.application_type = ApplicationType::Client;
    create.requested_session_timeout = 60'000;
    create.client_nonce = detail::new_nonce(random_);
    if (parts_.identity != nullptr) {
        create.client_certificate = ByteString{parts_.identity->certificates.front().der()};
    }
    if (auto sent = send(create); !sent) {
        return fail(sent.error());
    }
    const auto created = expect<CreateSessionResponse>(limit);
    if (!created) {
        return fail(created.error());
    }
    authentication_token_ = created->authentication_token;
    auto signature =
        detail::sign_nonce(config_.security, parts_.identity, created->server_certificate.span(),
                           created->server_nonce.span());
    if (!signature) {
        return fail(signature.error());
    }
    ActivateSessionRequest activate;
    activate.client_signature = *std::move(signature);
    AnonymousIdentityToken anonymous;
    anonymous.policy_id = detail::anonymous_policy(created->server_endpoints, config_.security);
    activate.user_identity_token = ExtensionObject::from(anonymous);
    if (auto sent = send(activate); !sent) {
        return fail(sent.error());
    }
    const auto activated = expect<ActivateSessionResponse>(limit);
    return activated ? Result<void>{} : fail(activated.error());
}

std::span<const std::byte> ScriptedClient::output() const
{
    return !raw_.empty() || !channel_ ? std::span<const std::byte>{raw_} : channel_->output();
}

void ScriptedClient::consume(std::size_t size)
{
    if (raw_.empty()) {
        channel_->consume(size);
    } else {
        raw_.erase(raw_.begin(), raw_.begin() + static_cast<std::ptrdiff_t>(size));
    }
}

void ScriptedClient::feed(std::span<const std::byte> in)
{
    if (!channel_) {
        received_.insert(received_.end(), in.begin(), in.end());
        return;
    }
    static_cast<void>(channel_->feed(in, world_.now()));
    update();
}

void ScriptedClient::link_lost()
{
    link_.reset();
    deadline_.cancel();
    if (!closed_by_) {
        closed_by_ = StatusCode{};
    }
}

void ScriptedClient::update()
{
    while (auto event = channel_->next_event()) {
        switch (event->kind) {
        case channel::ChannelEvent::Kind::Opened:
            is_open_ = true;
            break;
        case channel::ChannelEvent::Kind::Message:
            messages_.push_back(std::move(event->body));
            break;
        case channel::ChannelEvent::Kind::Closed:
            closed_by_ = event->status;
            break;
        default:
            break;
        }
    }
    if (link_ == nullptr) {
        return;
    }
    link_->flush(Side::Client);
    if (channel_->is_closed()) {
        std::exchange(link_, nullptr)->close(Side::Client);
        deadline_.cancel();
    } else {
        deadline_.set(channel_->next_deadline());
    }
}

Result<std::uint32_t> ScriptedClient::send_body(std::span<const std::byte> body, const Wrong& wrong)
{
    if (link_ == nullptr || !channel_) {
        return fail(status::Bad_NotConnected);
    }
    std::uint32_t id = 0;
    const auto sent = chunks_->send(wrong, body, [&](auto encode) -> Result<void> {
        const auto one = channel_->send(encode);
        if (!one) {
            return fail(one.error());
        }
        id = *one;
        return {};
    });
    update();
    return sent ? Result<std::uint32_t>{id} : fail(sent.error());
}

void ScriptedClient::send_bytes(std::span<const std::byte> bytes)
{
    if (link_ != nullptr && !bytes.empty()) {
        link_->flush(Side::Client);
        raw_.assign(bytes.begin(), bytes.end());
        link_->flush(Side::Client);
    }
}

Result<std::vector<std::byte>> ScriptedClient::await(std::uint32_t encoding_id, Duration limit)
{
    const std::string expected = "expected " + detail::encoding_name(NodeId{0, encoding_id});
    if (!world_.run_until([this] { return !messages_.empty() || closed_by_; }, limit)) {
        report_ += expected + ", came nothing\n";
        return fail(status::Bad_Timeout);
    }
    if (messages_.empty()) {
        report_ += expected + ", came the end " + std::string{name(*closed_by_)} + "\n";
        return fail(closed_by_->is_bad() ? *closed_by_ : status::Bad_ConnectionClosed);
    }
    auto body = std::move(messages_.front());
    messages_.pop_front();
    const NodeId id = detail::encoding_of(body);
    if (id.is(encoding_id)) {
        return body;
    }
    StatusCode why = status::Bad_UnknownResponse;
    if (const auto fault = decode_body<ServiceFault>(body)) {
        why = fault->response_header.service_result;
    }
    report_ +=
        expected + ", came " + detail::encoding_name(id) + " " + std::string{name(why)} + "\n";
    return fail(why);
}

Result<StatusCode> ScriptedClient::expect_close(Duration limit)
{
    if (!world_.run_until([this] { return closed_by_.has_value(); }, limit)) {
        report_ += "expected the end, which did not come\n";
        return fail(status::Bad_Timeout);
    }
    return *closed_by_;
}

} // namespace busbar::harness
