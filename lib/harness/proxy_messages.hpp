#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "proxy_secrets.hpp"

namespace busbar::harness::detail {

/// The facts that the proxy needs of a request until its response has come.
struct ProxyExchange {
    std::uint32_t client_request_id{0};
    std::uint32_t request_handle{0};
    /// These two are set for a CreateSession, as the client has sent them.
    ByteString client_nonce;
    ByteString client_certificate;
    /// The authentication token of the session.
    NodeId session;
    /// Set for an ActivateSession.
    std::optional<ProxySecret> secret;
    bool is_answered{false};
};

/// The channels of one client and of its server, which have the same security.
struct ProxyChannels {
    channel::SecuritySetting security;
    crypto::CertificateChain client;
    std::optional<crypto::Certificate> server;
};

/// Makes messages of discovery and sessions right for those that get them: names, URLs,
/// certificates, signatures and secrets. Shared by all connections, since a session moves from one
/// to another.
class ProxyMessages {
public:
    /// Sessions that are known at a time; the one that was activated longest ago makes room.
    static constexpr std::size_t max_sessions = 10'000;

    /// The clock and the log must outlive it.
    ProxyMessages(ProxyEndpoints::Config config, const WallClock& clock, LogSink& log);
    ProxyMessages(const ProxyMessages&) = delete;
    ProxyMessages& operator=(const ProxyMessages&) = delete;

    [[nodiscard]] const ProxyEndpoints& endpoints() const { return endpoints_; }

    // Each changes the body of a message, or leaves it; the error is what its sender is to be told
    // in a ServiceFault.

    /// A request of the client's, on its way into the connection in between.
    [[nodiscard]] Result<void> from_client(const ProxyChannels& channels, ProxyExchange& exchange,
                                           std::vector<std::byte>& body) const;
    /// The same at its other end.
    [[nodiscard]] Result<void> to_server(const ProxyChannels& channels,
                                         const ProxyExchange& exchange,
                                         std::vector<std::byte>& body) const;
    /// A response for the client.
    [[nodiscard]] Result<void> to_client(const ProxyChannels& channels,
                                         const ProxyExchange& exchange,
                                         std::vector<std::byte>& body);
    /// The body of a ServiceFault.
    [[nodiscard]] std::vector<std::byte> fault(const ProxyExchange& exchange,
                                               StatusCode status) const;

private:
    /// The last nonce that the server has sent, and the leaf of the client that created the session
    /// as DER; the leaf is empty on channels without security.
    struct KnownSession {
        ByteString nonce;
        ByteString client;
        /// Grows with each activation.
        std::uint64_t last_use{0};
    };

    [[nodiscard]] Result<void> change(const ProxyChannels& channels, ProxyExchange& exchange,
                                      CreateSessionRequest& request) const;
    [[nodiscard]] Result<void> change(const ProxyChannels& channels, ProxyExchange& exchange,
                                      ActivateSessionRequest& request) const;
    [[nodiscard]] Result<void> check_client(const ProxyChannels& channels,
                                            const CreateSessionRequest& request) const;
    [[nodiscard]] Result<void> change(const ProxyChannels& channels, const ProxyExchange& exchange,
                                      CreateSessionResponse& response);
    [[nodiscard]] ByteString nonce_of(const NodeId& session) const;
    void remember(const NodeId& session, const ByteString& nonce, const ProxyChannels& channels);
    /// Whether the signer has signed the proxy's certificate and this nonce.
    [[nodiscard]] bool is_signed(const crypto::SecurityPolicy& policy,
                                 const crypto::Certificate& signer, const ByteString& nonce,
                                 const SignatureData& signature) const;

    ProxyEndpoints endpoints_;
    ProxySecrets secrets_;
    const WallClock* clock_;
    LogSink* log_;
    /// Maps authentication tokens to sessions.
    std::map<NodeId, KnownSession> sessions_;
    std::uint64_t last_use_{0};
};

} // namespace busbar::harness::detail
