#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/session.hpp>

namespace busbar::harness::detail {

/// A password or issued token on its way past the connection in between.
struct ProxySecret {
    /// The way in which the client has encrypted it (Part 4, 7.40.2).
    enum class Form : std::uint8_t { Plain, Legacy, Sealed };
    Form form{Form::Plain};
    /// Null for Plain.
    const crypto::SecurityPolicy* policy{nullptr};
    crypto::Secret text;
};

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
    struct Config {
        std::string proxy_url;
        channel::EndpointUrl server_url;
        std::string server_url_text;
        /// The server's answer to GetEndpoints.
        std::vector<EndpointDescription> endpoints;
        /// Null if there is no security.
        const channel::ApplicationIdentity* identity{nullptr};
    };
    /// Both must outlive it.
    ProxyMessages(Config config, const WallClock& clock, LogSink& log);

    /// The settings that the server offers and this build knows, and None for discovery.
    [[nodiscard]] std::vector<channel::SecuritySetting> settings() const;
    /// The server's certificate for channels of this security; nothing if it shows none.
    [[nodiscard]] std::optional<crypto::Certificate>
    certificate_for(const channel::SecuritySetting& security) const;

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
        /// Grows with each use.
        std::uint64_t last_use{0};
    };

    [[nodiscard]] Result<void> change(const ProxyChannels& channels, ProxyExchange& exchange,
                                      CreateSessionRequest& request) const;
    [[nodiscard]] Result<void> change(const ProxyChannels& channels, ProxyExchange& exchange,
                                      ActivateSessionRequest& request) const;
    [[nodiscard]] Result<void> check_client(const ProxyChannels& channels,
                                            const CreateSessionRequest& request) const;
    [[nodiscard]] Result<void> take_secret(const ProxyChannels& channels, ProxyExchange& exchange,
                                           ExtensionObject& token) const;
    [[nodiscard]] Result<ProxySecret> open_secret(const ProxyChannels& channels,
                                                  const ByteString& nonce, const String& policy_id,
                                                  const ByteString& data,
                                                  const String& algorithm) const;
    [[nodiscard]] Result<void> put_secret(const ProxyChannels& channels, const ByteString& nonce,
                                          const ProxySecret& secret, ExtensionObject& token) const;
    [[nodiscard]] Result<void> change(const ProxyChannels& channels, const ProxyExchange& exchange,
                                      CreateSessionResponse& response);
    /// The policy that encrypts what a token with this policy id has; null for None.
    [[nodiscard]] const crypto::SecurityPolicy* policy_of(const ProxyChannels& channels,
                                                          const String& policy_id) const;
    [[nodiscard]] ByteString nonce_of(const NodeId& session) const;
    void remember(const NodeId& session, const ByteString& nonce, const ProxyChannels& channels);
    [[nodiscard]] bool is_signed(const crypto::SecurityPolicy& policy,
                                 const crypto::Certificate& signer,
                                 std::span<const std::byte> certificate, const ByteString& nonce,
                                 const SignatureData& signature) const;
    [[nodiscard]] Result<SignatureData> sign(const crypto::SecurityPolicy& policy,
                                             std::span<const std::byte> certificate,
                                             const ByteString& nonce) const;
    [[nodiscard]] Result<void> refuse(StatusCode status, std::string_view check, std::string found,
                                      std::string_view rule, std::string remedy) const;
    [[nodiscard]] bool is_of_server(std::string_view url) const;
    void rewrite_url(String& url) const;
    void rewrite(ApplicationDescription& server) const;
    void rewrite(Array<EndpointDescription>& endpoints) const;

    Config config_;
    std::string own_uri_;
    String server_uri_;
    ByteString own_chain_;
    const WallClock* clock_;
    LogSink* log_;
    /// Maps authentication tokens to sessions.
    std::map<NodeId, KnownSession> sessions_;
    std::uint64_t last_use_{0};
};

} // namespace busbar::harness::detail
