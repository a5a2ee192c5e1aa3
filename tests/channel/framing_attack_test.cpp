#include <catch2/catch.hpp>

#include <array>
#include <string_view>

#include "support/scripted_client.hpp"

namespace framing_attack_test {

// What a stranger may send before and after a channel is open: each ends with an Error message and
// the end of the connection, at the byte that was wrong (tests/attacks.txt, A).

using namespace busbar;
using namespace busbar::test;
using Bytes = std::vector<std::byte>;

namespace {

constexpr std::array client_messages{"HELF", "OPNF", "MSGF", "CLOF"};

Bytes header(std::string_view type, std::uint32_t size)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.bytes(std::as_bytes(std::span{type}));
    writer.number(size);
    return sink.take(writer.written());
}

/// A Hello whose EndpointUrl says it has `length` bytes and has `url_size`.
Bytes hello(std::uint32_t version, std::uint32_t receive, std::uint32_t send, std::uint32_t length,
            std::size_t url_size)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.bytes(header("HELF", static_cast<std::uint32_t>(32 + url_size)));
    for (const std::uint32_t number : {version, receive, send, 0U, 0U, length}) {
        writer.number(number);
    }
    writer.bytes(Bytes(url_size, std::byte{'x'}));
    return sink.take(writer.written());
}

/// A client that has said nothing yet.
struct Stranger : ChannelPair {
    /// Returns what the Error message says that the bytes are answered with; Good if there is none.
    StatusCode told(std::span<const std::byte> bytes)
    {
        static_cast<void>(server.feed(bytes, now));
        while (server.next_event()) {
        }
        binary::Reader reader{server.output()};
        const bool is_error = !server.output().empty() && reader.bytes(8)[0] == std::byte{'E'};
        CHECK(is_error == server.is_closed());
        return is_error ? StatusCode{reader.number<std::uint32_t>()} : StatusCode{};
    }
};

/// One with an open channel of policy None.
struct InChannel : ScriptedClient {
    explicit InChannel() : ScriptedClient{{{}}}
    {
        feed(open_message({}));
        REQUIRE(server.is_open());
        server.consume(server.output().size());
        events.clear();
    }
};

} // namespace

TEST_CASE("a message that says it is no longer than its header ends the connection",
          "[channel][attack]")
{
    for (const char* type : client_messages) {
        for (std::uint32_t size = 0; size < 8; ++size) {
            INFO(type << " of " << size);
            Stranger first;
            CHECK(first.told(header(type, size)) == status::Bad_TcpMessageTypeInvalid);
            InChannel later;
            later.feed(header(type, size));
            CHECK(later.told() == status::Bad_TcpMessageTypeInvalid);
            // Nothing behind it is looked at.
            later.feed(Bytes(100'000));
            CHECK(later.server.memory_in_use() < 65'536);
        }
        INFO(type << " without a body");
        Stranger first;
        CHECK(first.told(header(type, 8)).is_bad());
        InChannel later;
        later.feed(header(type, 8));
        CHECK(later.told().is_bad());
        CHECK(later.server.is_closed());
    }
}

TEST_CASE("a size that nobody agreed to is refused with its header and holds no memory",
          "[channel][attack]")
{
    for (const std::uint32_t size : {65'536U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
        for (const char* type : {"HELF", "OPNF", "MSGC", "MSGF", "CLOF"}) {
            INFO(type << " of " << size);
            Stranger first;
            const std::size_t before = first.server.memory_in_use();
            CHECK(first.told(header(type, size)) == status::Bad_TcpMessageTooLarge);
            CHECK_FALSE(first.server.feed(Bytes(1'000'000), first.now));
            CHECK(first.server.memory_in_use() < before + 65'536);
            InChannel later;
            later.feed(header(type, size));
            CHECK(later.told() == status::Bad_TcpMessageTooLarge);
            later.feed(Bytes(1'000'000));
            CHECK(later.server.memory_in_use() < before + 65'536);
        }
    }
}

TEST_CASE("nothing of a Hello is believed", "[channel][attack]")
{
    struct Row {
        std::uint32_t version;
        std::uint32_t receive;
        std::uint32_t send;
        std::uint32_t length;
        std::size_t url_size;
        StatusCode told;
    };
    constexpr std::uint32_t all = 0xFFFFFFFF;
    const Row rows[] = {
        {all, 65'535, 65'535, 4, 4, status::Good},
        {0, all, all, 4'095, 4'095, status::Good},
        {0, all, all, 4'096, 4'096, status::Good},
        {0, all, all, all, 0, status::Good}, // null
        {0, all, all, 4'097, 4'097, status::Bad_TcpEndpointUrlInvalid},
        {0, all, all, 0x7FFFFFFF, 4, status::Bad_TcpEndpointUrlInvalid},
        {0, all, all, 0x80000000, 4, status::Bad_TcpInternalError}, // less than none
        {0, 0, all, 4, 4, status::Bad_TcpNotEnoughResources},
        {0, 1, all, 4, 4, status::Bad_TcpNotEnoughResources},
        {0, 1'023, all, 4, 4, status::Bad_TcpNotEnoughResources},
        {0, all, 8'191, 4, 4, status::Bad_TcpNotEnoughResources},
    };
    for (const Row& row : rows) {
        INFO(row.version << ' ' << row.receive << ' ' << row.send << ' ' << row.length << " of "
                         << row.url_size);
        Stranger stranger;
        const std::size_t before = stranger.server.memory_in_use();
        CHECK(stranger.told(hello(row.version, row.receive, row.send, row.length, row.url_size)) ==
              row.told);
        CHECK(stranger.server.memory_in_use() < before + 16'384);
    }
}

TEST_CASE("only a client's messages are taken, each in its state", "[channel][attack]")
{
    // After the Hello there is only OPN.
    for (const char* type : {"HELF", "ACKF", "ERRF", "RHEF", "MSGF", "MSGC", "MSGA", "CLOF"}) {
        INFO(type << " after a Hello");
        ScriptedClient client{{{}}};
        client.feed(client.chunk(type, 1, 8));
        CHECK(client.told() == status::Bad_TcpMessageTypeInvalid);
        CHECK(client.server.is_closed());
    }
    // What a server sends, what nobody knows, and parts of what has none.
    for (const char* type : {"HELF", "ACKF", "ERRF", "RHEF", "XYZF", "msgF", "MSGZ", "MSG\0",
                             "OPNC", "OPNA", "CLOC", "CLOA", "HELC"}) {
        INFO(type << " in an open channel");
        InChannel client;
        client.feed(client.chunk(std::string_view{type, 4}, 1, 8));
        CHECK(client.told() == status::Bad_TcpMessageTypeInvalid);
        CHECK(client.server.is_closed());
    }
    // Giving up what was not begun.
    InChannel client;
    client.feed(client.chunk("MSGA", 1, 8));
    CHECK(client.told() == status::Bad_TcpMessageTypeInvalid);
    CHECK(client.events.size() == 1);
}

TEST_CASE("a channel is made once and has two tokens at the most", "[channel][attack]")
{
    InChannel twice;
    ScriptedClient::Open issue;
    issue.channel_id = InChannel::channel_id;
    twice.feed(twice.open_message(issue));
    CHECK(twice.told() == status::Bad_RequestTypeInvalid);
    InChannel client;
    for (int i = 0; i < 3; ++i) {
        ScriptedClient::Open renewal;
        renewal.channel_id = InChannel::channel_id;
        renewal.type = SecurityTokenRequestType::Renew;
        client.feed(client.open_message(renewal));
        REQUIRE(client.server.is_open());
        client.server.consume(client.server.output().size());
    }
    // The fourth is new, the third is in force until the fourth is used; the others are gone.
    client.feed(client.chunk("MSGF", 1, 4, 2));
    CHECK(client.told() == status::Bad_SecureChannelTokenUnknown);
}

TEST_CASE("a Hello of one byte in a second ends at its time", "[channel][attack]")
{
    ChannelPair pair;
    const Bytes greeting = hello(0, 65'535, 65'535, 4, 4);
    for (std::size_t i = 0; i < 9; ++i) {
        static_cast<void>(pair.server.feed(std::span{greeting}.subspan(i, 1), pair.now));
        CHECK_FALSE(pair.server.next_event());
        pair.now += std::chrono::seconds{1};
        pair.server.handle_deadline(pair.now);
        CHECK_FALSE(pair.server.is_closed());
    }
    CHECK(pair.server.next_deadline() == pair.now + std::chrono::seconds{1});
    pair.now += std::chrono::seconds{1};
    pair.server.handle_deadline(pair.now);
    CHECK(pair.server.is_closed());
}

} // namespace framing_attack_test
