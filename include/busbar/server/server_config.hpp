#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server {

/// One way to connect: its security and the kinds of users that it accepts.
struct EndpointConfig {
    channel::SecuritySetting security;
    bool allows_anonymous{false};
    bool allows_user_name{true};
    /// The policy that encrypts passwords and issued tokens. If null, the endpoint's own policy or,
    /// if that is None, Basic256Sha256. Policy None sends them in clear text and is refused by
    /// Server::create unless allows_plain_passwords is set.
    const crypto::SecurityPolicy* password_policy{nullptr};
    bool allows_plain_passwords{false};
    /// Users with X.509 certificates, if the UserStore has a validator for them.
    bool allows_certificate{false};
    /// The policy that users with certificates sign with. If null, as for passwords; never None.
    const crypto::SecurityPolicy* certificate_policy{nullptr};
    /// Users with JSON Web Tokens, if the UserStore has rules for them; see ServerConfig::issuer.
    bool allows_issued{false};
};

/// The source of clients' issued tokens, as endpoints describe it (Part 6, 6.5.2.2, Table 55).
struct TokenIssuer {
    /// The base URL of the authorization service; the issuer in its tokens.
    std::string authority_url;
    std::string authority_profile_uri{"http://opcfoundation.org/UA/Authorization#OAuth2"};
    /// Relative to the authority's URL; left out if empty.
    std::string token_endpoint;
    std::string authorization_endpoint;
    /// "authorization_code", "client_credentials", ...
    std::vector<std::string> request_types;
    std::vector<std::string> scopes;
};

/// Basic256Sha256 with Sign and with SignAndEncrypt, user names only.
[[nodiscard]] BUSBAR_API std::vector<EndpointConfig> secure_endpoints();

/// BuildInfo of the Server object (Part 5, 12.5), except for the name and URI of the product.
struct BuildDescription {
    std::string manufacturer_name;
    std::string software_version;
    std::string build_number;
    DateTime build_date;
};

/// The functions of the program around a server, for its claims of conformance (Part 7).
struct ProgramConformance {
    /// Registers the server with a discovery server; see net::ServerLoop::register_with.
    bool has_registration{false};
    /// Connects to clients that listen; see Connection::reverse_hello.
    bool has_reverse_connect{false};
    /// Names of ConformanceUnits whose requirements on the application, its documentation or its
    /// host (schemas/conformance.csv) are met. Others have no effect.
    std::vector<std::string> conformance_units;
};

/// Another server that this one announces to clients (Part 4, 5.5.3).
struct NetworkServer {
    /// Part 12, 4.3.4: at most 63 bytes if it comes from mDNS.
    std::string name;
    std::string discovery_url;
    /// Identifiers of Part 12, Annex D: "LDS", "DA", ...
    std::vector<std::string> capabilities;
};

/// The configuration of a server. The default is secure: no endpoint without security, no anonymous
/// user.
struct ServerConfig {
    /// Globally unique; the certificate must contain it, too.
    std::string application_uri{"urn:busbar:server"};
    std::string product_uri{"urn:busbar"};
    std::string application_name{"Busbar"};
    BuildDescription build;

    /// The default address of the server: "opc.tcp://host:port/path".
    std::string endpoint_url{"opc.tcp://localhost:4840"};
    /// Further host names and addresses by which clients reach it; endpoints are returned with the
    /// one that the client used.
    std::vector<std::string> host_names;
    /// Further URLs at other ports that it listens on: endpoints are returned with the one that the
    /// client used, too. "opc.tcp://host:port".
    std::vector<std::string> further_urls;
    std::vector<EndpointConfig> endpoints{secure_endpoints()};
    /// Answers FindServers and GetEndpoints over SecurityPolicy None, as clients expect, even if no
    /// endpoint has it. Sessions need an endpoint.
    bool has_open_discovery{true};
    /// The server's certificates, sent unchanged, and its key; needed for every policy except None.
    std::optional<channel::ApplicationIdentity> identity;
    /// For endpoints with allows_issued.
    TokenIssuer issuer;

    /// Offers AddNodes, AddReferences, DeleteNodes and DeleteReferences (Part 4, 5.8) to users whom
    /// the AccessControl allows them; without this they answer Bad_ServiceUnsupported.
    bool has_node_management{false};

    /// The value of Server.Auditing: the LogSink creates audit events from its records, as
    /// administration::AuditLog does.
    bool is_auditing{false};

    ProgramConformance program;

    /// The answer of FindServersOnNetwork, by RecordIds from 1 on; if empty, the service answers
    /// Bad_ServiceUnsupported.
    std::vector<NetworkServer> network_servers;

    /// Locales of the server's texts.
    std::vector<std::string> locale_ids{"en"};
    /// Time for which clients can see State Shutdown before their connections are closed.
    std::chrono::milliseconds shutdown_delay{2'000};
    ServerLimits limits;
};

} // namespace busbar::server
