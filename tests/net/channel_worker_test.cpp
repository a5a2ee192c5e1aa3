#include <catch2/catch.hpp>

#include <array>
#include <atomic>
#include <functional>
#include <future>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <busbar/core/record.hpp>
#include <busbar/net/worker_thread.hpp>
#include <busbar/server/worker.hpp>

#include "machine.hpp"
#include "support/identity.hpp"

namespace channel_worker_test {

// Channels whose asymmetric work is done on a thread of its own.

using namespace busbar;
using namespace std::chrono_literals;

namespace {

/// Counts what becomes of channels.
class ChannelCount final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view) override {}
    [[nodiscard]] bool wants(RecordKind kind) const override
    {
        return kind == RecordKind::ChannelOpened || kind == RecordKind::ChannelRenewed;
    }
    void record(const Record& record) override
    {
        opened += record.kind == RecordKind::ChannelOpened ? 1 : 0;
        renewed += record.kind == RecordKind::ChannelRenewed ? 1 : 0;
    }

    std::atomic<int> opened{0};
    std::atomic<int> renewed{0};
};

const channel::SecuritySetting secured{crypto::find_policy_by_name("Basic256Sha256"),
                                       MessageSecurityMode::SignAndEncrypt};

/// Counts the jobs that it has taken.
class CountingWorker final : public server::Worker {
public:
    [[nodiscard]] bool run(std::function<void()> job) override
    {
        const bool is_taken = thread_.run(std::move(job));
        taken += is_taken ? 1 : 0;
        return is_taken;
    }

    std::atomic<int> taken{0};

private:
    net::WorkerThread thread_;
};

/// A server with a secured endpoint on a thread of its own.
class SecuredMachine {
public:
    SecuredMachine() : port_{*loop_.listen("127.0.0.1", 0)}
    {
        auto config = test::server_config(port_);
        config.application_uri = "urn:busbar:test:server";
        config.identity = test::server_identity();
        config.endpoints[0].security = secured;
        config.limits.channel_interval = 0ms;
        config.limits.failed_channel_interval = 0ms;
        config.limits.min_token_lifetime = 2s;
        server_.emplace(*server::Server::create(config, {.random = &random_,
                                                         .wall_clock = &clock_,
                                                         .log = &log,
                                                         .validator = &validator_,
                                                         .waker = &loop_.waker(),
                                                         .channel_worker = &worker}));
        thread_ = std::thread{[this] { loop_.run(*server_); }};
    }
    ~SecuredMachine() { stop(); }
    void stop()
    {
        if (thread_.joinable()) {
            loop_.stop();
            thread_.join();
        }
    }
    [[nodiscard]] std::string url() const { return "opc.tcp://127.0.0.1:" + std::to_string(port_); }

    ChannelCount log;

private:
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    crypto::InsecureAcceptAnyCertificate validator_;
    net::ServerLoop loop_{log};
    std::uint16_t port_;
    std::optional<server::Server> server_;

public:
    CountingWorker worker; // ends first

private:
    std::thread thread_;
};

/// A client with a session.
struct Visitor : test::ClientSurroundings {
    Result<void> connect(const std::string& url, std::chrono::milliseconds token_lifetime = 1h,
                         Duration patience = 10s)
    {
        environment.identity = &test::client_identity();
        environment.validator = &validator;
        client::ConnectionConfig config;
        config.application_uri = "urn:busbar:test:client";
        config.channel.endpoint_url = url;
        config.channel.security = secured;
        config.channel.server_certificate = test::server_identity().certificates.front();
        config.channel.requested_lifetime = token_lifetime;
        config.channel.limits.handshake_timeout = patience;
        if (auto begun = loop.connect(config, environment); !begun) {
            return begun;
        }
        return loop.wait_until_ready();
    }
    [[nodiscard]] bool read()
    {
        const auto event = loop.call(test::read_request(test::state_node));
        return event && event->status.is_good();
    }

    crypto::InsecureAcceptAnyCertificate validator;
    net::ClientLoop loop;
};

} // namespace

TEST_CASE("a worker's thread opens and renews channels while others are served")
{
    SecuredMachine machine;
    std::atomic<int> failures{0};
    std::vector<std::thread> others;
    for (int i = 0; i < 3; ++i) {
        others.emplace_back([&] {
            for (int k = 0; k < 5; ++k) {
                Visitor visitor;
                failures += visitor.connect(machine.url()) && visitor.read() ? 0 : 1;
                if (k % 2 == 0) {
                    visitor.loop.close();
                }
            }
        });
    }
    std::optional<Visitor> renewing;
    while (machine.log.renewed < 1) {
        // A machine that is too slow for such a lifetime ends the channel: then with another one.
        if (!renewing || !renewing->read()) {
            renewing.emplace();
            static_cast<void>(renewing->connect(machine.url(), 2s));
        }
        static_cast<void>(renewing->loop.wait(20ms)); // it renews while it waits
    }
    for (std::thread& other : others) {
        other.join();
    }
    CHECK(failures == 0);
    CHECK(machine.log.opened >= 16);
}

TEST_CASE("a server stops while its worker has channels")
{
    std::promise<void> begun;
    std::promise<void> go_on;
    SecuredMachine machine; // whose worker ends before these
    REQUIRE(machine.worker.run([&] {
        begun.set_value();
        go_on.get_future().wait();
    }));
    begun.get_future().wait();
    const auto connect = [&] {
        Visitor visitor;
        return visitor.connect(machine.url(), 1h, 2s).has_value();
    };
    auto first = std::async(std::launch::async, connect);
    auto second = std::async(std::launch::async, connect);
    SECTION("with the work still waiting")
    {
        // Until the worker has the jobs of both channels, or a client on a slow machine gave up.
        while (machine.worker.taken < 3 && first.wait_for(1ms) != std::future_status::ready) {
        }
        machine.stop();
        CHECK_FALSE(first.get());
        CHECK_FALSE(second.get());
        go_on.set_value();
    }
    SECTION("or just being done")
    {
        go_on.set_value();
        machine.stop();
        first.wait();
        second.wait();
    }
}

} // namespace channel_worker_test
