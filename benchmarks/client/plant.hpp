#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/client/client.hpp>
#include <busbar/client/connection.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/harness/jumping_clock.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/server.hpp>

#include "stopwatch.hpp"

namespace busbar::bench {

inline constexpr std::uint32_t variable_count = 25'000;

/// Ends the program: figures of something that failed are worth nothing.
[[noreturn]] void give_up(std::string_view what, StatusCode status);

template <typename T>
T expect(std::string_view what, Result<T> result)
{
    if (!result) {
        give_up(what, result.error());
    }
    return *std::move(result);
}

template <typename T>
T expect(std::string_view what, Configured<T> made)
{
    if (!made) {
        give_up(std::string{what} + ", " + text(made.error()), made.error().status);
    }
    return *std::move(made);
}

class FixedClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return time; }
    DateTime time{harness::first_day};
};

class NoWaker final : public server::Waker {
public:
    void wake() override {}
};

/// A server with many variables "ns=1;i=0" and so on, and whoever talks to it.
class Plant {
public:
    explicit Plant(bool is_secure);

    [[nodiscard]] channel::ChannelEnvironment client_environment()
    {
        return {.random = &random_,
                .wall_clock = &clock_,
                .log = &log_,
                .validator = &validator_,
                .identity = client_identity_ ? &*client_identity_ : nullptr};
    }
    [[nodiscard]] client::ClientConfig client_config() const;
    [[nodiscard]] client::ConnectionConfig connection_config() const;

    void accept() { connection_.emplace(expect("a connection", server_->connect("::1", now))); }
    void drop() { connection_.reset(); }
    /// Carries what the client has sent to the server and back. True if there was anything.
    template <typename Engine>
    bool carry(Engine& engine, Stopwatch& watch)
    {
        const std::vector<std::byte> request{engine.output().begin(), engine.output().end()};
        watch.time([&] { engine.consume(request.size()); });
        static_cast<void>(connection_->feed(request, now));
        while (connection_->next_deadline() <= now) { // large requests are carried out in turns
            connection_->handle_deadline(now);
        }
        while (connection_->next_event()) {
        }
        const std::vector<std::byte> response{connection_->output().begin(),
                                              connection_->output().end()};
        connection_->consume(response.size());
        watch.time([&] { static_cast<void>(engine.feed(response, now)); });
        return !request.empty() || !response.empty();
    }
    void pass(Duration time);
    void set_all(std::uint32_t value);

    TimePoint now{};

private:
    void create_server();
    void add_variables();

    FixedClock clock_;
    crypto::SystemRandom random_;
    NullLog log_;
    NoWaker waker_;
    crypto::InsecureAcceptAnyCertificate validator_;
    channel::SecuritySetting security_;
    std::optional<channel::ApplicationIdentity> client_identity_;
    std::optional<channel::ApplicationIdentity> server_identity_;
    server::MemorySource memory_{clock_};
    std::optional<server::Server> server_;
    std::optional<server::Connection> connection_;
};

} // namespace busbar::bench
