#pragma once

#include <memory>
#include <string>

#include <busbar/client/connection.hpp>
#include <busbar/harness/connection_host.hpp>
#include <busbar/types/discovery.hpp>

#include "tool/connection/context.hpp"
#include "tool/connection/credentials.hpp"
#include "tool/connection/logs.hpp"

namespace busbar::tool {

/// Returns what the server of the options answers to GetEndpoints; throws Failure.
[[nodiscard]] Array<EndpointDescription> endpoints_of(Context& context);

/// Certificates, keys and trust for channels of a world to real peers, as a Connection has them for
/// its own.
class LiveSecurity {
public:
    /// `context` must outlive it; throws Failure.
    explicit LiveSecurity(Context& context);

    [[nodiscard]] Credentials& credentials() { return credentials_; }
    [[nodiscard]] crypto::Random& random() { return random_; }
    /// Null unless the options ask for one.
    [[nodiscard]] channel::KeyLog* key_log() { return key_log_.get(); }
    /// Returns when the certificate of the endpoint is trusted, perhaps from now on; throws
    /// Failure. Endpoints without security need none.
    void need_trust(const EndpointDescription& endpoint);
    /// The configuration of a session with the best of these endpoints, as the options say;
    /// throws Failure.
    [[nodiscard]] client::ConnectionConfig
    session_config(const Array<EndpointDescription>& endpoints);
    [[nodiscard]] harness::ClientParts client_parts();

private:
    Context* context_;
    VerboseLog log_;
    Credentials credentials_;
    std::unique_ptr<channel::KeyLog> key_log_;
    crypto::SystemRandom random_;
    net::SystemWallClock clock_;
};

} // namespace busbar::tool
