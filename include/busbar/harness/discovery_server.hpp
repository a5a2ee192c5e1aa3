#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::harness {

/// Limits of what a discovery server keeps. Beyond them it answers Bad_ResourceUnavailable, or
/// Bad_InvalidArgument if a single server exceeds them.
struct DiscoveryServerLimits {
    std::size_t max_servers{1'000};
    /// Names of one server, its URLs, capabilities and configurations, each.
    std::size_t max_entries{32};
    /// Bytes of one text.
    std::size_t max_text{4'096};
};

/// All pointers must outlive the server.
struct DiscoveryServerOptions {
    std::string url{"opc.tcp://discovery:4840/UADiscovery"};
    std::string application_uri{"urn:busbar:harness:discovery"};
    /// The endpoints. FindServers and GetEndpoints are always available without security (Part 4,
    /// 5.5.1).
    std::vector<channel::SecuritySetting> endpoints{{}};
    /// Accepts registrations over None as well.
    bool allows_unsecured{true};
    bool knows_register_server_2{true};
    /// An entry that is not renewed for this long is forgotten (Part 4, 5.5.5.1).
    Duration lifetime{std::chrono::minutes{10}};
    DiscoveryServerLimits limits;
    /// If null, every certificate is accepted.
    crypto::CertificateValidator* validator{nullptr};
    /// Needed for every policy except None.
    const channel::ApplicationIdentity* identity{nullptr};
};

/// A discovery server for tests (Part 4, 5.5; Part 12, 5): FindServers, FindServersOnNetwork for
/// those that sent an MdnsDiscoveryConfiguration, GetEndpoints, RegisterServer and RegisterServer2;
/// no mDNS. Other services are answered with Bad_ServiceUnsupported. One thread; the world must
/// outlive it.
class BUSBAR_API DiscoveryServer {
public:
    /// A registered server.
    struct Entry {
        RegisteredServer server;
        /// The capabilities of RegisterServer2; empty with RegisterServer, whose servers
        /// FindServersOnNetwork does not return.
        std::vector<std::string> capabilities{};
        std::string mdns_name{};
        /// The RecordId in FindServersOnNetwork, from 1; 0 with RegisterServer.
        std::uint32_t record_id{0};
        TimePoint expires_at{no_deadline};
    };

    explicit DiscoveryServer(World& world, DiscoveryServerOptions options = {});

    /// The present registrations, by URI.
    [[nodiscard]] const std::map<std::string, Entry, std::less<>>& entries();
    /// Null if it is not registered.
    [[nodiscard]] const Entry* find(std::string_view server_uri);
    /// Names of all requests that arrived, in their order.
    [[nodiscard]] const std::vector<std::string>& came() const { return server_.came(); }
    /// Number of requests with this name.
    [[nodiscard]] std::size_t count(std::string_view request) const;
    /// The semaphore files that exist (Part 4, 7.32): an entry with a file lasts as long as its
    /// file.
    [[nodiscard]] std::set<std::string, std::less<>>& semaphore_files() { return files_; }

private:
    void answer_requests();
    [[nodiscard]] ApplicationDescription describe_itself() const;
    [[nodiscard]] FindServersResponse find_servers(const FindServersRequest& request);
    [[nodiscard]] FindServersOnNetworkResponse
    find_on_network(const FindServersOnNetworkRequest& request);
    [[nodiscard]] GetEndpointsResponse get_endpoints() const;
    [[nodiscard]] Result<RegisterServer2Response>
    register_extended(const RegisterServer2Request& request);
    [[nodiscard]] Result<void> register_server(Entry entry);
    [[nodiscard]] StatusCode check_caller(const RegisteredServer& server) const;
    [[nodiscard]] StatusCode check_texts(const RegisteredServer& server) const;
    void forget_expired();

    World& world_;
    DiscoveryServerOptions options_;
    ScriptedServer server_;
    std::map<std::string, Entry, std::less<>> entries_;
    std::set<std::string, std::less<>> files_;
    std::uint32_t last_record_{0};
};

} // namespace busbar::harness
