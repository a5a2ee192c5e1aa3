#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/harness/engine_watch.hpp>
#include <busbar/harness/seeded_random.hpp>
#include <busbar/harness/world.hpp>
#include <busbar/server/server.hpp>

namespace busbar::harness {

/// The parts that a hosted server needs in addition to its configuration. All pointers must outlive
/// the host.
struct ServerParts {
    /// If null, every certificate is accepted.
    crypto::CertificateValidator* validator{nullptr};
    /// If null, those of ServerHost::users().
    server::UserStore* users{nullptr};
    const server::AccessControl* access{nullptr};
    /// The delay from waking the server until it looks for completions of data sources, as when
    /// threads wait for their turn. One in eight times it is up to the second value.
    Duration wake_delay{0};
    Duration rare_wake_delay{0};
    /// Observes code that is not called through ServerHost::server(). What the server calls, such
    /// as a data source or a log, runs inside.
    EngineWatch* watch{nullptr};
    /// Gets the keys of the server's channels, for Wireshark, in builds with BUSBAR_KEY_LOG. May be
    /// null.
    channel::KeyLog* key_log{nullptr};
    /// If null, users have only the roles that the UserStore gives them.
    const server::RoleMapper* roles{nullptr};
    /// If null, the world's log.
    LogSink* log{nullptr};
};

/// Returns a configuration with one endpoint without security, on which every user has all rights:
/// for tests of something else.
[[nodiscard]] BUSBAR_API server::ServerConfig open_server_config();

/// Returns the same configuration with the certificate of default_server_identity() and three
/// endpoints, for anonymous users and for those with a name: without security, and Basic256Sha256
/// with Sign and with SignAndEncrypt.
[[nodiscard]] BUSBAR_API server::ServerConfig secured_server_config();

/// Users of a test, with passwords that are not hashed, since hashing would take most of a test's
/// time. Anonymous users have all rights.
class BUSBAR_API TestUsers final : public server::UserStore {
public:
    void add(std::string name, std::string password, server::UserRights rights = {});
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view name,
                                                      std::string_view password) override;
    [[nodiscard]] server::UserIdentity anonymous() const override { return everybody; }

    server::UserIdentity everybody{};

private:
    struct User {
        std::string password;
        server::UserRights rights;
    };
    std::map<std::string, User, std::less<>> users_;
};

/// Runs a server in a world as the network layer does in real time. One thread; data sources may
/// complete from other threads, but that only makes sense if the world is driven in real time.
class BUSBAR_API ServerHost final : public Acceptor, private server::Waker {
public:
    /// Listens at the configuration's endpoint_url. The world must outlive it. A configuration that
    /// contradicts itself leaves the host without a server: see is_running() and problem().
    explicit ServerHost(World& world, server::ServerConfig config = open_server_config(),
                        const ServerParts& parts = {}, model::AddressSpace address_space = {});
    /// For links that a test creates itself, without a network. `chunk_hook` may be null.
    ServerHost(Scheduler& scheduler, const WallClock& clock, LogSink& log, Chance chance,
               server::ServerConfig config, const ServerParts& parts = {},
               model::AddressSpace address_space = {}, channel::ChunkHook* chunk_hook = nullptr);
    ~ServerHost() override;

    [[nodiscard]] bool is_running() const { return server_ != nullptr; }
    /// The reason why there is no server; nothing if there is one.
    [[nodiscard]] const std::optional<Problem>& problem() const { return problem_; }
    /// Throws std::logic_error with the problem unless it is_running(). Changes made outside of a
    /// run are noticed when the next run begins.
    [[nodiscard]] server::Server& server()
    {
        need_server();
        touched_.raise();
        return *server_;
    }
    /// The users of a server that was given no UserStore; others have no effect.
    [[nodiscard]] TestUsers& users() { return users_; }
    /// Adds `source`, which may end before the host, to the server; returns its index.
    std::uint32_t add_source(server::DataSource& source) { return server().add_source(source); }
    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view peer_address) override;

private:
    class Peer;
    class Inside;

    void need_server() const;
    void wake() override { woken_.raise(); }
    void await_completions();
    /// Runs `call` on the server, then settle().
    template <typename Work>
    void work(Work call);
    /// Handles the consequences of the last call: deadlines, and output of other connections.
    void settle();
    void forget_ended();

    Scheduler& scheduler_;
    Network* network_{nullptr};
    Chance chance_;
    ServerParts parts_;
    SeededRandom random_;
    crypto::InsecureAcceptAnyCertificate accept_any_;
    TestUsers users_;
    std::vector<std::uint64_t> ended_;
    Alarm deadline_;
    Alarm completions_;
    Alarm forget_;
    Signal woken_;
    Signal touched_;
    std::unique_ptr<server::Server> server_;
    std::optional<Problem> problem_;
    std::map<std::uint64_t, std::unique_ptr<Peer>> peers_;
};

} // namespace busbar::harness
