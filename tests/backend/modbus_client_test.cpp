#include <busbar/backend/modbus_client.hpp>

#include <catch2/catch.hpp>

namespace modbus_client_test {

using namespace busbar;
using namespace busbar::backend;
using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;

namespace {

ModbusRequest reading(std::uint16_t address, std::uint16_t quantity = 1)
{
    ModbusRequest request;
    request.address = address;
    request.quantity = quantity;
    return request;
}

ModbusRequest writing(std::uint16_t value)
{
    ModbusRequest request;
    request.function = ModbusFunction::WriteRegister;
    request.values = {value};
    return request;
}

/// A frame that the client has sent.
struct Sent {
    ModbusHeader header{};
    ModbusRequest request{};
};

/// A client, and a peer that says what the test wants it to.
struct Fixture {
    explicit Fixture(ModbusClientOptions options = {}) : client{options} {}

    std::uint64_t send(const ModbusRequest& request, std::uint8_t unit = 1)
    {
        const auto id = client.send(request, unit, now);
        REQUIRE(id);
        return *id;
    }

    /// Takes the frames in the output.
    std::vector<Sent> take_sent()
    {
        std::vector<Sent> frames;
        while (!client.output().empty()) {
            const auto header = parse_modbus_header(client.output());
            REQUIRE((header && *header));
            const auto pdu = client.output().subspan(modbus_header_size, (*header)->pdu_size);
            const auto request = parse_modbus_request(pdu);
            REQUIRE(request);
            frames.push_back({**header, *request});
            client.consume(modbus_header_size + pdu.size());
        }
        return frames;
    }

    static Bytes answer_to(const Sent& sent, std::vector<std::uint16_t> values)
    {
        ModbusResponse response;
        response.values = std::move(values);
        Bytes pdu;
        REQUIRE(encode_modbus(sent.request, response, pdu));
        return frame(sent.header, pdu);
    }

    static Bytes frame(ModbusHeader header, const Bytes& pdu)
    {
        Bytes bytes;
        header.pdu_size = pdu.size();
        encode_modbus(header, bytes);
        bytes.insert(bytes.end(), pdu.begin(), pdu.end());
        return bytes;
    }

    void feed(const Bytes& bytes) { static_cast<void>(client.feed(bytes, now)); }

    void pass(Duration time)
    {
        now += time;
        client.handle_deadline(now);
    }

    /// Requires an answer to this request and returns it.
    ModbusEvent answer(std::uint64_t id)
    {
        const auto event = client.next_event();
        REQUIRE(event);
        CHECK(event->kind == ModbusEvent::Kind::Answer);
        CHECK(event->id == id);
        return *event;
    }

    void check_closed(StatusCode status)
    {
        const auto event = client.next_event();
        REQUIRE(event);
        CHECK(event->kind == ModbusEvent::Kind::Closed);
        CHECK(event->status == status);
        CHECK_FALSE(event->reason.empty());
        CHECK_FALSE(client.next_event());
        CHECK(client.is_closed());
        CHECK(client.next_deadline() == no_deadline);
        CHECK(client.output().empty());
        CHECK(client.send(reading(0), 1, now).error() == status::Bad_ConnectionClosed);
    }

    TimePoint now{1s};
    ModbusClient client;
};

ModbusClientOptions with_under_way(std::size_t count)
{
    ModbusClientOptions options;
    options.max_under_way = count;
    return options;
}

} // namespace

TEST_CASE("A Modbus client has one request under way unless it may have more")
{
    Fixture f;
    const auto first = f.send(reading(1));
    const auto second = f.send(reading(2));
    auto sent = f.take_sent();
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].request.address == 1);
    f.now += 5ms;
    f.feed(Fixture::answer_to(sent[0], {77}));
    const ModbusEvent event = f.answer(first);
    CHECK(event.status == status::Good);
    CHECK(event.answer.values == std::vector<std::uint16_t>{77});
    CHECK(event.round_trip == 5ms);
    sent = f.take_sent();
    REQUIRE(sent.size() == 1);
    f.feed(Fixture::answer_to(sent[0], {78}));
    CHECK(f.answer(second).answer.values[0] == 78);
    CHECK(f.client.counters().requests == 2);
    CHECK(f.client.counters().answers == 2);
}

TEST_CASE("Answers in any order belong to the request with their transaction")
{
    Fixture f{with_under_way(4)};
    std::vector<std::uint64_t> ids;
    for (std::uint16_t i = 0; i < 5; ++i) {
        ids.push_back(f.send(reading(i)));
    }
    const auto sent = f.take_sent();
    REQUIRE(sent.size() == 4);
    for (const std::size_t at : {2U, 0U, 3U, 1U}) {
        f.feed(Fixture::answer_to(sent[at], {sent[at].request.address}));
        CHECK(f.answer(ids[at]).answer.values[0] == at);
    }
    CHECK(f.take_sent().size() == 1);
}

TEST_CASE("Answers that no request waits for are dropped and counted")
{
    Fixture f;
    const auto id = f.send(reading(0));
    const Sent sent = f.take_sent()[0];
    Sent other = sent;
    ++other.header.transaction;
    f.feed(Fixture::answer_to(other, {1}));
    other = sent;
    other.header.unit = 9;
    f.feed(Fixture::answer_to(other, {2}));
    CHECK_FALSE(f.client.next_event());
    f.feed(Fixture::answer_to(sent, {3}));
    f.feed(Fixture::answer_to(sent, {4}));
    CHECK(f.answer(id).answer.values[0] == 3);
    CHECK_FALSE(f.client.next_event());
    CHECK(f.client.counters().unexpected == 2);
    CHECK(f.client.counters().wrong_units == 1);
}

TEST_CASE("A request without an answer times out alone, and its late answer is dropped")
{
    Fixture f{with_under_way(2)};
    const auto lost = f.send(reading(1));
    const Sent first = f.take_sent()[0];
    f.pass(400ms);
    const auto kept = f.send(reading(2));
    const Sent second = f.take_sent()[0];
    CHECK(f.client.next_deadline() == f.now + 600ms);
    f.pass(600ms);
    CHECK(f.answer(lost).status == status::Bad_Timeout);
    CHECK_FALSE(f.client.next_event());
    f.feed(Fixture::answer_to(first, {1}));
    f.feed(Fixture::answer_to(second, {2}));
    CHECK(f.answer(kept).answer.values[0] == 2);
    CHECK(f.client.counters().unexpected == 1);
    CHECK(f.client.counters().timeouts == 1);
}

TEST_CASE("A peer that stays silent for three timeouts is given up, however many are under way")
{
    Fixture f{with_under_way(4)};
    for (int i = 0; i < 12; ++i) {
        f.send(reading(0));
    }
    f.pass(1s);
    f.pass(1s);
    CHECK_FALSE(f.client.is_closed());
    f.pass(1s);
    CHECK(f.client.is_closed());
    for (std::uint64_t id = 1; id <= 12; ++id) {
        CHECK(f.answer(id).status == status::Bad_Timeout);
    }
    f.check_closed(status::Bad_Timeout);

    // Any byte says that it is still there.
    Fixture g;
    for (int i = 0; i < 5; ++i) {
        g.send(reading(0));
        const Sent sent = g.take_sent()[0];
        g.pass(1s);
        g.feed(Fixture::answer_to(sent, {0}));
    }
    CHECK_FALSE(g.client.is_closed());
}

TEST_CASE("An exception is the status of its request")
{
    Fixture f;
    const auto id = f.send(reading(0));
    const Sent sent = f.take_sent()[0];
    f.feed(Fixture::frame(sent.header, {std::byte{0x83}, std::byte{2}}));
    const ModbusEvent event = f.answer(id);
    CHECK(event.status == status::Bad_ConfigurationError);
    CHECK(event.answer.exception == ModbusException::IllegalDataAddress);
    CHECK(f.client.counters().exceptions == 1);
}

TEST_CASE("Bytes that are no answer to their request fail it and nothing else")
{
    struct Row {
        std::vector<unsigned> pdu;
    };
    const auto row = GENERATE(values<Row>({{{4, 2, 0, 1}},
                                           {{3, 4, 0, 1, 0, 2}},
                                           {{3, 2, 0}},
                                           {{3}},
                                           {{0x83}},
                                           {{0x84, 2}},
                                           {{3, 2, 0, 1, 0}}}));
    Fixture f;
    const auto id = f.send(reading(0));
    const auto next = f.send(reading(1));
    Bytes pdu;
    for (const unsigned byte : row.pdu) {
        pdu.push_back(static_cast<std::byte>(byte));
    }
    f.feed(Fixture::frame(f.take_sent()[0].header, pdu));
    CHECK(f.answer(id).status == status::Bad_UnknownResponse);
    CHECK(f.client.counters().malformed == 1);
    f.feed(Fixture::answer_to(f.take_sent()[0], {5}));
    CHECK(f.answer(next).status == status::Good);
}

TEST_CASE("Bytes that are no frame end the connection with every request")
{
    const auto header = GENERATE(values<Bytes>({
        {std::byte{0}, std::byte{1}, std::byte{1}},
        {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{0}, std::byte{255}},
        {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{0}, std::byte{1}},
        {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{0xFF}, std::byte{0xFF}},
    }));
    Fixture f;
    const auto first = f.send(reading(0));
    const auto second = f.send(reading(1));
    CHECK(f.client.feed(header, f.now).error() == status::Bad_DecodingError);
    CHECK(f.answer(first).status == status::Bad_DecodingError);
    CHECK(f.answer(second).status == status::Bad_DecodingError);
    f.check_closed(status::Bad_DecodingError);
    CHECK(f.client.feed(header, f.now).error() == status::Bad_DecodingError);
}

TEST_CASE("Answers may arrive in pieces of any size")
{
    for (std::size_t piece = 1; piece < 60; ++piece) {
        Fixture f{with_under_way(3)};
        Bytes all;
        for (std::uint16_t i = 0; i < 3; ++i) {
            f.send(reading(i, 10));
        }
        for (const Sent& sent : f.take_sent()) {
            const Bytes answer =
                Fixture::answer_to(sent, std::vector<std::uint16_t>(10, sent.request.address));
            all.insert(all.end(), answer.begin(), answer.end());
        }
        for (std::size_t at = 0; at < all.size(); at += piece) {
            REQUIRE(
                f.client.feed(std::span{all}.subspan(at, std::min(piece, all.size() - at)), f.now));
        }
        for (std::uint64_t id = 1; id <= 3; ++id) {
            CHECK(f.answer(id).answer.values ==
                  std::vector(10, static_cast<std::uint16_t>(id - 1)));
        }
    }
}

TEST_CASE("A connection that ends fails what has no answer")
{
    Fixture f;
    const auto under_way = f.send(reading(0));
    const auto waiting = f.send(reading(1));
    f.client.close(status::Bad_ConnectionClosed, "the peer has closed the connection");
    CHECK(f.answer(under_way).status == status::Bad_ConnectionClosed);
    CHECK(f.answer(waiting).status == status::Bad_ConnectionClosed);
    f.check_closed(status::Bad_ConnectionClosed);
}

TEST_CASE("A client takes no more requests than its limit, and none that the protocol forbids")
{
    ModbusClientOptions options;
    options.max_requests = 3;
    Fixture f{options};
    for (int i = 0; i < 3; ++i) {
        f.send(reading(0));
    }
    CHECK(f.client.send(reading(0), 1, f.now).error() == status::Bad_TooManyOperations);
    f.feed(Fixture::answer_to(f.take_sent()[0], {0}));
    CHECK(f.client.send(reading(0, 126), 1, f.now).error() == status::Bad_OutOfRange);
    CHECK(f.client.send(reading(0), 1, f.now));
}

TEST_CASE("Behind a gateway requests go one at a time, and a broadcast has no answer")
{
    ModbusClientOptions options = with_under_way(8);
    options.is_gateway = true;
    Fixture f{options};
    CHECK(f.client.send(reading(0), 0, f.now).error() == status::Bad_OutOfRange);
    const auto all = f.send(writing(5), 0);
    const auto one = f.send(reading(0), 7);
    const auto sent = f.take_sent();
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].header.unit == 0);
    f.feed(Fixture::answer_to(sent[0], {}));
    CHECK_FALSE(f.client.next_event());
    f.pass(100ms);
    CHECK(f.answer(all).status == status::Good);
    f.feed(Fixture::answer_to(f.take_sent()[0], {1}));
    CHECK(f.answer(one).status == status::Good);
    CHECK(f.client.counters().timeouts == 0);

    // A device that is connected directly answers unit 0 as any other.
    Fixture direct;
    const auto read = direct.send(reading(0), 0);
    direct.feed(Fixture::answer_to(direct.take_sent()[0], {1}));
    CHECK(direct.answer(read).status == status::Good);
}

TEST_CASE("Transactions are numbered again from 0 without two of them under way")
{
    Fixture f{with_under_way(2)};
    const auto old = f.send(reading(9));
    const Sent first = f.take_sent()[0];
    for (int i = 0; i < 0x10000; ++i) {
        f.send(reading(0));
        const auto sent = f.take_sent();
        REQUIRE(sent.size() == 1);
        REQUIRE(sent[0].header.transaction != first.header.transaction);
        f.feed(Fixture::answer_to(sent[0], {0}));
        REQUIRE(f.client.next_event()->status == status::Good);
    }
    f.feed(Fixture::answer_to(first, {9}));
    CHECK(f.answer(old).answer.values[0] == 9);
}

} // namespace modbus_client_test
