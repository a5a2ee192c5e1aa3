#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <busbar/binary/type_registry.hpp>
#include <busbar/channel/server_channel.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/session.hpp>

#include "support/channel_pair.hpp"

namespace busbar::test {

/// What a rogue server may change of its honest answers; empty functions change nothing.
struct RogueAnswers {
    std::function<void(GetEndpointsResponse&)> endpoints;
    std::function<void(CreateSessionResponse&)> created;
    std::function<void(ActivateSessionResponse&)> activated;
    std::function<void(const ReadRequest&, ReadResponse&)> read;
    /// Asked first, with the NodeId of the request's encoding: the body of the answer, an empty one
    /// for no answer at all.
    std::function<std::optional<std::vector<std::byte>>(const NodeId& request)> raw;
    /// Asked for services that the server knows nothing of, with what follows the NodeId: the body
    /// of the answer, an empty one for no answer now.
    std::function<std::optional<std::vector<std::byte>>(const NodeId& request, binary::Reader&)>
        other;
    /// Changes any body before it is sent.
    std::function<void(std::vector<std::byte>&)> body;
    /// What OpenSecureChannel allows.
    std::vector<channel::SecuritySetting> security{{}};
};

/// A message body: the structure behind the NodeId of its encoding.
template <typename T>
[[nodiscard]] std::vector<std::byte> body_of(const T& structure)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, NodeId{0, T::binary_encoding_id});
    encode(writer, structure);
    return sink.take(writer.written());
}
[[nodiscard]] inline std::vector<std::byte> fault(StatusCode status)
{
    ServiceFault fault;
    fault.response_header.service_result = status;
    return body_of(fault);
}

/// One connection of a server that knows just enough to have a session, and lies as it is told.
/// `answers` must outlive it.
class RogueServer {
public:
    RogueServer(const RogueAnswers& answers, const channel::ChannelEnvironment& environment,
                TimePoint now)
        : answers_{&answers}, environment_{environment}, channel_{config(answers), environment, now}
    {
    }

    Result<void> feed(std::span<const std::byte> in, TimePoint now)
    {
        auto fed = channel_.feed(in, now);
        while (auto event = channel_.next_event()) {
            if (event->kind == channel::ChannelEvent::Kind::Message) {
                answer(*event);
            }
        }
        return fed;
    }
    [[nodiscard]] std::span<const std::byte> output() const { return channel_.output(); }
    void consume(std::size_t size) { channel_.consume(size); }
    [[nodiscard]] bool is_closed() const { return channel_.is_closed(); }

    /// Sends a body as the answer to any request.
    void send(std::uint32_t request_id, std::span<const std::byte> body)
    {
        static_cast<void>(
            channel_.send(request_id, [&](binary::Writer& writer) { writer.bytes(body); }));
        answered.push_back(request_id);
    }

    /// The ids of requests that were answered.
    std::vector<std::uint32_t> answered;
    /// Of those that `other` had no answer for yet.
    std::deque<std::uint32_t> unanswered;
    /// The NodeIds of the encodings of all requests.
    std::vector<NodeId> requests;

private:
    [[nodiscard]] static channel::ServerChannelConfig config(const RogueAnswers& answers)
    {
        channel::ServerChannelConfig config;
        config.allowed = answers.security;
        config.channel_id = 5;
        return config;
    }
    void answer(const channel::ChannelEvent& event)
    {
        static const binary::TypeRegistry types{binary::namespace0_types()};
        binary::Reader reader{event.body, binary::Strings::Own, &types};
        NodeId id;
        decode(reader, id);
        requests.push_back(id);
        if (answers_->raw) {
            if (const auto body = answers_->raw(id)) {
                return body->empty() ? void() : send(event.request_id, *body);
            }
        }
        auto body = honest(id, reader);
        if (body.empty()) {
            unanswered.push_back(event.request_id);
            return;
        }
        if (answers_->body) {
            answers_->body(body);
        }
        send(event.request_id, body);
    }
    [[nodiscard]] std::vector<std::byte> honest(const NodeId& id, binary::Reader& reader)
    {
        if (id.is(GetEndpointsRequest::binary_encoding_id)) {
            GetEndpointsResponse response;
            response.endpoints = endpoints();
            return changed(response, answers_->endpoints);
        }
        if (id.is(CreateSessionRequest::binary_encoding_id)) {
            CreateSessionRequest request;
            decode(reader, request);
            return changed(created(request), answers_->created);
        }
        if (id.is(ActivateSessionRequest::binary_encoding_id)) {
            ActivateSessionResponse response;
            response.server_nonce = nonce();
            return changed(response, answers_->activated);
        }
        if (id.is(ReadRequest::binary_encoding_id)) {
            ReadRequest request;
            decode(reader, request);
            ReadResponse response;
            response.results.resize(request.nodes_to_read.size());
            if (answers_->read) {
                answers_->read(request, response);
            }
            return body_of(response);
        }
        if (answers_->other) {
            if (auto body = answers_->other(id, reader)) {
                return *std::move(body);
            }
        }
        return fault(status::Bad_ServiceUnsupported);
    }
    template <typename Response, typename Change>
    [[nodiscard]] static std::vector<std::byte> changed(Response response, const Change& change)
    {
        if (change) {
            change(response);
        }
        return body_of(response);
    }
    [[nodiscard]] Array<EndpointDescription> endpoints() const
    {
        Array<EndpointDescription> all;
        for (const channel::SecuritySetting& security : answers_->security) {
            EndpointDescription& endpoint = all.emplace_back();
            endpoint.endpoint_url = "opc.tcp://localhost:4840";
            endpoint.server.application_uri = "urn:busbar:test:server";
            endpoint.server_certificate = certificate();
            endpoint.security_mode = security.mode;
            endpoint.security_policy_uri = security.policy->uri;
            UserTokenPolicy& policy = endpoint.user_identity_tokens.emplace_back();
            policy.policy_id = "anonymous";
            policy.token_type = UserTokenType::Anonymous;
            endpoint.transport_profile_uri =
                "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
        }
        return all;
    }
    [[nodiscard]] CreateSessionResponse created(const CreateSessionRequest& request)
    {
        CreateSessionResponse response;
        response.session_id = NodeId{1, 1};
        response.authentication_token = NodeId{1, 2};
        response.revised_session_timeout = request.requested_session_timeout;
        response.server_nonce = nonce();
        response.server_certificate = certificate();
        response.server_endpoints = endpoints();
        const auto& policy = *channel_.security().policy;
        if (!policy.is_none()) {
            std::vector<std::byte> text{request.client_certificate.span().begin(),
                                        request.client_certificate.span().end()};
            text.insert(text.end(), request.client_nonce.span().begin(),
                        request.client_nonce.span().end());
            response.server_signature.signature = ByteString{
                crypto::asymmetric_sign(policy, environment_.identity->key, text).value()};
        }
        return response;
    }
    [[nodiscard]] ByteString certificate() const
    {
        return environment_.identity != nullptr
                   ? ByteString{environment_.identity->certificates.front().der()}
                   : ByteString{};
    }
    [[nodiscard]] ByteString nonce() const
    {
        std::vector<std::byte> bytes(32);
        static_cast<void>(environment_.random->fill(bytes));
        return ByteString{bytes};
    }

    const RogueAnswers* answers_;
    channel::ChannelEnvironment environment_;
    channel::ServerChannel channel_;
};

} // namespace busbar::test
