#include <busbar/crypto/asymmetric.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>

#include "requests.hpp"

namespace busbar::tool::rules {

namespace {
namespace sessions {

ByteString random_bytes(const Subject& subject, std::size_t size)
{
    std::vector<std::byte> bytes(size);
    static_cast<void>(subject.environment().random->fill(bytes));
    return ByteString{bytes};
}

bool is_secure(const Subject& subject)
{
    return !subject.config().channel.security.policy->is_none();
}

CreateSessionRequest create_of(const Subject& subject)
{
    CreateSessionRequest request;
    request.client_description.application_uri = subject.config().application_uri;
    request.client_description.application_type = ApplicationType::Client;
    request.endpoint_url = subject.config().channel.endpoint_url;
    request.session_name = "busbar check";
    request.client_nonce = random_bytes(subject, 32);
    request.requested_session_timeout = 60'000;
    if (is_secure(subject)) {
        request.client_certificate =
            ByteString{subject.environment().identity->certificates.front().der()};
    }
    return request;
}

/// A session that is created and not activated, on a connection of its own.
struct Created {
    explicit Created(Subject& server) : Created{server, create_of(server)} {}
    Created(Subject& server, CreateSessionRequest request)
        : subject{&server}, line{server.channel()}
    {
        auto created = line.ask<CreateSessionResponse>(std::move(request));
        if (!created) {
            throw Refused{created.error(), "CreateSession"};
        }
        response = *std::move(created);
    }
    Created(const Created&) = delete;
    Created& operator=(const Created&) = delete;
    /// Leaves no session behind.
    ~Created()
    {
        try {
            static_cast<void>(close());
            line.close();
        } catch (const NoAnswer&) {
            // It is closed already.
        }
    }

    [[nodiscard]] Line::Change as_session() const
    {
        return [this](RequestHeader& header) {
            header.authentication_token = response.authentication_token;
        };
    }
    [[nodiscard]] Result<CloseSessionResponse> close()
    {
        CloseSessionRequest request;
        request.delete_subscriptions = true;
        return line.ask<CloseSessionResponse>(request, as_session());
    }
    /// An activation with our signature.
    [[nodiscard]] ActivateSessionRequest activation() const
    {
        ActivateSessionRequest request;
        const channel::ClientChannelConfig& channel = subject->config().channel;
        if (!channel.security.policy->is_none()) {
            const auto certificate = channel.server_certificate->der();
            std::vector<std::byte> data{certificate.begin(), certificate.end()};
            const auto nonce = response.server_nonce.span();
            data.insert(data.end(), nonce.begin(), nonce.end());
            if (const auto signature = crypto::asymmetric_sign(
                    *channel.security.policy, subject->environment().identity->key, data)) {
                request.client_signature.algorithm = String{channel.security.policy->signature_uri};
                request.client_signature.signature = ByteString{*signature};
            }
        }
        return request;
    }
    [[nodiscard]] Answer activate(ActivateSessionRequest request)
    {
        return service_result(line.ask<ActivateSessionResponse>(std::move(request), as_session()));
    }

    Subject* subject;
    Line line;
    CreateSessionResponse response;
};

ReadRequest some_read()
{
    ReadRequest request;
    request.nodes_to_read = {client::attribute_of(some_scalar())};
    return request;
}

/// The result of a Read with this authentication token.
Answer read_with(Line& line, NodeId token)
{
    return service_result(line.ask<ReadResponse>(
        some_read(), [&](RequestHeader& header) { header.authentication_token = token; }));
}

Answer read_with_token(Subject& subject, NodeId token)
{
    Line line = subject.channel();
    Answer answer = read_with(line, std::move(token));
    line.close();
    return answer;
}

Answer timeout(Subject& subject, double asked)
{
    CreateSessionRequest request = create_of(subject);
    request.requested_session_timeout = asked;
    const Created session{subject, std::move(request)};
    return expect(session.response.revised_session_timeout > 0,
                  std::to_string(session.response.revised_session_timeout));
}

Answer different_tokens(Subject& subject)
{
    const Created one{subject};
    const Created other{subject};
    return expect(!(one.response.authentication_token == other.response.authentication_token) &&
                      !(one.response.session_id == other.response.session_id),
                  "the same for both");
}

Answer server_nonce(Subject& subject)
{
    const Created session{subject};
    const std::size_t size = session.response.server_nonce.size();
    return expect(size >= 32 && size <= 128, std::to_string(size) + " bytes");
}

Answer same_endpoints(Subject& subject)
{
    const Created session{subject};
    GetEndpointsRequest request;
    request.endpoint_url = subject.config().channel.endpoint_url;
    Line line = subject.channel();
    const auto found = line.ask<GetEndpointsResponse>(std::move(request));
    line.close();
    return with(found, [&](const GetEndpointsResponse& response) {
        return expect(client::check_endpoints(response.endpoints, session.response.server_endpoints)
                          .has_value(),
                      "other endpoints");
    });
}

Answer nonce_of(Subject& subject, std::size_t size)
{
    CreateSessionRequest request = create_of(subject);
    request.client_nonce = random_bytes(subject, size);
    Line line = subject.channel();
    Answer answer = service_result(line.ask<CreateSessionResponse>(std::move(request)));
    line.close();
    return answer;
}

Answer with_token(Subject& subject, ExtensionObject token)
{
    Created session{subject};
    ActivateSessionRequest request = session.activation();
    request.user_identity_token = std::move(token);
    return session.activate(std::move(request));
}

Answer stranger(Subject& subject)
{
    for (const UserTokenPolicy& policy : subject.endpoint().user_identity_tokens) {
        if (policy.token_type == UserTokenType::UserName) {
            UserNameIdentityToken token;
            token.policy_id = policy.policy_id;
            token.user_name = "busbar check, no such user";
            return with_token(subject, ExtensionObject::from(std::move(token)));
        }
    }
    return not_applicable("the endpoint has no user names");
}

Answer wrong_signature(Subject& subject)
{
    Created session{subject};
    ActivateSessionRequest request = session.activation();
    request.client_signature.signature =
        random_bytes(subject, request.client_signature.signature.size());
    return session.activate(std::move(request));
}

Answer unknown_session(Subject& subject)
{
    Created session{subject};
    session.response.authentication_token = unknown_node();
    return session.activate(session.activation());
}

Answer before_activation(Subject& subject)
{
    Created session{subject};
    return read_with(session.line, session.response.authentication_token);
}

Answer closed_after_early_use(Subject& subject)
{
    Created session{subject};
    static_cast<void>(read_with(session.line, session.response.authentication_token));
    return session.activate(session.activation());
}

Answer after_close(Subject& subject)
{
    Created session{subject};
    static_cast<void>(session.close());
    return read_with(session.line, session.response.authentication_token);
}

Answer closed_twice(Subject& subject)
{
    Created session{subject};
    static_cast<void>(session.close());
    return service_result(session.close());
}

Answer of_other_channel(Subject& subject)
{
    Line owner = subject.other_session();
    Answer answer = read_with_token(subject, owner.client().session().authentication_token);
    owner.close();
    return answer;
}

Answer close_of_other_channel(Subject& subject)
{
    Line owner = subject.other_session();
    const NodeId token = owner.client().session().authentication_token;
    Line line = subject.channel();
    Answer answer = service_result(
        line.ask<CloseSessionResponse>(CloseSessionRequest{}, [&](RequestHeader& header) {
            header.authentication_token = token;
        }));
    line.close();
    owner.close();
    return answer;
}

Answer cancelled_nothing(Subject& subject)
{
    CancelRequest request;
    request.request_handle = 0xFFFF'FFF0U;
    return with(subject.ask<CancelResponse>(request), [](const CancelResponse& response) {
        return expect(response.cancel_count == 0, std::to_string(response.cancel_count));
    });
}

/// Cancels a Publish that waits; `judge` gets the response and the line with the Publish.
template <typename Judge>
Answer cancelled_publish(Subject& subject, Judge judge)
{
    constexpr std::uint32_t handle = 4'711'000;
    Line line = subject.other_session();
    CreateSubscriptionRequest create;
    create.requested_publishing_interval = 60'000;
    create.requested_max_keep_alive_count = 100;
    create.requested_lifetime_count = 1'000;
    if (const auto created = line.ask<CreateSubscriptionResponse>(create); !created) {
        throw Refused{created.error(), "CreateSubscription"};
    }
    const std::uint32_t publish =
        line.send(PublishRequest{}, [](RequestHeader& header) { header.request_handle = handle; });
    CancelRequest request;
    request.request_handle = handle;
    const auto response = line.ask<CancelResponse>(request);
    Answer answer = response ? judge(*response, line, publish) : came(response.error());
    line.close();
    return answer;
}

Answer header(Subject& subject)
{
    constexpr std::uint32_t handle = 4'711'001;
    const auto response = subject.ask<ReadResponse>(
        some_read(), [](RequestHeader& request) { request.request_handle = handle; });
    return with(response, [](const ReadResponse& read) {
        return expect(read.response_header.request_handle == handle,
                      std::to_string(read.response_header.request_handle));
    });
}

Answer fault_header(Subject& subject)
{
    constexpr std::uint32_t handle = 4'711'002;
    Line& line = subject.session();
    const std::uint32_t sent =
        line.send(ReadRequest{}, [](RequestHeader& request) { request.request_handle = handle; });
    const auto fault = line.fault_of(sent);
    return fault ? expect(fault->response_header.request_handle == handle,
                          std::to_string(fault->response_header.request_handle))
                 : wrong("no ServiceFault");
}

Answer time_of_response(Subject& subject)
{
    return with(subject.ask<ReadResponse>(some_read()), [](const ReadResponse& response) {
        return expect(response.response_header.timestamp != DateTime{}, "no time");
    });
}

Answer unknown_additional_header(Subject& subject)
{
    return service_result(subject.ask<ReadResponse>(some_read(), [](RequestHeader& request) {
        constexpr std::array<std::byte, 3> bytes{};
        request.additional_header =
            ExtensionObject::from_binary(standard(0x7FFF'FFF0U), ByteString{bytes});
    }));
}

constexpr Wanted no_session{status::Bad_SessionIdInvalid};
constexpr Wanted no_identity{status::Bad_IdentityTokenInvalid, status::Bad_IdentityTokenRejected};
constexpr const char* creating = "Part 4, 5.7.2.2";
constexpr const char* activating = "Part 4, 5.7.3.3";

const SpecRule rules[] = {
    {"session-timeout-zero", "CreateSession", "A timeout of 0 is revised",
     "requestedSessionTimeout = 0", "a revisedSessionTimeout above 0", creating,
     [](Subject& subject) { return timeout(subject, 0); }},
    {"session-timeout-negative", "CreateSession", "A negative timeout is revised",
     "requestedSessionTimeout = -1", "a revisedSessionTimeout above 0", creating,
     [](Subject& subject) { return timeout(subject, -1); }},
    {"session-tokens", "CreateSession", "Each session has ids of its own", "two sessions",
     "two sessionIds and authenticationTokens", creating, different_tokens},
    {"session-server-nonce", "CreateSession", "The server's nonce has 32 to 128 bytes", "any",
     "32 to 128 bytes", creating, server_nonce, RuleNeed::Security},
    {"session-endpoints", "CreateSession", "The endpoints are those of GetEndpoints", "any",
     "the same endpoints", "Part 4, 5.7.2.2", same_endpoints},
    {"session-nonce-short", "CreateSession", "A client's nonce of less than 32 bytes is refused",
     "clientNonce = 8 bytes", status::Bad_NonceInvalid, "Part 4, 5.7.2.3",
     [](Subject& subject) { return nonce_of(subject, 8); }, RuleNeed::Security},
    {"session-nonce-long", "CreateSession", "A client's nonce of more than 128 bytes is refused",
     "clientNonce = 200 bytes", status::Bad_NonceInvalid, "Part 4, 5.7.2.3",
     [](Subject& subject) { return nonce_of(subject, 200); }, RuleNeed::Security},
    {"activate-unknown", "ActivateSession", "A session that is not there is refused",
     "authenticationToken = a NodeId that does not exist", no_session, activating, unknown_session},
    {"activate-policy-unknown", "ActivateSession", "A token policy that is not there is refused",
     "AnonymousIdentityToken, policyId = \"no such policy\"", no_identity, activating,
     [](Subject& subject) {
         AnonymousIdentityToken token;
         token.policy_id = "no such policy";
         return with_token(subject, ExtensionObject::from(std::move(token)));
     }},
    {"activate-token-type", "ActivateSession", "A token of an unknown type is refused",
     "userIdentityToken = a structure that is not a token", no_identity, activating,
     [](Subject& subject) { return with_token(subject, ExtensionObject::from(ReadValueId{})); }},
    {"activate-stranger", "ActivateSession", "A user that does not exist is refused",
     "UserNameIdentityToken without a password",
     one_of(status::Bad_UserAccessDenied, status::Bad_IdentityTokenRejected,
            status::Bad_IdentityTokenInvalid),
     activating, stranger},
    {"activate-signature", "ActivateSession", "A wrong signature is refused",
     "clientSignature = random bytes",
     one_of(status::Bad_ApplicationSignatureInvalid, status::Bad_SecurityChecksFailed), activating,
     wrong_signature, RuleNeed::Security},
    {"session-not-activated", "Read", "A session is activated before it is used",
     "a Read in a session that is not activated", status::Bad_SessionNotActivated,
     "Part 4, 5.7.2.1", before_activation},
    {"session-used-early", "ActivateSession", "A session that is used too early is closed",
     "a Read before the activation",
     one_of(status::Bad_SessionIdInvalid, status::Bad_SessionClosed), "Part 4, 5.7.3.1",
     closed_after_early_use},
    {"session-token-null", "Read", "A Read needs a session", "authenticationToken = null",
     one_of(status::Bad_SessionIdInvalid, status::Bad_ServiceUnsupported), "Part 4, 7.32",
     [](Subject& subject) { return read_with_token(subject, NodeId{}); }},
    {"session-token-unknown", "Read", "A session that is not there is refused",
     "authenticationToken = a NodeId that does not exist", no_session, "Part 4, 7.32",
     [](Subject& subject) { return read_with_token(subject, unknown_node()); }},
    {"session-other-channel", "Read", "A session belongs to its channel",
     "the authenticationToken of another channel's session",
     one_of(status::Bad_SecureChannelIdInvalid, status::Bad_SessionIdInvalid), "Part 4, 5.7.2.1",
     of_other_channel},
    {"close-other-channel", "CloseSession", "A session is closed by its channel",
     "the authenticationToken of another channel's session",
     one_of(status::Bad_SecureChannelIdInvalid, status::Bad_SessionIdInvalid), "Part 4, 5.7.2.1",
     close_of_other_channel},
    {"close-then-use", "CloseSession", "A closed session is not there", "a Read after CloseSession",
     one_of(status::Bad_SessionIdInvalid, status::Bad_SessionClosed), "Part 4, 5.7.4.1",
     after_close},
    {"close-twice", "CloseSession", "A closed session cannot be closed", "CloseSession twice",
     one_of(status::Bad_SessionIdInvalid, status::Bad_SessionClosed), "Part 4, 5.7.4.3",
     closed_twice},
    {"cancel-nothing", "Cancel", "What is not under way is not cancelled",
     "requestHandle = 4294967280", "cancelCount = 0", "Part 4, 5.7.5.2", cancelled_nothing},
    {"cancel-count", "Cancel", "A Publish that waits is cancelled", "its requestHandle",
     "cancelCount = 1", "Part 4, 5.7.5.2",
     [](Subject& subject) {
         return cancelled_publish(
             subject, [](const CancelResponse& response, Line&, std::uint32_t) {
                 return expect(response.cancel_count == 1, std::to_string(response.cancel_count));
             });
     }},
    {"cancel-answer", "Cancel", "A cancelled request is answered", "a Publish that is cancelled",
     one_of(status::Bad_RequestCancelledByClient, status::Bad_RequestCancelledByRequest),
     "Part 4, 5.7.5.1",
     [](Subject& subject) {
         return cancelled_publish(
             subject, [](const CancelResponse& response, Line& line, std::uint32_t publish) {
                 return response.cancel_count == 0
                            ? not_applicable("the server does not cancel the request")
                            : service_result(line.wait_for<PublishResponse>(publish));
             });
     }},
    {"header-handle", "Read", "A response has the requestHandle", "requestHandle = 4711001",
     "4711001", "Part 4, 7.33", header},
    {"header-handle-fault", "Read", "A ServiceFault has the requestHandle",
     "nodesToRead = [], requestHandle = 4711002", "4711002", "Part 4, 7.34", fault_header},
    {"header-time", "Read", "A response has the time when it was sent", "any", "a timestamp",
     "Part 4, 7.33", time_of_response},
    {"header-additional", "Read", "An unknown additionalHeader is ignored",
     "additionalHeader = a structure of an unknown type", status::Good, "Part 4, 7.32",
     unknown_additional_header},
};

} // namespace sessions
} // namespace

std::span<const SpecRule> session_rules()
{
    return sessions::rules;
}

} // namespace busbar::tool::rules
