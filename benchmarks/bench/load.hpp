#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <busbar/channel/client_channel.hpp>
#include <busbar/net/client_loop.hpp>

#include "floor.hpp"
#include "server_meter.hpp"
#include "subscribe.hpp"

namespace busbar::bench {

struct Options {
    std::string url{"opc.tcp://localhost:4840"};
    std::string policy{"None"};
    std::string mode{"None"};
    std::string user;
    std::string password;
    /// The client's; none: one of the moment is made, where the endpoint asks for one.
    std::optional<channel::ApplicationIdentity> identity;
    /// A NodeId with "{}" where the number goes.
    std::string node{"ns=2;s=Bulk{}"};
    /// Variables that the server has, or 0 for as many as the largest request names: each request
    /// of a load names others of them.
    std::size_t variables{0};
    std::vector<std::size_t> read_counts{1, 100, 1'000, 10'000, 25'000};
    std::vector<std::size_t> write_counts{1, 100, 3'000};
    /// Nodes per Browse: the same Variables, all of their references.
    std::vector<std::size_t> browse_counts{1, 1'000};
    std::vector<std::size_t> in_flight{1, 64};
    std::size_t connects{20};
    /// Of load_names; all of them where it is empty.
    std::vector<std::string> only;
    /// Values of a Read or Write lie beside each other, or anywhere among as many as the largest
    /// asks for.
    bool is_sequential{false};
    /// They are named by what RegisterNodes gives for them.
    bool is_registered{false};
    double seconds{1.0};
    /// How often all loads are run.
    std::size_t rounds{1};
    SubscribeOptions subscribe;
    bool json{false};
};

inline constexpr std::array load_names{"connects", "reads", "writes", "browses", "in-flight"};

/// Returns the number of variables that are used: Options::variables, or those of the largest Read,
/// Write or Browse if these are more.
[[nodiscard]] std::size_t most_values(const Options& options);

/// One line of the table; times in microseconds.
struct Row {
    std::string load;
    std::size_t round{0};
    std::size_t runs{0};
    double median_us{0};
    double best_us{0};
    double p99_us{0};
    /// What the same bytes cost without any OPC UA, and a connect's RSA.
    Floor floor;
    double per_second{0};
    /// None where it is not on this machine.
    std::optional<ServerCost> server;
};

/// The median and the like of a series of times.
[[nodiscard]] Row summarise(std::string load, std::vector<double> times_us);
[[nodiscard]] double elapsed_us(TimePoint since);
[[nodiscard]] TimePoint clock_now();
/// What a client may be answered by the largest of the loads.
[[nodiscard]] binary::DecodeLimits generous_limits();

/// A server under test: finds the endpoint, connects and runs the loads.
class Load {
public:
    explicit Load(Options options);

    /// Asks the server for its endpoints. Bad_SecurityPolicyRejected if the one that is wanted is
    /// not among them.
    [[nodiscard]] Result<void> prepare();
    /// All loads of the options, round after round; stops at the first that fails.
    [[nodiscard]] Result<std::vector<Row>> run();
    /// The subscriptions of the options, each on a connection of its own.
    [[nodiscard]] Result<std::vector<SubscribeRow>> run_subscriptions();
    /// A connection of its own, with a session on the endpoint or without one on an open channel.
    /// From any thread once prepare() has returned.
    [[nodiscard]] Result<void> open(net::ClientLoop& loop, bool wants_session,
                                    std::chrono::milliseconds request_timeout = default_timeout);

    /// A channel on the endpoint, as a client begins it. After prepare().
    [[nodiscard]] channel::ClientChannel make_channel();
    [[nodiscard]] const std::string& url() const { return options_.url; }

    static constexpr std::chrono::milliseconds default_timeout{10'000};

private:
    [[nodiscard]] Result<void> run_round(std::vector<Row>& rows);
    [[nodiscard]] Result<Row> connect_load();
    /// Has the session name all nodes by registered NodeIds.
    [[nodiscard]] Result<void> register_nodes(net::ClientLoop& loop);
    [[nodiscard]] Result<Row> read_load(net::ClientLoop& loop, std::size_t count);
    [[nodiscard]] Result<Row> write_load(net::ClientLoop& loop, std::size_t count);
    [[nodiscard]] Result<Row> browse_load(net::ClientLoop& loop, std::size_t count);
    [[nodiscard]] Result<Row> in_flight_load(net::ClientLoop& loop, std::size_t in_flight);
    /// Runs a load of requests of `count` values each.
    template <typename Once>
    [[nodiscard]] Result<Row> measure(const std::string& load, std::size_t count, Once once);
    /// Requests of `count` nodes each, as many as there are other nodes for: caches have seen
    /// little of what is asked for. `add` adds the node at a place.
    template <typename Request, typename Add>
    [[nodiscard]] std::vector<Request> requests_of(std::size_t count, Add add) const;
    /// Sends the requests in turn, again and again; `check` returns what is wrong with the results.
    template <typename Response, typename Request, typename Check>
    [[nodiscard]] Result<Row> exchange_load(const std::string& load, std::size_t count,
                                            net::ClientLoop& loop, std::vector<Request> requests,
                                            Check check);
    [[nodiscard]] bool wants(const char* load) const;
    [[nodiscard]] NodeId node(std::size_t number) const;
    [[nodiscard]] channel::ChannelEnvironment environment();

    Options options_;
    crypto::SystemRandom random_;
    net::SystemWallClock wall_clock_;
    NullLog log_;
    crypto::InsecureAcceptAnyCertificate validator_;
    std::optional<channel::ApplicationIdentity> identity_;
    std::optional<crypto::Certificate> server_certificate_;
    channel::SecuritySetting security_;
    /// The numbers of the variables in the order in which they are asked for.
    std::vector<std::size_t> numbers_;
    /// As they are registered in the session of the round; empty if they are not.
    std::vector<NodeId> aliases_;
    ServerMeter meter_;
};

} // namespace busbar::bench
