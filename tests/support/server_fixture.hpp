#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <busbar/channel/client_channel.hpp>
#include <busbar/crypto/jwt.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/session.hpp>

#include "support/byte_pipe.hpp"
#include "support/channel_pair.hpp"
#include "support/login.hpp"
#include "support/response.hpp"

namespace busbar::test {

/// Users whose passwords are not hashed, which saves a test its time. Other tokens as a test says.
class PlainUsers final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view name,
                                                      std::string_view password) override
    {
        ++asked;
        fail_if_broken();
        if (password != std::string{name} + "-secret") {
            return fail(status::Bad_UserAccessDenied);
        }
        server::UserIdentity user{UserTokenType::UserName, std::string{name}};
        if (name == "admin") {
            user.roles = {"ConfigureAdmin", "SecurityAdmin"};
        }
        user.must_change_password = must_change;
        return user;
    }
    [[nodiscard]] server::Worker* worker() override { return used_worker; }
    [[nodiscard]] server::UserIdentity anonymous() const override
    {
        fail_if_broken();
        return everybody;
    }
    [[nodiscard]] crypto::CertificateValidator* certificate_validator() override
    {
        return validator;
    }
    [[nodiscard]] Result<server::UserRights> certificate_user(const crypto::Certificate&) override
    {
        return rights;
    }
    [[nodiscard]] const crypto::JwtRules* token_rules() const override
    {
        return rules ? &*rules : nullptr;
    }
    [[nodiscard]] Result<server::UserRights> token_user(const crypto::JwtClaims&) override
    {
        return rights;
    }

    void fail_if_broken() const
    {
        if (is_broken) {
            throw std::runtime_error{"bus error"};
        }
    }

    int asked{0};
    bool is_broken{false};
    bool must_change{false};
    server::UserIdentity everybody{server::anonymous_reader()};
    server::Worker* used_worker{nullptr};
    crypto::CertificateValidator* validator{nullptr};
    std::optional<crypto::JwtRules> rules;
    Result<server::UserRights> rights{server::UserRights{}};
};

/// One client of a server under test: a channel joined with a Connection by memory, and the session
/// services in their usual form. What a test wants otherwise, it changes before it calls.
class TestClient {
public:
    TestClient(server::Connection accepted, channel::SecuritySetting security,
               const channel::ChannelEnvironment& environment, TimePoint& now)
        : connection{std::move(accepted)}, channel{config(security), environment, now},
          identity_{environment.identity}, now_{&now}
    {
        run();
    }

    /// The same that says nothing before it is told to.
    struct Silent {};
    TestClient(server::Connection accepted, channel::SecuritySetting security,
               const channel::ChannelEnvironment& environment, TimePoint& now, Silent /*tag*/)
        : connection{std::move(accepted)}, channel{config(security), environment, now},
          identity_{environment.identity}, now_{&now}
    {
    }

    /// Lets both sides talk until nothing moves.
    void run()
    {
        bool moved = true;
        while (moved) {
            moved = carry(channel, connection, *now_);
            moved = carry(connection, channel, *now_) || moved;
            while (auto event = channel.next_event()) {
                keep(*std::move(event));
            }
        }
    }
    /// Sends a request; the id of what will be its response.
    template <typename Request>
    std::uint32_t send(Request request)
    {
        request.request_header.authentication_token = authentication_token;
        request.request_header.request_handle = ++last_handle;
        request.request_header.timeout_hint = timeout_hint;
        request.request_header.timestamp = timestamp;
        return send_bytes([&](binary::Writer& writer) {
            encode(writer, NodeId{0, Request::binary_encoding_id});
            encode(writer, request);
        });
    }
    std::uint32_t send_bytes(FunctionRef<void(binary::Writer&)> encode)
    {
        const auto id = channel.send(encode);
        run();
        return id ? *id : 0;
    }
    /// The response, or why there is none: the status of a ServiceFault, Bad_WouldBlock if there is
    /// no answer yet.
    template <typename Response>
    Result<Response> take(std::uint32_t request_id)
    {
        run();
        const auto found = std::find_if(messages.begin(), messages.end(), [&](const auto& message) {
            return message.request_id == request_id;
        });
        if (found == messages.end()) {
            return fail(is_closed() ? status::Bad_ConnectionClosed : status::Bad_WouldBlock);
        }
        const auto body = std::move(found->body);
        messages.erase(found);
        return decode_response<Response>(body, &handle_of_answer);
    }
    template <typename Response, typename Request>
    Result<Response> call(Request request)
    {
        return take<Response>(send(std::move(request)));
    }
    template <typename Response, typename Request>
    StatusCode status_of(Request request)
    {
        const auto response = call<Response>(std::move(request));
        return response ? response->response_header.service_result : response.error();
    }

    [[nodiscard]] bool is_secure() const { return !channel.security().policy->is_none(); }
    [[nodiscard]] CreateSessionRequest create_request() const
    {
        CreateSessionRequest request;
        request.client_description.application_uri = "urn:busbar:test:client";
        request.client_description.application_type = ApplicationType::Client;
        request.endpoint_url = "opc.tcp://localhost:4840";
        request.session_name = "test";
        static std::uint32_t count = 0; // one nonce, one session
        std::vector<std::byte> nonce(32);
        nonce.front() = static_cast<std::byte>(++count & 0xFF);
        nonce.back() = static_cast<std::byte>(count >> 8U);
        request.client_nonce = ByteString{std::move(nonce)};
        request.requested_session_timeout = 60'000;
        if (is_secure()) {
            request.client_certificate = ByteString{identity_->certificates.front().der()};
        }
        return request;
    }
    Result<CreateSessionResponse> create_session(CreateSessionRequest request)
    {
        auto response = call<CreateSessionResponse>(std::move(request));
        if (response) {
            authentication_token = response->authentication_token;
            server_nonce = response->server_nonce;
        }
        return response;
    }
    Result<CreateSessionResponse> create_session() { return create_session(create_request()); }

    [[nodiscard]] SignatureData signature() const
    {
        // A client without security may have no identity.
        return is_secure() ? sign_session(*channel.security().policy, *identity_, server_nonce)
                           : SignatureData{};
    }
    [[nodiscard]] static ExtensionObject anonymous()
    {
        AnonymousIdentityToken token;
        token.policy_id = "anonymous";
        return ExtensionObject::from(token);
    }
    /// A user name token whose password is encrypted with the last nonce.
    [[nodiscard]] ExtensionObject user(std::string_view name, std::string_view password) const
    {
        return user_token(*crypto::find_policy_by_name("Basic256Sha256"), name, password,
                          server_nonce);
    }
    std::uint32_t send_activate(ExtensionObject token)
    {
        ActivateSessionRequest request;
        request.client_signature = signature();
        request.user_identity_token = std::move(token);
        return send(std::move(request));
    }
    StatusCode take_activate(std::uint32_t id)
    {
        const auto response = take<ActivateSessionResponse>(id);
        if (!response) {
            return response.error();
        }
        server_nonce = response->server_nonce;
        return response->response_header.service_result;
    }
    StatusCode activate(ExtensionObject token)
    {
        return take_activate(send_activate(std::move(token)));
    }
    /// A session of an anonymous user or, on a secure channel, of "operator".
    StatusCode open_session()
    {
        const auto created = create_session();
        if (!created) {
            return created.error();
        }
        return activate(is_secure() ? user("operator", "operator-secret") : anonymous());
    }
    StatusCode close_session() { return status_of<CloseSessionResponse>(CloseSessionRequest{}); }
    /// Takes over another client's session, as after a reconnection.
    void adopt(const TestClient& other)
    {
        authentication_token = other.authentication_token;
        server_nonce = other.server_nonce;
    }
    [[nodiscard]] bool is_closed() const { return connection.is_closed(); }

    server::Connection connection;
    channel::ClientChannel channel;
    NodeId authentication_token;
    ByteString server_nonce;
    std::uint32_t last_handle{0};
    std::uint32_t timeout_hint{0};
    /// Of requests; null unless set.
    DateTime timestamp{};
    std::uint32_t handle_of_answer{0};
    std::deque<channel::ChannelEvent> messages;

private:
    void keep(channel::ChannelEvent event)
    {
        if (event.kind == channel::ChannelEvent::Kind::Message) {
            messages.push_back(std::move(event));
        }
    }
    [[nodiscard]] static channel::ClientChannelConfig config(channel::SecuritySetting security)
    {
        channel::ClientChannelConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.security = security;
        config.server_certificate = server_identity().certificates.front();
        return config;
    }

    const channel::ApplicationIdentity* identity_;
    TimePoint* now_;
};

/// A server in virtual time and its clients.
class ServerFixture {
public:
    explicit ServerFixture(server::ServerConfig config = insecure_config())
        : ServerFixture{nullptr, std::move(config)}
    {
    }
    explicit ServerFixture(server::Waker& w, server::ServerConfig config = insecure_config(),
                           const server::AccessControl* access = nullptr)
        : ServerFixture{&w, std::move(config), access}
    {
    }

    /// One whose channels have their asymmetric work done by `channels`, unless that is null.
    ServerFixture(server::Waker& w, server::Worker* channels,
                  server::ServerConfig config = insecure_config())
        : ServerFixture{&w, std::move(config), nullptr, {}, channels}
    {
    }

    ServerFixture(server::ServerConfig config, model::AddressSpace space)
        : ServerFixture{nullptr, std::move(config), nullptr, std::move(space)}
    {
    }

    /// The default with users and certificate: Sign and SignAndEncrypt.
    [[nodiscard]] static server::ServerConfig secure_config()
    {
        server::ServerConfig config;
        config.application_uri = "urn:busbar:test:server";
        config.identity = server_identity();
        config.host_names = {"plc.example"};
        return config;
    }
    /// The same and an endpoint without security, where anonymous users are allowed.
    [[nodiscard]] static server::ServerConfig insecure_config()
    {
        server::ServerConfig config = secure_config();
        config.endpoints.push_back({{}, true});
        return config;
    }

    [[nodiscard]] TestClient
    connect(channel::SecuritySetting security = {},
            const channel::ApplicationIdentity& identity = client_identity(),
            std::string_view address = "192.0.2.1")
    {
        return {server.connect(address, now).value(), security,
                channel::ChannelEnvironment{.random = &random,
                                            .wall_clock = &wall_clock,
                                            .log = &log,
                                            .validator = &validator,
                                            .identity = &identity},
                now};
    }
    [[nodiscard]] TestClient
    connect(std::string_view policy, MessageSecurityMode mode,
            const channel::ApplicationIdentity& identity = client_identity())
    {
        return connect(setting(policy, mode), identity);
    }
    /// A client with an activated session.
    [[nodiscard]] TestClient log_in(channel::SecuritySetting security = {})
    {
        TestClient client = connect(security);
        if (client.open_session() != status::Good) {
            log.text += "log_in failed\n";
        }
        return client;
    }

    /// The same for a user with a password, over an encrypted channel.
    [[nodiscard]] TestClient log_in_as(const char* name)
    {
        TestClient client = connect("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
        const std::string password = std::string{name} + "-secret";
        if (!client.create_session(client.create_request()) ||
            client.activate(client.user(name, password)) != status::Good) {
            log.text += "log_in_as failed\n";
        }
        return client;
    }

    void advance(Duration time)
    {
        now += time;
        wall_clock.time.ticks += time.count() / 100;
        server.handle_deadline(now);
    }
    /// Time passes for a client's connection too.
    void advance(Duration time, TestClient& client)
    {
        advance(time);
        client.connection.handle_deadline(now);
        client.run();
    }

    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    PlainUsers users;
    server::Waker* waker{nullptr};
    TimePoint now{};
    server::Server server;

private:
    ServerFixture(server::Waker* w, server::ServerConfig config,
                  const server::AccessControl* access = nullptr, model::AddressSpace space = {},
                  server::Worker* channels = nullptr)
        : waker{w}, server{server::Server::create(std::move(config),
                                                  {.random = &random,
                                                   .wall_clock = &wall_clock,
                                                   .log = &log,
                                                   .validator = &validator,
                                                   .users = &users,
                                                   .access = access,
                                                   .waker = waker,
                                                   .channel_worker = channels},
                                                  std::move(space))
                               .value()}
    {
    }
};

} // namespace busbar::test
