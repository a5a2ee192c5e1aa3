#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/channel/endpoint_url.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::harness::detail {

/// The endpoints of a proxy: those of its server, with the proxy's own names, URL and certificate.
class ProxyEndpoints {
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
    explicit ProxyEndpoints(Config config);

    [[nodiscard]] const channel::ApplicationIdentity* identity() const { return config_.identity; }
    /// The identity's chain as it is sent; empty without one.
    [[nodiscard]] const ByteString& own_chain() const { return own_chain_; }
    [[nodiscard]] const std::string& own_uri() const { return own_uri_; }
    [[nodiscard]] const String& server_uri() const { return server_uri_; }
    [[nodiscard]] const std::string& server_url() const { return config_.server_url_text; }

    /// The settings that the server offers and this build knows, and None for discovery.
    [[nodiscard]] std::vector<channel::SecuritySetting> settings() const;
    /// The server's certificate for channels of this security; nothing if it shows none.
    [[nodiscard]] std::optional<crypto::Certificate>
    certificate_for(const channel::SecuritySetting& security) const;
    /// The policy that encrypts the secret of a token with this policy id on channels of this
    /// security; null for None.
    [[nodiscard]] const crypto::SecurityPolicy*
    token_policy(const channel::SecuritySetting& security, const String& policy_id) const;

    // Endpoints of other servers are passed on unchanged.

    void rewrite(ApplicationDescription& server) const;
    /// Leaves out endpoints of the server with a policy that this build does not know.
    void rewrite(Array<EndpointDescription>& endpoints) const;

private:
    [[nodiscard]] bool is_of_server(std::string_view url) const;
    [[nodiscard]] bool is_of_server(const EndpointDescription& endpoint) const;
    void rewrite_url(String& url) const;

    /// `endpoints` has only those of the server.
    Config config_;
    std::string own_uri_;
    String server_uri_;
    ByteString own_chain_;
    bool is_any_port_ours_{false};
};

} // namespace busbar::harness::detail
