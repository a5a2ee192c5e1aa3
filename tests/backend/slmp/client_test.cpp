#include <busbar/backend/slmp_client.hpp>

#include <catch2/catch.hpp>

namespace client_test {

using namespace busbar;
using namespace busbar::backend;
using namespace std::chrono_literals;

namespace {

using Bytes = std::vector<std::byte>;

constexpr std::uint16_t code_d = 0xA8;

SlmpOperation read_d(std::uint32_t number, std::uint16_t points = 1)
{
    return {.command = SlmpCommand::BatchRead, .blocks = {{{code_d, number}, points}}};
}

/// A client and what is needed to answer it by hand.
class Fixture {
public:
    explicit Fixture(SlmpClientOptions options = {}) : client{options} {}

    std::uint64_t send(const SlmpOperation& operation, Duration timeout = {})
    {
        const auto id = client.send(operation, now, timeout);
        REQUIRE(id);
        return *id;
    }
    /// The frames that the client sends now.
    std::vector<Bytes> sent()
    {
        std::vector<Bytes> frames;
        while (!client.output().empty()) {
            const auto output = client.output();
            frames.emplace_back(output.begin(), output.end());
            client.consume(output.size());
        }
        return frames;
    }
    /// The answer to a request frame, with each word as in `words`.
    static Bytes answer_to(const Bytes& request, std::vector<std::uint16_t> words,
                           std::uint16_t end_code = 0)
    {
        const auto head = read_slmp_head(request);
        REQUIRE((head && *head));
        const auto body = read_slmp_request(**head, request);
        REQUIRE(body);
        SlmpAnswer answer{.end_code = end_code, .words = std::move(words)};
        if (end_code != 0) {
            answer.error = {(*head)->station, body->command, body->subcommand};
        }
        const auto frame = encode_slmp_answer(**head, *decode_slmp_request(*body), answer);
        REQUIRE(frame);
        return *frame;
    }
    SlmpEvent next()
    {
        auto event = client.next_event();
        REQUIRE(event);
        return std::move(*event);
    }
    void check_closed(StatusCode reason)
    {
        const auto event = next();
        CHECK(event.kind == SlmpEvent::Kind::Closed);
        CHECK(event.status == reason);
        CHECK_FALSE(event.reason.empty());
        CHECK(client.is_closed());
        CHECK_FALSE(client.next_event());
        CHECK_FALSE(client.feed({}, now));
        CHECK_FALSE(client.send(read_d(1), now));
        CHECK(client.under_way() == 0);
        CHECK(client.next_deadline() == no_deadline);
        CHECK(client.output().empty());
    }

    SlmpClient client;
    TimePoint now{};
};

constexpr SlmpClientOptions three{.frame = SlmpFrame::Frame3E};
constexpr SlmpClientOptions several{.max_under_way = 3};
constexpr SlmpClientOptions datagrams{.is_datagram = true, .max_under_way = 3};

} // namespace

TEST_CASE("an SLMP client matches answers with requests, whole and in pieces")
{
    const auto options = GENERATE(SlmpClientOptions{}, three);
    Fixture plc{options};
    const auto id = plc.send(read_d(100, 2));
    const auto frame = plc.sent().at(0);
    CHECK(plc.client.next_deadline() == plc.now + 5s);
    const auto answer = Fixture::answer_to(frame, {1, 2});
    plc.now += 7ms;
    SECTION("at once")
    {
        CHECK(plc.client.feed(answer, plc.now));
    }
    SECTION("cut at every byte")
    {
        for (const std::byte byte : answer) {
            CHECK_FALSE(plc.client.next_event());
            CHECK(plc.client.feed({&byte, 1}, plc.now));
        }
    }
    const auto event = plc.next();
    CHECK(event.kind == SlmpEvent::Kind::Answer);
    CHECK(event.id == id);
    CHECK(event.status.is_good());
    CHECK(event.answer.words == std::vector<std::uint16_t>{1, 2});
    CHECK(event.round_trip == 7ms);
    CHECK(plc.client.next_deadline() == no_deadline);
    CHECK(plc.client.counters().answers == 1);
}

TEST_CASE("an end code of the PLC is an answer, and the next request goes on")
{
    const auto options = GENERATE(SlmpClientOptions{}, three);
    Fixture plc{options};
    plc.send(read_d(100));
    plc.send(read_d(200));
    CHECK(plc.client.feed(Fixture::answer_to(plc.sent().at(0), {}, 0x4031), plc.now));
    const auto refused = plc.next();
    CHECK(refused.status.is_good());
    CHECK(refused.answer.end_code == 0x4031);
    CHECK(plc.client.feed(Fixture::answer_to(plc.sent().at(0), {7}), plc.now));
    CHECK(plc.next().answer.words == std::vector<std::uint16_t>{7});
}

TEST_CASE("an SLMP client has no more requests under way than configured, and one with 3E")
{
    Fixture plc{several};
    for (std::uint32_t i = 0; i < 5; ++i) {
        CHECK(plc.client.under_way() == std::min(i, 3U));
        plc.send(read_d(i));
    }
    const auto frames = plc.sent();
    CHECK(frames.size() == 3);
    // Answers in another order than the requests.
    CHECK(plc.client.feed(Fixture::answer_to(frames[2], {2}), plc.now));
    CHECK(plc.next().id == 3);
    CHECK(plc.sent().size() == 1);
    CHECK(plc.client.feed(Fixture::answer_to(frames[0], {0}), plc.now));
    CHECK(plc.next().id == 1);

    Fixture one{{.frame = SlmpFrame::Frame3E, .max_under_way = 8}};
    one.send(read_d(1));
    one.send(read_d(2));
    CHECK(one.sent().size() == 1);
}

TEST_CASE("more requests than configured are refused")
{
    Fixture plc{{.max_requests = 3}};
    plc.send(read_d(1));
    plc.send(read_d(2));
    plc.send(read_d(3));
    const auto refused = plc.client.send(read_d(4), plc.now);
    REQUIRE_FALSE(refused);
    CHECK(refused.error() == StatusCode{status::Bad_TooManyOperations});
    const auto impossible = plc.client.send({.command = SlmpCommand::BatchRead}, plc.now);
    CHECK_FALSE(impossible);
    CHECK(plc.client.counters().requests == 1);
}

TEST_CASE("answers that are late, doubled or of a wrong serial number are dropped with 4E")
{
    const auto options = GENERATE(several, datagrams);
    Fixture plc{options};
    plc.send(read_d(1));
    plc.send(read_d(2), 1s);
    const auto frames = plc.sent();
    const auto first = Fixture::answer_to(frames[0], {1});
    CHECK(plc.client.feed(first, plc.now));
    CHECK(plc.client.feed(first, plc.now));
    CHECK(plc.next().id == 1);
    CHECK_FALSE(plc.client.next_event());
    auto wrong = Fixture::answer_to(frames[1], {2});
    wrong[2] ^= std::byte{0x40};
    CHECK(plc.client.feed(wrong, plc.now));
    auto elsewhere = Fixture::answer_to(frames[1], {2});
    elsewhere[7] ^= std::byte{1};
    CHECK(plc.client.feed(elsewhere, plc.now));
    CHECK(plc.client.feed(frames[1], plc.now)); // a request
    CHECK_FALSE(plc.client.next_event());

    CHECK(plc.client.next_deadline() == plc.now + 1s);
    plc.now += 1s;
    plc.client.handle_deadline(plc.now);
    const auto timeout = plc.next();
    CHECK(timeout.id == 2);
    CHECK(timeout.status == StatusCode{status::Bad_Timeout});
    CHECK(plc.client.feed(Fixture::answer_to(frames[1], {2}), plc.now));
    CHECK_FALSE(plc.client.next_event());
    CHECK(plc.client.counters().unexpected == 5);
    CHECK(plc.client.counters().timeouts == 1);
    CHECK_FALSE(plc.client.is_closed());
}

TEST_CASE("a PLC that does not answer any more has lost its connection")
{
    Fixture plc;
    for (std::uint32_t i = 0; i < 4; ++i) {
        plc.send(read_d(i));
    }
    for (std::uint32_t i = 1; i <= 3; ++i) {
        plc.now = plc.client.next_deadline();
        plc.client.handle_deadline(plc.now);
        CHECK(plc.next().id == i);
    }
    CHECK(plc.next().status == StatusCode{status::Bad_Timeout});
    plc.check_closed(status::Bad_Timeout);

    // An answer in between begins the count again.
    Fixture other;
    for (int i = 0; i < 10; ++i) {
        other.send(read_d(1));
        other.sent();
        other.now = other.client.next_deadline();
        other.client.handle_deadline(other.now);
        other.send(read_d(1));
        CHECK(other.client.feed(Fixture::answer_to(other.sent().at(0), {1}), other.now));
    }
    CHECK_FALSE(other.client.is_closed());
}

TEST_CASE("with 3E nothing that could be the answer to another request is taken")
{
    Fixture plc{three};
    const auto first = plc.send(read_d(1, 2));
    const auto frame = plc.sent().at(0);
    SECTION("after a timeout the connection ends")
    {
        plc.send(read_d(2));
        plc.now += 5s;
        plc.client.handle_deadline(plc.now);
        const auto event = plc.next();
        CHECK(event.id == first);
        CHECK(event.status == StatusCode{status::Bad_Timeout});
        CHECK(plc.next().status == StatusCode{status::Bad_Timeout});
        plc.check_closed(status::Bad_Timeout);
    }
    SECTION("an answer twice")
    {
        const auto answer = Fixture::answer_to(frame, {1, 2});
        CHECK(plc.client.feed(answer, plc.now));
        CHECK(plc.next().status.is_good());
        CHECK_FALSE(plc.client.feed(answer, plc.now));
        plc.check_closed(status::Bad_UnknownResponse);
    }
    SECTION("an answer that does not fit")
    {
        auto answer = Fixture::answer_to(frame, {1, 2});
        answer.resize(answer.size() - 2);
        answer[7] = std::byte{4};
        CHECK_FALSE(plc.client.feed(answer, plc.now));
        CHECK(plc.next().status == StatusCode{status::Bad_UnknownResponse});
        plc.check_closed(status::Bad_UnknownResponse);
    }
    SECTION("an error of another command")
    {
        auto answer = Fixture::answer_to(frame, {}, 0xC059);
        answer[16] = std::byte{0x03};
        CHECK_FALSE(plc.client.feed(answer, plc.now));
        CHECK(plc.next().status == StatusCode{status::Bad_UnknownResponse});
        plc.check_closed(status::Bad_UnknownResponse);
    }
}

TEST_CASE("an answer that does not fit ends one request with 4E, and no other")
{
    Fixture plc{several};
    plc.send(read_d(1, 2));
    plc.send(read_d(2, 1));
    const auto frames = plc.sent();
    auto answer = Fixture::answer_to(frames[1], {1});
    answer[2] = frames[0][2];
    CHECK(plc.client.feed(answer, plc.now));
    const auto event = plc.next();
    CHECK(event.id == 1);
    CHECK(event.status == StatusCode{status::Bad_DecodingError});
    CHECK(plc.client.feed(Fixture::answer_to(frames[1], {5}), plc.now));
    CHECK(plc.next().id == 2);
}

TEST_CASE("what is no frame, or too long, ends a stream but no datagrams")
{
    const Bytes ascii{std::byte{'D'}, std::byte{'4'}, std::byte{'0'}};
    Fixture plc;
    plc.send(read_d(1));
    plc.sent();
    CHECK_FALSE(plc.client.feed(ascii, plc.now));
    CHECK(plc.next().status == StatusCode{status::Bad_CommunicationError});
    plc.check_closed(status::Bad_CommunicationError);

    Fixture large{{.max_response = 100}};
    large.send(read_d(1, 100));
    auto answer = Fixture::answer_to(large.sent().at(0), std::vector<std::uint16_t>(100, 1));
    // The head is enough.
    CHECK_FALSE(large.client.feed(std::span{answer}.first(13), large.now));
    CHECK(large.next().status == StatusCode{status::Bad_ResponseTooLarge});
    large.check_closed(status::Bad_ResponseTooLarge);

    Fixture udp{datagrams};
    udp.send(read_d(1));
    const auto right = Fixture::answer_to(udp.sent().at(0), {1});
    CHECK(udp.client.feed(ascii, udp.now));
    CHECK(udp.client.feed({}, udp.now));
    for (std::size_t size = 0; size < right.size(); ++size) {
        CHECK(udp.client.feed(std::span{right}.first(size), udp.now));
        CHECK_FALSE(udp.client.next_event());
    }
    auto two = right;
    two.insert(two.end(), right.begin(), right.end());
    CHECK(udp.client.feed(two, udp.now));
    CHECK_FALSE(udp.client.next_event());
    CHECK(udp.client.feed(right, udp.now));
    CHECK(udp.next().id == 1);
}

TEST_CASE("a lost connection ends every request, and a reset is done then")
{
    Fixture plc{several};
    plc.send(read_d(1));
    plc.send({.command = SlmpCommand::RemoteReset});
    plc.send(read_d(2));
    plc.send(read_d(3));
    plc.client.consume(5);
    plc.client.close(status::Bad_ConnectionClosed, "the test ends it");
    const StatusCode closed{status::Bad_ConnectionClosed};
    CHECK(plc.next().status == closed);
    CHECK(plc.next().status.is_good());
    CHECK(plc.next().status == closed);
    CHECK(plc.next().status == closed);
    plc.check_closed(closed);
    plc.client.close(status::Bad_Timeout, "the test ends it");
    CHECK_FALSE(plc.client.next_event());
}

TEST_CASE("serial numbers of requests that wait are not used again")
{
    Fixture plc{several};
    plc.send(read_d(1));
    const auto first = plc.sent().at(0);
    for (int i = 0; i < 0x10000; ++i) {
        plc.send(read_d(2));
        const auto frame = plc.sent().at(0);
        CHECK((frame[2] != first[2] || frame[3] != first[3]));
        CHECK(plc.client.feed(Fixture::answer_to(frame, {1}), plc.now));
        CHECK(plc.next().status.is_good());
    }
}

} // namespace client_test
