#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <string>
#include <vector>

#include <busbar/crypto/self_signed.hpp>
#include <busbar/harness/bench.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "product/machine/lookout.hpp"
#include "product/machine/ticker.hpp"
#include "support/identity.hpp"

namespace lookout_test {

using namespace busbar;
using product::Lookout;
using namespace std::chrono_literals;

namespace {

constexpr std::int64_t ticks_of_a_day = 86'400 * DateTime::ticks_per_second;

/// The objects that outlive the server.
struct Parts {
    Parts() { log.keeps_records = true; }
    [[nodiscard]] harness::BenchOptions options()
    {
        harness::BenchOptions options;
        options.server = harness::secured_server_config();
        options.server.host_names = hosts;
        options.server_parts.log = &log;
        return options;
    }

    const channel::ApplicationIdentity& identity{harness::default_server_identity()};
    std::vector<std::string> hosts{identity.certificates.front().host_names()};
    test::LogBook log;
};

/// A server whose machine has addresses that change, and the list of its clients.
struct LookoutWorld : Parts, harness::Bench {
    LookoutWorld() : Bench{options()} {}

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

    storage::MemoryStorage files;
    crypto::CertificateStore store{files, {}, log};
    int changes{0};
    Lookout lookout{
        server(), &store, world().clock(), log, [this] { return hosts; }, [this] { ++changes; }};
};

using Kinds = std::vector<std::string>;

} // namespace

TEST_CASE_METHOD(LookoutWorld, "lookout: another address is told as one that the certificate lacks")
{
    static_cast<void>(told());
    lookout.look();
    CHECK(told() == Kinds{});
    CHECK(changes == 0);
    hosts.push_back("192.0.2.99");
    lookout.look();
    CHECK(server().config().host_names == hosts);
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
    world().jump_clock(-24h);
    lookout.look();
    CHECK(told() == Kinds{});
    world().jump_clock(48h);
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
