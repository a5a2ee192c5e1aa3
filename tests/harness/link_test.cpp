#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <optional>

#include <busbar/harness/link.hpp>
#include <busbar/harness/world.hpp>

namespace link_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

/// Sends what it is told to, and notes what comes and when.
struct NotingEnd final : LinkEnd {
    explicit NotingEnd(World& of) : world{of} {}

    [[nodiscard]] std::span<const std::byte> output() const override { return out; }
    void consume(std::size_t size) override
    {
        out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size));
    }
    void feed(std::span<const std::byte> in) override
    {
        came.insert(came.end(), in.begin(), in.end());
        pieces.push_back(in.size());
        last = world.now();
    }
    void link_lost() override { lost = world.now(); }

    World& world;
    std::vector<std::byte> out;
    std::vector<std::byte> came;
    std::vector<std::size_t> pieces;
    TimePoint last{};
    std::optional<TimePoint> lost;
};

std::vector<std::byte> numbered(std::size_t size)
{
    std::vector<std::byte> bytes(size);
    for (std::size_t i = 0; i < size; ++i) {
        bytes[i] = static_cast<std::byte>(i);
    }
    return bytes;
}

/// Two ends and the link between them.
struct Pair {
    explicit Pair(World& of, std::uint64_t stream = 1)
        : world{of}, client{of}, server{of}, link{std::make_shared<Link>(of.scheduler(),
                                                                         of.network().weather(),
                                                                         Chance{5, stream})}
    {
        link->attach(Side::Client, client);
        link->attach(Side::Server, server);
    }
    void send(std::size_t size)
    {
        client.out = numbered(size);
        link->flush(Side::Client);
    }

    World& world;
    NotingEnd client;
    NotingEnd server;
    std::shared_ptr<Link> link;
};

/// Takes whom it is told to.
struct Door final : Acceptor {
    explicit Door(World& world) : end{world} {}
    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link, std::string_view) override
    {
        ++asked;
        if (is_open) {
            link->attach(Side::Server, end);
        }
        return is_open;
    }

    NotingEnd end;
    bool is_open{true};
    int asked{0};
};

} // namespace

TEST_CASE("bytes wait until somebody is at the other end", "[harness]")
{
    World world;
    NotingEnd client{world};
    NotingEnd server{world};
    const auto link =
        std::make_shared<Link>(world.scheduler(), world.network().weather(), Chance{1, 1});
    link->attach(Side::Client, client);
    client.out = numbered(10);
    link->flush(Side::Client);
    CHECK(client.out.size() == 10);
    link->attach(Side::Server, server);
    link->flush(Side::Client);
    CHECK(client.out.empty());
    world.run_for(1s);
    CHECK(server.came == numbered(10));
    CHECK(server.last == TimePoint{1ms});
}

TEST_CASE("bytes arrive in order, whatever the weather", "[harness]")
{
    World world;
    Weather& weather = world.network().weather();
    SECTION("random cuts")
    {
        weather.has_random_cuts = true;
        weather.max_latency = 50ms;
    }
    SECTION("random cuts and stalls")
    {
        weather.has_random_cuts = true;
        weather.stall_one_in = 2;
        weather.max_stall = 1s;
    }
    SECTION("stalls of whole bursts")
    {
        weather.stall_one_in = 2;
        weather.max_stall = 1s;
    }
    SECTION("small pieces")
    {
        weather.max_piece = 7;
    }
    Pair pair{world};
    std::vector<std::byte> sent;
    for (std::size_t i = 1; i <= 20; ++i) {
        const auto burst = numbered(10 * i);
        sent.insert(sent.end(), burst.begin(), burst.end());
        pair.send(burst.size());
        world.run_for(10ms);
    }
    world.run_for(5s);
    CHECK(pair.server.came == sent);
    CHECK(pair.server.pieces.size() >= 20);
    CHECK(*std::max_element(pair.server.pieces.begin(), pair.server.pieces.end()) <=
          std::min<std::size_t>(weather.max_piece, 200));
    CHECK(pair.client.came.empty());
}

TEST_CASE("a burst that is held up arrives late, and not later than that", "[harness]")
{
    World world;
    world.network().weather().stall_one_in = 1;
    world.network().weather().max_stall = 1s;
    Duration most{0};
    for (std::uint64_t i = 0; i < 20; ++i) {
        Pair pair{world, i};
        const TimePoint before = world.now();
        pair.send(3);
        world.run_for(2s);
        REQUIRE(pair.server.came.size() == 3);
        most = std::max(most, pair.server.last - before);
        pair.link->leave(Side::Client);
        pair.link->leave(Side::Server);
    }
    CHECK(most > 500ms);
    CHECK(most <= 1001ms);
}

TEST_CASE("connections die when their time has come, if the weather says so", "[harness]")
{
    World world;
    Weather& weather = world.network().weather();
    weather.mean_life = 10s;
    weather.max_notice = 3s;
    weather.has_resets = GENERATE(true, false);
    std::vector<std::unique_ptr<Pair>> pairs;
    for (std::uint64_t i = 0; i < 50; ++i) {
        pairs.push_back(std::make_unique<Pair>(world, i));
    }
    world.run_for(30s);
    std::size_t young = 0;
    std::size_t late = 0;
    for (const auto& pair : pairs) {
        CHECK(pair->link->is_cut() == weather.has_resets);
        CHECK(pair->client.lost.has_value() == weather.has_resets);
        CHECK(pair->server.lost.has_value() == weather.has_resets);
        if (pair->client.lost && pair->server.lost) {
            CHECK(*pair->client.lost <= TimePoint{23s});
            young += *pair->client.lost <= TimePoint{1s} ? 1U : 0U;
            late += *pair->client.lost != *pair->server.lost ? 1U : 0U;
        }
        pair->send(5); // which nobody gets on a link that is no more
    }
    CHECK((young > 0) == weather.has_resets);
    CHECK((late > 0) == weather.has_resets);
    world.run_for(1s);
    CHECK(pairs[0]->server.came.size() == (weather.has_resets ? 0 : 5));
}

TEST_CASE("a cut loses what is held and what is on its way", "[harness]")
{
    World world;
    Pair pair{world};
    pair.link->hold(Side::Client);
    pair.send(4);
    world.run_for(1s);
    pair.link->hold(Side::Server);
    pair.send(4);
    pair.link->cut();
    world.run_for(1s);
    pair.link->release(Side::Client);
    pair.link->release(Side::Server);
    pair.link->send(Side::Client, numbered(4));
    world.run_for(1s);
    CHECK(pair.server.came.empty());
    CHECK(pair.client.lost == TimePoint{1s});
    CHECK(pair.server.lost == TimePoint{1s});
}

TEST_CASE("a network has hosts and ports, and nothing else", "[harness]")
{
    World world;
    Network& network = world.network();
    Door door{world};
    Door other{world};
    NotingEnd client{world};
    CHECK(network.listen("http://server:1", door).error() == status::Bad_TcpEndpointUrlInvalid);
    REQUIRE(network.listen("opc.tcp://Server:4840/path", door));
    REQUIRE(network.listen("opc.tcp://other:4840", other));
    CHECK(network.connect("no URL", client).error() == status::Bad_ConnectionRejected);
    CHECK(network.connect("opc.tcp://server:4841", client).error() ==
          status::Bad_ConnectionRejected);
    door.is_open = false;
    CHECK(network.connect("opc.tcp://server:4840", client).error() ==
          status::Bad_ConnectionRejected);
    CHECK(door.asked == 1);
    door.is_open = true;
    CHECK(network.connect("opc.tcp://SERVER:4840", client).has_value());
    CHECK(door.asked == 2);
    network.unlisten(door);
    CHECK(network.connect("opc.tcp://server:4840", client).error() ==
          status::Bad_ConnectionRejected);
    CHECK(door.asked == 2);
    CHECK(network.connect("opc.tcp://other:4840", client).has_value());
    CHECK(other.asked == 1);
}

TEST_CASE("a network cuts all its connections at once", "[harness]")
{
    World world;
    Door door{world};
    Door other{world};
    REQUIRE(world.network().listen("opc.tcp://one:1", door));
    REQUIRE(world.network().listen("opc.tcp://two:2", other));
    NotingEnd first{world};
    NotingEnd second{world};
    NotingEnd gone{world};
    const auto link = world.network().connect("opc.tcp://one:1", first);
    const auto another = world.network().connect("opc.tcp://two:2", second);
    REQUIRE((link && another));
    world.run_for(2s);
    world.network().cut();
    world.run_for(1s);
    CHECK(first.lost == TimePoint{2s});
    CHECK(second.lost == TimePoint{2s});
    CHECK(door.end.lost == TimePoint{2s});
    CHECK((*link)->is_cut());
    // A fault that comes later finds nothing to act on.
    world.network().play(fault::cut().after(1s));
    world.network().forgive_pending_faults();
    world.run_for(2s);
    CHECK_FALSE(world.network().pending_faults().empty());
    // The time of day can jump at once, with nobody there.
    const DateTime before = world.clock().now();
    world.network().play(fault::jump_clock(1h));
    CHECK(world.clock().now().ticks - before.ticks == 36'000'000'000);
}

TEST_CASE("a network tells of addresses that nobody has, or two", "[harness]")
{
    World world;
    Door door{world};
    Door other{world};
    NotingEnd end{world};
    REQUIRE(world.network().listen("opc.tcp://server:4840/path", door));
    CHECK(world.network().listen("opc.tcp://SERVER:4840", other).error() ==
          status::Bad_InvalidState);
    CHECK(world.log().contains("another acceptor listens at server:4840 already"));
    CHECK(world.network().listen("opc.tcp://server:4840", door)); // it is the same one

    CHECK(world.network().connect("opc.tcp://sever:4840", end).error() ==
          status::Bad_ConnectionRejected);
    CHECK(world.log().contains("network: there is no listener at opc.tcp://sever:4840; there is "
                               "opc.tcp://server:4840"));
    CHECK(world.account().find("0.000 s network: there is no listener") != std::string::npos);
    world.network().unlisten(door);
    CHECK(world.network().listen("opc.tcp://server:4840", other));
}

TEST_CASE("one client can have a weather of its own", "[harness]")
{
    World world;
    Door door{world};
    REQUIRE(world.network().listen("opc.tcp://one:1", door));
    Weather& slow = world.network().weather_of("192.0.2.9");
    slow.min_latency = slow.max_latency = 3s;
    const auto arrival_from = [&](std::string_view address) {
        NotingEnd end{world};
        const auto link = world.network().connect("opc.tcp://one:1", end, address);
        REQUIRE(link);
        const TimePoint begin = world.now();
        (*link)->send(Side::Client, std::vector<std::byte>(10));
        const Duration time = (*link)->last_arrival(Side::Client) - begin;
        (*link)->leave(Side::Client);
        world.run_for(10s);
        return time;
    };
    CHECK(arrival_from("192.0.2.1") == Duration{1ms});
    CHECK(arrival_from("192.0.2.9") == Duration{3s});
}

TEST_CASE("a link carries so many bytes a second", "[harness]")
{
    World world;
    Weather& weather = world.network().weather();
    weather.bytes_per_second = 1'000;
    const auto link = std::make_shared<Link>(world.scheduler(), weather, Chance{1, 1});
    link->send(Side::Client, std::vector<std::byte>(500));
    CHECK(link->last_arrival(Side::Client) == TimePoint{501ms});
    link->send(Side::Client, std::vector<std::byte>(500)); // waits for the first ones
    CHECK(link->last_arrival(Side::Client) == TimePoint{1'001ms});
    link->send(Side::Server, std::vector<std::byte>(100)); // has a direction of its own
    CHECK(link->last_arrival(Side::Server) == TimePoint{101ms});
}

TEST_CASE("a weather that contradicts itself is told where it is used", "[harness]")
{
    World world;
    world.network().weather().min_latency = 5ms; // and at most 1 ms
    const auto link =
        std::make_shared<Link>(world.scheduler(), world.network().weather(), Chance{1, 1});
    CHECK_THROWS_AS(link->send(Side::Client, std::vector<std::byte>(1)), std::invalid_argument);
    CHECK_THROWS_WITH(link->send(Side::Client, std::vector<std::byte>(1)),
                      Catch::Contains("min_latency 0.005 s is above max_latency 0.001 s"));
    CHECK(Weather{}.flaw() == "");
    Weather weather;
    weather.max_stall = -1s;
    CHECK(weather.flaw() == "max_stall -1.000 s is below 0 s");
    weather = {};
    weather.min_latency = -1s;
    CHECK(weather.flaw() == "min_latency -1.000 s is below 0 s");
    weather = {};
    weather.mean_life = -1s;
    CHECK(weather.flaw() == "mean_life -1.000 s is below 0 s");
    weather = {};
    weather.max_notice = -1s;
    CHECK(weather.flaw() == "max_notice -1.000 s is below 0 s");
}

TEST_CASE("a life that ends is for connections that exist, too", "[harness]")
{
    World world;
    Door door{world};
    NotingEnd end{world};
    REQUIRE(world.network().listen("opc.tcp://one:1", door));
    const auto link = world.network().connect("opc.tcp://one:1", end);
    REQUIRE(link);
    world.run_for(1h);
    CHECK_FALSE((*link)->is_cut());
    world.network().weather().mean_life = 10min;
    (*link)->send(Side::Client, std::vector<std::byte>(1)); // from the next bytes on
    world.run_for(20min);
    CHECK((*link)->is_cut());
}

} // namespace link_test
