#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <asio/any_io_executor.hpp>

#include <busbar/client/client.hpp>

#include "clock.hpp"
#include "connector.hpp"
#include "link.hpp"
#include "memory_return.hpp"
#include "reverse_queue.hpp"

namespace busbar::net::detail {

/// A Client's connection, as an engine for a Link. Once it leaves, it has the rest of the Client's
/// output and a little time to send it: the Client may have a new connection meanwhile.
class ClientLine {
public:
    ClientLine(client::Client& client, std::uint64_t order) : client_{&client}, order_{order} {}

    [[nodiscard]] std::uint64_t order() const { return order_; }
    void leave(TimePoint until, bool awaits_peer);
    /// The peer has had its time to end the connection.
    void stop_waiting() { awaits_peer_ = false; }
    [[nodiscard]] bool awaits_peer() const { return awaits_peer_; }
    /// True if everything was sent, while the peer may still send.
    [[nodiscard]] bool has_said_all() const { return awaits_peer_ && output().empty(); }
    /// The Client has not yet processed its input: a server that sends too fast has to wait, and
    /// holds no memory here.
    void set_busy(bool is_busy) { is_busy_ = is_busy; }
    [[nodiscard]] bool has_enough() const { return is_busy_; }

    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    [[nodiscard]] std::span<const std::byte> output() const;
    void consume(std::size_t size);
    [[nodiscard]] TimePoint next_deadline() const { return until_; }
    void handle_deadline(TimePoint now);
    [[nodiscard]] bool is_closed() const { return client_ == nullptr && !awaits_peer_; }

private:
    client::Client* client_; // null once it leaves
    std::uint64_t order_;
    std::vector<std::byte> rest_;
    std::size_t sent_{0};
    bool is_busy_{false};
    bool awaits_peer_{false};
    TimePoint until_{no_deadline};
};

/// Carries out the orders of one Client: connections, bytes, time. Everything happens on the
/// executor, in small steps. Exceptions of a user's callback are logged, and the next one is
/// called.
class ClientDriver : public std::enable_shared_from_this<ClientDriver> {
public:
    /// `environment` must outlive the object; it needs a log. stop() must be called before the last
    /// owner is destroyed.
    ClientDriver(const asio::any_io_executor& executor, client::ClientConfig config,
                 const channel::ChannelEnvironment& environment, Lookup lookup = system_lookup);
    ClientDriver(const ClientDriver&) = delete;
    ClientDriver& operator=(const ClientDriver&) = delete;
    ~ClientDriver() = default;

    [[nodiscard]] client::Client& client() { return client_; }
    /// Takes connections from `queue` if the configuration says that the server connects to us.
    void take_from(std::shared_ptr<ReverseQueue> queue);
    /// Called after each step.
    void on_step(std::function<void()> handler) { on_step_ = std::move(handler); }
    /// Schedules a step.
    void wake();
    /// Handles a bounded number of occurrences, and schedules the rest. Does nothing when called
    /// from a handler of the Client, for which is_stepping() is true.
    void step();
    [[nodiscard]] bool is_stepping() const { return is_stepping_; }
    /// True while there is a connection, even one that only sends its last bytes.
    [[nodiscard]] bool has_connection() const { return link_ || !leaving_.empty(); }
    /// Drops every connection at once; no handler is called any more.
    void stop();

private:
    using ClientLink = SocketLink<ClientLine>;

    [[nodiscard]] bool poll();
    void await_deadline();
    void carry_out(const client::TransportOrder& order);
    void open(const client::TransportOrder& order);
    void open_reverse(std::uint64_t order);
    void opened(std::uint64_t order, asio::ip::tcp::socket socket, std::span<const std::byte> in);
    void failed(std::uint64_t order, const Unreached& why);
    void drop(bool awaits_peer);
    void end_waiting();
    void ended(ClientLink& link);
    void log(const std::string& text);

    asio::any_io_executor executor_;
    LogSink* log_;
    Duration connect_timeout_;
    bool is_reverse_;
    ExpectedServer expected_;
    client::Client client_;
    Connector connector_;
    std::shared_ptr<ReverseQueue> queue_;
    ReverseQueue::Ticket ticket_{0};
    DeadlineTimer timer_;
    /// Waits only while there is a connection: no loop has to run longer for it.
    MemoryReturn memory_return_;
    std::shared_ptr<ClientLink> link_;
    std::vector<std::shared_ptr<ClientLink>> leaving_;
    std::function<void()> on_step_;
    bool is_woken_{false};
    bool is_stepping_{false};
    bool has_stopped_{false};
};

} // namespace busbar::net::detail
