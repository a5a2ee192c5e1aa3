#include <catch2/catch.hpp>

#include <algorithm>
#include <list>
#include <string>

#include "session_use.hpp"

namespace assembly_shares_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t message = 1U << 20U;

server::ServerConfig small_assembly()
{
    auto config = ServerFixture::insecure_config();
    config.limits.transport.max_message_size = message;
    config.limits.max_assembly = 4 * message;
    return config;
}

struct AssemblyShares : ServerFixture {
    AssemblyShares() : ServerFixture{small_assembly()} {}

    TestClient log_in_from(const std::string& address)
    {
        TestClient client = connect({}, client_identity(), address);
        REQUIRE(client.open_session() == status::Good);
        return client;
    }
    /// Sends so much of a message and not its end.
    void hold(TestClient& client, std::size_t size)
    {
        const std::vector<std::byte> body(size);
        REQUIRE(client.channel.send([&](binary::Writer& writer) { writer.bytes(body); }));
        const auto bytes = take_output(client.channel);
        std::span<const std::byte> rest{bytes.data(), bytes.size() - 1};
        while (!rest.empty() && !client.is_closed()) {
            const auto part = rest.first(std::min<std::size_t>(rest.size(), 65'536));
            static_cast<void>(client.connection.feed(part, now));
            rest = rest.subspan(part.size());
        }
    }
    /// A request of two chunks.
    static StatusCode use_much(TestClient& client)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = NodeId{1, std::string(100'000, 'x')};
        const auto response = client.call<ReadResponse>(request);
        return response ? StatusCode{} : response.error();
    }
};

} // namespace

TEST_CASE("unfinished messages of a few end nobody else's requests")
{
    AssemblyShares fixture;
    auto good = fixture.log_in();
    std::list<TestClient> greedy;
    for (int i = 0; i < 6; ++i) {
        greedy.push_back(fixture.log_in_from("192.0.2." + std::to_string(60 + i)));
        fixture.hold(greedy.back(), message - 1'000);
        CHECK(AssemblyShares::use_much(good) == status::Good);
    }
    CHECK_FALSE(good.is_closed());
    const auto closed = std::count_if(greedy.begin(), greedy.end(),
                                      [](const TestClient& client) { return client.is_closed(); });
    CHECK(closed == 3); // a quarter of the limit is left for others
    CHECK(greedy.front().is_closed());
    greedy.front().run();
    CHECK(fixture.log.text.find("place for unfinished messages failed: this connection holds ") !=
          std::string::npos);
}

TEST_CASE("of unfinished messages those of the greediest network are given up")
{
    AssemblyShares fixture;
    std::list<TestClient> many; // each holds less than the one
    for (int i = 0; i < 8; ++i) {
        many.push_back(fixture.log_in_from("192.0.2.66"));
        fixture.hold(many.back(), 320'000);
    }
    auto one = fixture.log_in_from("192.0.2.7");
    fixture.hold(one, 600'000);
    CHECK_FALSE(one.is_closed());
    auto other = fixture.log_in_from("192.0.2.8");
    fixture.hold(other, 600'000);
    CHECK_FALSE(one.is_closed());
    CHECK_FALSE(other.is_closed());
    CHECK(many.front().is_closed());
    CHECK_FALSE(many.back().is_closed());
}

TEST_CASE("strangers hold no more than the messages that they may send")
{
    AssemblyShares fixture;
    auto stranger = fixture.connect({}, client_identity(), "192.0.2.66");
    fixture.hold(stranger, 2U * server::ServerLimits{}.max_sessionless_message);
    CHECK(stranger.is_closed());
}

} // namespace assembly_shares_test
