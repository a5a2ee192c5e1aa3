#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <string>
#include <vector>

#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/server/server.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "product/machine/lookout.hpp"
#include "product/machine/ticker.hpp"
#include "support/identity.hpp"

namespace lookout_test {

using namespace busbar;
using product::Lookout;

namespace {

constexpr std::int64_t ticks_of_a_day = 86'400 * DateTime::ticks_per_second;

class NobodyLogsIn final : public server::UserStore {
public:
    Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        return fail(status::Bad_UserAccessDenied);
    }
    server::UserIdentity anonymous() const override { return server::anonymous_reader(); }
};

/// A server whose machine has addresses that change, and the list of its clients.
struct LookoutWorld {
    LookoutWorld() { log.keeps_records = true; }

    [[nodiscard]] server::Server make_server()
    {
        server::ServerConfig config;
        config.application_uri = "urn:busbar:test:server";
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.identity = test::server_identity();
        config.host_names = hosts;
        return server::Server::create(config, {.random = &random,
                                               .wall_clock = &clock,
                                               .log = &log,
                                               .validator = &validator,
                                               .users = &users})
            .value();
    }
    /// The kinds of record that came since the last call.
    [[nodiscard]] std::vector<std::string> told()
    {
        std::vector<std::string> kinds;
        for (const std::string& line : log.records) {
            kinds.push_back(line.substr(0, line.find(' ')));
        }
        log.records.clear();
        return kinds;
    }
    void trust_until(DateTime end)
    {
        crypto::CertificateSubject subject;
        subject.common_name = "Panel";
        subject.application_uri = "urn:panel";
        subject.valid_days = 10;
        subject.valid_from = DateTime{end.ticks - 10 * ticks_of_a_day};
        const auto panel = crypto::create_self_signed(test::client_identity().key, subject);
        REQUIRE(store.add(crypto::StoreList::Trusted, panel->der()));
    }

    std::vector<std::string> hosts{test::server_identity().certificates.front().host_names()};
    crypto::SystemRandom random;
    test::FixedWallClock clock;
    test::LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    NobodyLogsIn users;
    storage::MemoryStorage files;
    crypto::CertificateStore store{files, {}, log};
    server::Server server{make_server()};
    int changes{0};
    Lookout lookout{server, &store, clock, log, [this] { return hosts; }, [this] { ++changes; }};
};

using Kinds = std::vector<std::string>;

} // namespace

TEST_CASE_METHOD(LookoutWorld, "lookout: another address is told as one that the certificate lacks")
{
    server.start(TimePoint{});
    static_cast<void>(told());
    lookout.look();
    CHECK(told() == Kinds{});
    CHECK(changes == 0);
    hosts.push_back("192.0.2.99");
    lookout.look();
    CHECK(server.config().host_names == hosts);
    CHECK(told() == Kinds{"CertificateHostNotNamed", "SettingsChanged"});
    CHECK(log.text.find("does not name 192.0.2.99, by which clients") != std::string::npos);
    lookout.look();
    CHECK(changes == 1);
    CHECK(told() == Kinds{});
    // Back to the old address, and all is well.
    hosts.pop_back();
    lookout.look();
    CHECK(told() == Kinds{"SettingsChanged"});
    CHECK(changes == 2);
}

TEST_CASE_METHOD(LookoutWorld, "lookout: a client's certificate that expires is told (5-1-1)")
{
    REQUIRE(store.create());
    trust_until(test::today);
    static_cast<void>(told());
    clock.time = DateTime{test::today.ticks - ticks_of_a_day};
    lookout.look();
    CHECK(told() == Kinds{});
    clock.time = DateTime{test::today.ticks + ticks_of_a_day};
    lookout.look();
    CHECK(told() == Kinds{"CertificateExpired"});
    CHECK(log.text.find("CN=Panel") != std::string::npos);
    lookout.look();
    CHECK(told() == Kinds{});
    // One that comes, and is too old already.
    trust_until(DateTime{test::today.ticks - ticks_of_a_day});
    static_cast<void>(told());
    lookout.look();
    CHECK(told() == Kinds{"CertificateExpired"});
}

TEST_CASE("ticker: it ticks at once, and not any more when it is gone")
{
    std::atomic<int> ticks{0};
    {
        const product::Ticker ticker{[&] {
            ++ticks;
            return std::chrono::hours{1};
        }};
    }
    CHECK(ticks <= 1);
    const int before = ticks;
    {
        const product::Ticker ticker{[&] {
            ++ticks;
            ticks.notify_all();
            return std::chrono::hours{1};
        }};
        ticks.wait(before);
    }
    CHECK(ticks == before + 1);
}

TEST_CASE("ticker: it ticks again after the pause that is asked for")
{
    std::atomic<int> ticks{0};
    const product::Ticker ticker{[&] {
        ++ticks;
        ticks.notify_all();
        return ticks < 3 ? std::chrono::milliseconds{1} : std::chrono::hours{1};
    }};
    for (int seen = 0; seen < 3; seen = ticks) {
        ticks.wait(seen);
    }
    CHECK(ticks == 3);
}

} // namespace lookout_test
