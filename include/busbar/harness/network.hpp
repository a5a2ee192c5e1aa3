#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/harness/fault.hpp>
#include <busbar/harness/jumping_clock.hpp>
#include <busbar/harness/link.hpp>

namespace busbar::harness {

namespace detail {
class ActingFaults;
} // namespace detail

/// Somebody who listens on a network.
class BUSBAR_API Acceptor {
public:
    Acceptor() = default;
    Acceptor(const Acceptor&) = delete;
    Acceptor& operator=(const Acceptor&) = delete;
    virtual ~Acceptor() = default;

    /// Gives the link its server's end; false if there is no room.
    [[nodiscard]] virtual bool accept(const std::shared_ptr<Link>& link,
                                      std::string_view peer_address) = 0;
};

/// Hosts, ports and connections in memory. One thread; scheduler and clock must outlive it.
class BUSBAR_API Network {
public:
    Network(Scheduler& scheduler, JumpingClock& clock, std::uint64_t seed);
    ~Network();
    Network(const Network&) = delete;
    Network& operator=(const Network&) = delete;

    /// From now on whoever connects to the host and port of `url` ("opc.tcp://host:port/path")
    /// comes to `acceptor`, which must outlive the network or be removed by unlisten().
    /// Bad_TcpEndpointUrlInvalid.
    Result<void> listen(std::string_view url, Acceptor& acceptor);
    /// From now on nobody comes to `acceptor`; existing connections stay.
    void unlisten(const Acceptor& acceptor);

    /// Connects at once; an engine for which that takes time waits before. `client` must exist as
    /// long as Link::attach says; call Link::flush when it has something to send.
    /// Bad_ConnectionRejected if nobody listens there, the acceptor has no room, or the connection
    /// is refused.
    [[nodiscard]] Result<std::shared_ptr<Link>>
    connect(std::string_view url, LinkEnd& client, std::string_view client_address = "192.0.2.1");

    /// What the network does to all its connections; changed at any time.
    [[nodiscard]] Weather& weather() { return weather_; }
    /// Makes the script happen, in addition to those that were played before.
    void play(const FaultScript& script);
    void play(const Fault& fault) { play(FaultScript{fault}); }
    /// The faults of all scripts that have not acted even once, one a line: a test whose fault
    /// never came proves nothing.
    [[nodiscard]] std::string pending_faults() const;
    /// Sets who is told what happens on all later connections; null for nobody.
    void set_observer(std::shared_ptr<LinkObserver> observer) { observer_ = std::move(observer); }

    /// Cuts all connections.
    void cut();
    /// From now on, and until it is called with false, every connection is refused.
    void refuse(bool refuses = true) { refuses_ = refuses; }
    /// How many connections were made.
    [[nodiscard]] std::size_t connection_count() const { return connection_count_; }

private:
    void begin(const std::shared_ptr<Link>& link);
    void act(const Fault& fault, std::size_t& acted);

    Scheduler* scheduler_;
    std::uint64_t seed_;
    Weather weather_;
    std::map<std::string, Acceptor*> acceptors_;
    std::shared_ptr<detail::ActingFaults> faults_;
    std::shared_ptr<LinkObserver> observer_;
    std::vector<std::weak_ptr<Link>> links_;
    std::size_t connection_count_{0};
    bool refuses_{false};
};

} // namespace busbar::harness
