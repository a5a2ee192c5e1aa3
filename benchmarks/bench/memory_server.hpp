#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <busbar/client/connection.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/server.hpp>

namespace busbar::bench {

class Guest;

/// A server and its clients in one thread, without sockets and without security. Its time stands
/// still; what is counted is processor time that the server takes, with decoding and encoding, and
/// with what a program that drives it calls after each activity.
class MemoryServer {
public:
    MemoryServer();
    MemoryServer(const MemoryServer&) = delete;
    MemoryServer& operator=(const MemoryServer&) = delete;
    ~MemoryServer();

    /// Adds variables until there are so many: Double, below the Objects folder.
    void add_variables(std::size_t count);
    /// A client with a session of its own.
    [[nodiscard]] Result<std::unique_ptr<Guest>> admit();

    /// Microseconds since it was asked the last time.
    [[nodiscard]] double take_time_us();
    /// The node of a variable.
    [[nodiscard]] NodeId node(std::size_t number) const;

private:
    friend class Guest;

    class Clock;
    /// Runs `work`, and has the server do all that it has to do now.
    template <typename Work>
    void timed(Work&& work);

    std::unique_ptr<Clock> clock_;
    crypto::SystemRandom random_;
    NullLog log_;
    TimePoint now_{};
    server::MemorySource source_;
    std::optional<server::Server> server_;
    std::uint32_t source_index_{0};
    std::uint16_t namespace_index_{0};
    std::size_t variables_{0};
    double time_us_{0};
};

/// One client of a MemoryServer, which must outlive it.
class Guest {
public:
    /// Sends the request and carries bytes until its response is there, whose texts are valid until
    /// the next call.
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> call(Request& request)
    {
        const auto sent = client_.send(request);
        if (!sent) {
            return fail(sent.error());
        }
        event_ = wait();
        return event_.kind == client::ConnectionEvent::Kind::Response
                   ? event_.response<Response>(generous())
                   : fail(event_.status);
    }

private:
    friend class MemoryServer;

    Guest(MemoryServer& host, server::Connection connection, client::Connection client);
    [[nodiscard]] static binary::DecodeLimits generous();
    /// Closed with Bad_Timeout if neither side has anything to say.
    [[nodiscard]] client::ConnectionEvent wait();

    MemoryServer* host_;
    server::Connection connection_;
    client::Connection client_;
    client::ConnectionEvent event_;
};

} // namespace busbar::bench
