#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/types.hpp>
#include <busbar/harness/world.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::harness {

/// The parts of a SecureProxy. All pointers must outlive it.
struct SecureProxyParts {
    /// The certificate and private key that clients and the server see. Needed unless the server
    /// has no endpoint but those with policy None.
    const channel::ApplicationIdentity* identity{nullptr};
    /// Decides on the certificates of clients; if null, every one is accepted.
    crypto::CertificateValidator* client_validator{nullptr};
    /// Decides on the server's certificate; likewise.
    crypto::CertificateValidator* server_validator{nullptr};
    /// Makes the nonces of channels; if null, the world's numbers, which protect nothing.
    crypto::Random* random{nullptr};
    /// Receives the keys of both sides' channels; null for none. See ChannelEnvironment.
    channel::KeyLog* key_log{nullptr};
    /// The URL that clients are told to connect to; if empty, the one at which the proxy listens.
    std::string public_url;
};

/// Stands between clients and a server, and ends the secure channels of both (Part 6, 6.7): clients
/// and the server trust the proxy's certificate and not each other's. In between, messages cross a
/// connection of the world's network with policy None. So faults by name and by field, recorder and
/// trace work on secured traffic as on any other; the connections outside are not on the network
/// (Network::exempt()).
///
/// The proxy offers the server's endpoints with its own URL, certificate and ApplicationUri, and
/// opens each channel to the server with the policy and mode that its client has chosen. It signs
/// for both sides, and refuses what was signed wrongly (Bad_ApplicationSignatureInvalid). Passwords
/// and issued tokens of logins (ActivateSession) are decrypted and encrypted again for the server:
/// they are never on the connection in between. Everything else is, arguments of Methods included,
/// and so the passwords of AddUser and ChangePassword (Part 18). A login that cannot be read is
/// refused (Bad_DecodingError), as is one of an unknown kind (Bad_IdentityTokenInvalid). A user
/// certificate cannot be forwarded, since its owner signs for one server:
/// Bad_IdentityTokenRejected, and the log says why.
///
/// As a server does, it refuses clients that show another certificate in CreateSession than on
/// their channel, or move a session to a channel with another certificate
/// (Bad_SecurityChecksFailed), and those whose ApplicationUri is not that of their certificate
/// (Bad_CertificateUriInvalid).
///
/// Endpoints of other servers and ports and with other transports are passed on as they are; those
/// of the server with a policy that this build does not know are left out. One thread; the world
/// must outlive it.
class BUSBAR_API SecureProxy {
public:
    /// Listens at `url`. `server_url` is where the server listens in the world (or out of it, see
    /// RealWorld::reach()), `endpoints` what it answers to GetEndpoints.
    SecureProxy(World& world, std::string_view url, std::string_view server_url,
                Array<EndpointDescription> endpoints, const SecureProxyParts& parts);
    ~SecureProxy();
    SecureProxy(const SecureProxy&) = delete;
    SecureProxy& operator=(const SecureProxy&) = delete;

    /// Whether it listens: both URLs were right, and nothing else listens at the first one.
    [[nodiscard]] bool is_listening() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::harness
