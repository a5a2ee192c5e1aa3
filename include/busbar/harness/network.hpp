#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/channel/chunk_hook.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/harness/fault.hpp>
#include <busbar/harness/jumping_clock.hpp>
#include <busbar/harness/link.hpp>

namespace busbar::harness {

namespace detail {
class ActingFaults;
class ChunkTap;
class Timeline;
} // namespace detail

/// Accepts the connections at a listening address of a network.
class BUSBAR_API Acceptor {
public:
    Acceptor() = default;
    Acceptor(const Acceptor&) = delete;
    Acceptor& operator=(const Acceptor&) = delete;
    virtual ~Acceptor() = default;

    /// Attaches the server's end to the link; false if there is no room.
    [[nodiscard]] virtual bool accept(const std::shared_ptr<Link>& link,
                                      std::string_view peer_address) = 0;
};

/// Hosts, ports and connections in memory. One thread; scheduler, clock and log must outlive it.
class BUSBAR_API Network {
public:
    /// `log`, which may be null, gets a line for each connection that finds no listener.
    Network(Scheduler& scheduler, JumpingClock& clock, std::uint64_t seed, LogSink* log = nullptr);
    ~Network();
    Network(const Network&) = delete;
    Network& operator=(const Network&) = delete;

    /// From now on connections to the host and port of `url` ("opc.tcp://host:port/path") go to
    /// `acceptor`, which must outlive the network or be removed by unlisten().
    /// Bad_TcpEndpointUrlInvalid; Bad_InvalidState if another one listens there.
    Result<void> listen(std::string_view url, Acceptor& acceptor);
    /// From now on no connections go to `acceptor`; existing ones stay.
    void unlisten(const Acceptor& acceptor);
    /// From now on connections to the host and port of `url` are plain wires: no weather, fault,
    /// observer or trace is on them, and they are not counted. For what stands between two
    /// connections of which only one is meant. Bad_TcpEndpointUrlInvalid.
    Result<void> exempt(std::string_view url);

    /// Connects at once; an engine for which that takes time waits before. `client` must exist as
    /// long as Link::attach says; call Link::flush when it has something to send.
    /// Bad_ConnectionRejected if there is no acceptor, the acceptor has no room, or the connection
    /// is refused.
    [[nodiscard]] Result<std::shared_ptr<Link>>
    connect(std::string_view url, LinkEnd& client, std::string_view client_address = "192.0.2.1");

    /// The behaviour of the network for all its connections; may be changed at any time.
    [[nodiscard]] Weather& weather() { return weather_; }
    /// The behaviour for the later connections of one client, at first as it is for all. May be
    /// changed at any time.
    [[nodiscard]] Weather& weather_of(std::string_view client_address);
    /// From now on the trace has this name for what the client with this address sends, not
    /// "client".
    void name_client(std::string_view address, std::string_view name);
    /// Plays the script in addition to those that were played before. Throws std::invalid_argument,
    /// which says why, if one of its faults could never act.
    void play(const FaultScript& script);
    void play(const Fault& fault) { play(FaultScript{fault}); }
    /// The faults of all scripts that have never acted, one a line: a test whose fault did not
    /// happen proves nothing.
    [[nodiscard]] std::string pending_faults() const;
    /// From now on a world may end with faults that have never acted; else that is a failure of the
    /// test, if its framework has an adapter (catch.hpp).
    void forgive_pending_faults() { forgives_pending_ = true; }
    /// Tells whether it may.
    [[nodiscard]] bool forgives_pending_faults() const { return forgives_pending_; }
    /// The last messages on all connections, as they were sent, and the faults that acted; one a
    /// line: "0.012 s client -> ReadRequest ns=1;s=Level". At most the last 128.
    [[nodiscard]] std::string trace(std::size_t lines = 20) const;
    /// Returns the hook that peers on secured channels need in their environment, for faults and
    /// trace to read what they send. The hosts of this library have it.
    [[nodiscard]] channel::ChunkHook& chunk_hook();
    /// Sets the observer of all later connections; may be null.
    void set_observer(std::shared_ptr<LinkObserver> observer) { observer_ = std::move(observer); }

    /// Cuts all connections.
    void cut();
    /// From now on, and until it is called with false, every connection is refused.
    void refuse(bool refuses = true) { refuses_ = refuses; }
    /// Number of connections so far.
    [[nodiscard]] std::size_t connection_count() const { return connection_count_; }

private:
    void begin(const std::shared_ptr<Link>& link);
    Result<std::shared_ptr<Link>> connect_plainly(Acceptor&, LinkEnd&, std::string_view address);
    /// Lets a fault that was played act now on all connections.
    void act(std::size_t index);
    /// ", there is opc.tcp://server:4840".
    [[nodiscard]] std::string listeners() const;

    void log(const std::string& text);

    Scheduler* scheduler_;
    LogSink* log_;
    std::uint64_t seed_;
    Weather weather_;
    std::map<std::string, Weather, std::less<>> weathers_;
    std::map<std::string, std::string, std::less<>> client_names_;
    std::map<std::string, Acceptor*> acceptors_;
    std::vector<std::string> exempt_;
    Weather no_weather_;
    std::shared_ptr<detail::Timeline> timeline_;
    std::shared_ptr<detail::ChunkTap> tap_;
    std::shared_ptr<detail::ActingFaults> faults_;
    std::shared_ptr<LinkObserver> observer_;
    /// Each has the number of its connection.
    std::vector<std::pair<std::size_t, std::weak_ptr<Link>>> links_;
    std::size_t connection_count_{0};
    bool refuses_{false};
    bool forgives_pending_{false};
};

} // namespace busbar::harness
