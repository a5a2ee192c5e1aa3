#include <catch2/catch.hpp>

#include "channel/buffer_bounds.hpp"
#include "support/allocation_count.hpp"
#include "support/scripted_client.hpp"

namespace limits_test {

using namespace busbar;
using namespace busbar::test;
using Kind = channel::ChannelEvent::Kind;
using Bytes = std::vector<std::byte>;

namespace {

Bytes pattern(std::size_t size)
{
    Bytes bytes(size);
    for (std::size_t i = 0; i < size; ++i) {
        bytes[i] = static_cast<std::byte>(i * 11);
    }
    return bytes;
}

/// A server with an open channel of policy None.
struct OpenServer : ScriptedClient {
    explicit OpenServer(channel::TransportLimits limits = {}) : ScriptedClient{{{}}, limits}
    {
        feed(open_message({}));
        REQUIRE(server.is_open());
        server.consume(server.output().size());
        events.clear();
    }
};

} // namespace

TEST_CASE("a handshake and a message may be cut anywhere", "[channel][limits]")
{
    for (const auto& security : {channel::SecuritySetting{},
                                 setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt)}) {
        ChannelPair pair{security};
        const auto poll_server = [&] {
            while (auto event = pair.server.next_event()) {
                pair.server_events.push_back(*std::move(event));
            }
        };
        const auto hello = take_output(pair.client);
        for (std::size_t cut = 0; cut <= hello.size(); ++cut) {
            ChannelPair other{security};
            feed_cut(other.server, hello, cut, other.now,
                     [&] { CHECK_FALSE(other.server.next_event()); });
            CHECK_FALSE(other.server.output().empty());
        }
        feed_cut(pair.server, hello, 1, pair.now, poll_server);
        pair.run_to_client();
        const auto open = take_output(pair.client);
        feed_cut(pair.server, open, open.size() / 2, pair.now, poll_server);
        pair.run_to_client();
        REQUIRE(pair.client.is_open());
        const Bytes body = pattern(90);
        for (std::size_t cut = 0; cut < 150; ++cut) {
            REQUIRE(pair.client.send([&](binary::Writer& writer) { writer.bytes(body); }));
            const auto message = take_output(pair.client);
            pair.server_events.clear();
            feed_cut(pair.server, message, std::min(cut, message.size()), pair.now, poll_server);
            REQUIRE(pair.server_events.size() == 1);
            CHECK(pair.server_events[0].body == body);
        }
    }
}

TEST_CASE("a message costs a constant number of allocations", "[channel][limits]")
{
    for (const auto mode : {MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt}) {
        ChannelPair pair{setting("Basic256Sha256", mode)};
        pair.run();
        const Bytes body = pattern(200'000);
        const auto send_and_consume = [&](std::size_t size) {
            const auto part = std::span{body}.first(size);
            const std::size_t before = allocation_count();
            REQUIRE(pair.server.send(1, [&](binary::Writer& writer) { writer.bytes(part); }));
            const std::size_t count = allocation_count() - before;
            pair.run_to_client();
            return count;
        };
        send_and_consume(200'000);
        CHECK(send_and_consume(10) == 0);
        CHECK(send_and_consume(200'000) == 0);

        const auto receive = [&](std::size_t size) {
            const auto part = std::span{body}.first(size);
            REQUIRE(pair.client.send([&](binary::Writer& writer) { writer.bytes(part); }));
            const auto message = take_output(pair.client);
            const std::size_t before = allocation_count();
            REQUIRE(pair.server.feed(message, pair.now));
            auto event = pair.server.next_event();
            REQUIRE(event);
            const std::size_t count = allocation_count() - before;
            CHECK(event->body.size() == size);
            pair.server.recycle(std::move(event->body));
            return count;
        };
        receive(200'000);
        receive(200'000);
        CHECK(receive(10) == 0);
        CHECK(receive(200'000) == 0);
    }
}

TEST_CASE("a single chunk is copied once into one allocation", "[channel][limits]")
{
    OpenServer client;
    client.feed(client.chunk("MSGF", 1, 500));
    const Bytes message = client.chunk("MSGF", 2, 500);
    const std::size_t before = allocation_count();
    REQUIRE(client.server.feed(message, client.now));
    const auto event = client.server.next_event();
    CHECK(allocation_count() - before == 1);
    REQUIRE(event);
    CHECK(event->body.capacity() == 500);
}

TEST_CASE("what the client calls unlimited has our limits", "[channel][limits]")
{
    channel::TransportLimits limits;
    limits.max_message_size = 30'000;
    limits.max_chunk_count = 0; // the default
    OpenServer client{limits};
    const Bytes large(30'001);
    const auto sent = client.server.send(1, [&](binary::Writer& writer) { writer.bytes(large); });
    REQUIRE_FALSE(sent);
    CHECK(sent.error() == status::Bad_ResponseTooLarge);
    client.feed(client.chunk("MSGC", 1, 20'000));
    CHECK(client.server.is_open());
    client.feed(client.chunk("MSGF", 1, 10'001));
    CHECK(client.told() == status::Bad_TcpMessageTooLarge);
}

TEST_CASE("a response of more chunks than are allowed is not sent", "[channel][limits]")
{
    channel::TransportLimits limits;
    limits.max_chunk_count = 3;
    OpenServer client{limits};
    const auto send = [&](std::size_t size) {
        const Bytes body(size);
        return client.server.send(1, [&](binary::Writer& writer) { writer.bytes(body); });
    };
    constexpr std::size_t three_chunks = 3 * (65'535 - 24); // each with its headers
    CHECK(send(three_chunks));
    client.server.consume(client.server.output().size());
    const auto refused = send(three_chunks + 1);
    REQUIRE_FALSE(refused);
    CHECK(refused.error() == status::Bad_ResponseTooLarge);
    CHECK(client.server.output().empty());
    CHECK(client.server.is_open());
}

TEST_CASE("an Acknowledge never exceeds the Hello nor announces no limit", "[channel][limits]")
{
    for (const auto& [receive, send] :
         {std::pair{8'192U, 8'192U}, std::pair{20'000U, 10'000U}, std::pair{~0U, ~0U}}) {
        channel::TransportLimits limits;
        limits.max_chunk_count = 0;
        limits.max_message_size = 0;
        ChannelPair pair{{}, limits};
        channel::detail::OutputBuffer out;
        channel::detail::write_hello(out, {9, receive, send, 0, 0, String{"opc.tcp://x"}});
        static_cast<void>(pair.server.feed(out.output(), pair.now));
        CHECK_FALSE(pair.server.next_event());
        const auto answer = take_output(pair.server);
        const auto ack = channel::detail::parse_acknowledge(std::span{answer}.subspan(8));
        REQUIRE(ack);
        CHECK(ack->protocol_version == 0);
        CHECK(ack->receive_buffer_size == std::min(send, 65'535U));
        CHECK(ack->send_buffer_size == std::min(receive, 65'535U));
        CHECK(ack->max_message_size != 0);
        CHECK(ack->max_chunk_count != 0);
    }
}

TEST_CASE("a chunk may not be larger than what was agreed", "[channel][limits]")
{
    channel::TransportLimits limits;
    limits.receive_buffer_size = 8'192;
    OpenServer client{limits};
    client.feed(client.chunk("MSGF", 1, 8'192 - 24));
    CHECK(client.events.size() == 1);
    client.feed(client.chunk("MSGF", 2, 8'192 - 23));
    CHECK(client.told() == status::Bad_TcpMessageTooLarge);
}

TEST_CASE("a closed channel holds nothing of an unfinished message", "[channel][limits]")
{
    OpenServer client;
    const std::size_t whole = client.budget.left();
    client.feed(client.chunk("MSGC", 1, 60'000));
    CHECK(client.server.unfinished_size() == 60'000);
    client.server.close(status::Bad_TcpNotEnoughResources, "no place");
    CHECK(client.server.unfinished_size() == 0);
    CHECK(client.budget.left() == whole);
}

TEST_CASE("unfinished messages are charged to a budget and given back", "[channel][limits]")
{
    OpenServer client;
    const std::size_t whole = client.budget.left();
    client.feed(client.chunk("MSGC", 1, 60'000));
    CHECK(client.budget.left() == whole - 60'000);
    client.feed(client.chunk("MSGF", 1, 60'000));
    CHECK(client.budget.left() == whole);
    client.feed(client.chunk("MSGC", 2, 60'000));
    client.feed(client.chunk("MSGA", 2, 8));
    CHECK(client.budget.left() == whole);
    {
        OpenServer gone;
        gone.feed(gone.chunk("MSGC", 1, 60'000));
        // Another connection of the same server finds the budget used up.
        REQUIRE(gone.budget.take(gone.budget.left() - 10));
        gone.feed(gone.chunk("MSGC", 1, 11));
        CHECK(gone.told() == status::Bad_TcpNotEnoughResources);
    }
    client.feed(client.chunk("MSGC", 3, 60'000));
    client.server = channel::ServerChannel{{},
                                           {.random = &client.random,
                                            .wall_clock = &client.wall_clock,
                                            .log = &client.log,
                                            .budget = &client.budget},
                                           client.now};
    CHECK(client.budget.left() == whole);
}

TEST_CASE("a connection that only said Hello holds little", "[channel][limits]")
{
    ScriptedClient client{{{}}};
    CHECK(client.server.memory_in_use() < 32'768);
    client.feed(Bytes(3)); // no header yet
    CHECK(client.server.memory_in_use() < 32'768);
    OpenServer announced;
    Bytes header = announced.chunk("MSGF", 1, 60'000);
    header.resize(24);
    const std::size_t before = announced.server.memory_in_use();
    announced.feed(header);
    CHECK(announced.server.memory_in_use() < before + 4'096);
}

TEST_CASE("sequence numbers that repeat or jump end the channel", "[channel][limits]")
{
    for (const int step : {-1, 0, 2, 1'000}) {
        OpenServer client;
        client.feed(client.chunk("MSGF", 1, 4));
        client.sequence += static_cast<std::uint32_t>(step - 1);
        client.feed(client.chunk("MSGF", 2, 4));
        CHECK(client.told() == status::Bad_SecurityChecksFailed);
        CHECK(client.reason() == status::Bad_SequenceNumberInvalid);
        CHECK(client.log.text.find("Bad_SequenceNumberInvalid") != std::string::npos);
    }
}

TEST_CASE("chunks of two messages may not mix", "[channel][limits]")
{
    OpenServer client;
    client.feed(client.chunk("MSGC", 1, 4));
    client.feed(client.chunk("MSGF", 2, 4));
    CHECK(client.told() == status::Bad_TcpMessageTypeInvalid);
}

TEST_CASE("what waits for a peer is moved a few times only, and lies in little more than its size",
          "[channel][limits]")
{
    constexpr std::size_t chunk = 1'000;
    constexpr std::size_t most = 50 * chunk;
    channel::detail::OutputBuffer out;
    std::size_t sent = 0;
    std::size_t taken = 0;
    std::size_t moves = 0;
    const std::byte* front = nullptr;
    for (std::size_t i = 0; i < 5'000; ++i) {
        const auto room = out.reserve(chunk);
        moves += out.output().data() != front ? 1U : 0U;
        const std::size_t size = 1 + i * 7 % chunk;
        for (std::byte& byte : room.first(size)) {
            byte = static_cast<std::byte>(sent++ % 251);
        }
        out.commit(size);
        REQUIRE(out.capacity() <= channel::detail::OutputBuffer::max_capacity(most, chunk));
        // A slow peer: what waits grows to the most, then stays there.
        const std::size_t excess = std::max(out.output().size(), most - chunk) - (most - chunk);
        for (const std::byte byte : out.output().first(excess)) {
            REQUIRE(byte == static_cast<std::byte>(taken++ % 251));
        }
        out.consume(excess);
        front = out.output().data();
    }
    CHECK(out.output().size() == sent - taken);
    CHECK(moves < 500);
    out.consume(out.output().size());
    CHECK(out.output().empty());
}

TEST_CASE("a channel's buffers stay within their bounds", "[channel][limits]")
{
    channel::TransportLimits limits;
    limits.receive_buffer_size = 8'192;
    limits.send_buffer_size = 8'192;
    limits.max_message_size = 100'000;
    constexpr std::size_t queue = 50'000;
    const auto bounds = channel::detail::bounds_of(limits, queue);
    OpenServer client{limits};
    SECTION("a chunk that never ends, byte by byte")
    {
        Bytes chunk = client.chunk("MSGC", 1, 8'192 - 24);
        chunk.pop_back();
        for (const std::byte byte : chunk) {
            static_cast<void>(client.server.feed(std::span{&byte, 1}, client.now));
            CHECK_FALSE(client.server.next_event());
        }
        CHECK(client.server.memory_in_use() >= chunk.size());
        CHECK(client.server.memory_in_use() <=
              bounds.input + client.server.output().size() + 8'300);
    }
    SECTION("answers that nobody takes")
    {
        const Bytes answer(limits.max_message_size);
        while (client.server.output().size() <= queue) {
            REQUIRE(client.server.send(1, [&](binary::Writer& writer) { writer.bytes(answer); }));
        }
        CHECK(client.server.memory_in_use() >= answer.size());
        CHECK(client.server.memory_in_use() <= bounds.output + bounds.input);
    }
    SECTION("the buffer of a message that was given back")
    {
        client.server.recycle(Bytes(2 * limits.max_message_size));
        CHECK(client.server.memory_in_use() <= bounds.kept + bounds.input + bounds.output);
        client.server.recycle(Bytes(channel::detail::max_recycled_size + 1));
        CHECK(client.server.memory_in_use() <= bounds.kept + bounds.input + bounds.output);
    }
}

TEST_CASE("limits that are not given have the bounds of the defaults", "[channel][limits]")
{
    const channel::TransportLimits none{0, 0, 0, 0};
    const auto given = channel::detail::bounds_of({}, 1'000);
    const auto bounds = channel::detail::bounds_of(none, 1'000);
    CHECK(bounds.input == given.input);
    CHECK(bounds.output == given.output);
    CHECK(bounds.output > channel::TransportLimits{}.max_message_size);
}

} // namespace limits_test
