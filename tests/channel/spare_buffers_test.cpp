#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <vector>

#include <busbar/channel/spare_buffers.hpp>

#include "channel/buffer_bounds.hpp"
#include "channel/output_buffer.hpp"
#include "support/allocation_count.hpp"
#include "support/scripted_client.hpp"

namespace spare_buffers_test {

using namespace busbar;
using namespace busbar::test;
using channel::SpareBuffers;
using channel::detail::OutputBuffer;

namespace {

constexpr std::size_t chunk = 65'535;

/// Sends `size` bytes of this value.
void put(OutputBuffer& out, std::size_t size, int value)
{
    const auto room = out.reserve(std::max(size, chunk));
    std::fill_n(room.begin(), size, static_cast<std::byte>(value));
    out.commit(size);
}

bool is_all(std::span<const std::byte> bytes, int value)
{
    return std::all_of(bytes.begin(), bytes.end(),
                       [&](std::byte byte) { return byte == static_cast<std::byte>(value); });
}

/// The server's end of a connection over None.
struct OpenServer : ScriptedClient {
    explicit OpenServer(SpareBuffers& spares) : ScriptedClient{{{}}, {}, &spares}
    {
        feed(open_message({}));
        REQUIRE(server.is_open());
        server.consume(server.output().size());
        events.clear();
    }
};

/// Returns those of several connections, which share their buffers.
struct SharingServers {
    SharingServers()
    {
        for (int i = 0; i < 3; ++i) {
            ends.push_back(std::make_unique<OpenServer>(spares));
        }
    }

    SpareBuffers spares;
    std::vector<std::unique_ptr<OpenServer>> ends;
};

} // namespace

TEST_CASE("output that was taken leaves no memory with its connection", "[channel][spares]")
{
    SpareBuffers spares;
    OutputBuffer first{&spares};
    OutputBuffer second{&spares};
    const std::size_t kept = spares.kept();
    put(first, 100, 1);
    CHECK(first.capacity() >= chunk);
    first.consume(100);
    CHECK(first.capacity() == 0);
    CHECK(spares.kept() > kept);
    const std::size_t before = allocation_count();
    for (int i = 0; i < 10; ++i) {
        put(i % 2 == 0 ? first : second, 100, i);
        (i % 2 == 0 ? first : second).consume(100);
    }
    CHECK(allocation_count() == before);
    CHECK(second.capacity() == 0);
}

TEST_CASE("output that waits lies in memory of its size once another needs the buffer",
          "[channel][spares]")
{
    SpareBuffers spares;
    std::vector<std::unique_ptr<OutputBuffer>> slow;
    for (int i = 0; i < 100; ++i) {
        put(*slow.emplace_back(std::make_unique<OutputBuffer>(&spares)), 300, i);
    }
    std::size_t held = 0;
    for (int i = 0; i < 100; ++i) {
        CHECK(slow[static_cast<std::size_t>(i)]->output().size() == 300);
        CHECK(is_all(slow[static_cast<std::size_t>(i)]->output(), i));
        held += slow[static_cast<std::size_t>(i)]->capacity();
    }
    CHECK(held <= 99 * 300 + chunk);
    put(*slow[7], 200, 7); // more behind it, in the buffer that others have had meanwhile
    CHECK(slow[7]->output().size() == 500);
    CHECK(is_all(slow[7]->output(), 7));
    CHECK(slow[99]->capacity() == 300);
    slow[7]->consume(499);
    put(*slow[8], 10, 8);
    CHECK(slow[7]->capacity() == 1);
    slow.clear();
    CHECK(spares.kept() >= 2 * chunk);
}

TEST_CASE("what waits is moved a few times only, whoever sends in between", "[channel][spares]")
{
    SpareBuffers spares;
    OutputBuffer slow{&spares};
    OutputBuffer other{&spares};
    std::size_t moved = 0;
    constexpr std::size_t size = 500;
    constexpr std::size_t times = 4'000;
    for (std::size_t i = 0; i < times; ++i) {
        const std::byte* before = slow.output().data();
        put(slow, size, 3);
        moved += slow.output().data() != before ? slow.output().size() : 0;
        before = slow.output().data();
        put(other, 1, 4);
        moved += slow.output().data() != before ? slow.output().size() : 0;
        other.consume(1);
    }
    CHECK(slow.output().size() == size * times);
    CHECK(is_all(slow.output(), 3));
    CHECK(slow.capacity() <= OutputBuffer::max_capacity(size * times, chunk));
    // Half of the first 64 kB with each of some 130 messages, and later each byte a few times.
    CHECK(moved < 20 * size * times);
}

TEST_CASE("a flood's buffers are not kept", "[channel][spares]")
{
    SpareBuffers spares;
    {
        OutputBuffer out{&spares};
        for (int i = 0; i < 100; ++i) {
            put(out, chunk, 1);
        }
        CHECK(out.capacity() >= 100 * chunk);
        out.consume(out.output().size());
        CHECK(out.capacity() == 0);
    }
    spares.give_back_input(std::vector<std::byte>(2 * SpareBuffers::max_kept));
    spares.give_back_message(std::vector<std::byte>(2 * SpareBuffers::max_kept));
    CHECK(spares.kept() <= SpareBuffers::max_kept + chunk);
}

TEST_CASE("connections that have worked on everything hold nothing", "[channel][spares]")
{
    SharingServers servers;
    const std::vector<std::byte> answer(200'000, std::byte{5});
    for (const auto& end : servers.ends) {
        end->feed(end->chunk("MSGC", 1, 60'000));
        end->feed(end->chunk("MSGF", 1, 60'000));
        REQUIRE(end->server.send(1, [&](binary::Writer& writer) { writer.bytes(answer); }));
        end->server.consume(end->server.output().size());
        CHECK(end->server.memory_in_use() == 0);
    }
    CHECK(servers.spares.kept() <= 3 * SpareBuffers::max_kept);
}

TEST_CASE("a message in steady use costs no allocation, whose connection it is",
          "[channel][spares]")
{
    SharingServers servers;
    const std::vector<std::byte> body(50'000, std::byte{5});
    std::size_t count = 0;
    for (int round = 0; round < 3; ++round) {
        for (const auto& end : servers.ends) {
            const auto message = end->chunk("MSGF", 1, 60'000);
            const std::size_t before = allocation_count();
            REQUIRE(end->server.feed(message, end->now));
            auto event = end->server.next_event();
            REQUIRE(event);
            end->server.recycle(std::move(event->body));
            CHECK_FALSE(end->server.next_event());
            REQUIRE(end->server.send(1, [&](binary::Writer& writer) { writer.bytes(body); }));
            end->server.consume(end->server.output().size());
            count = allocation_count() - before;
        }
    }
    CHECK(count == 0);
}

TEST_CASE("a message that may wait lies in a buffer of its size", "[channel][spares]")
{
    SharingServers servers;
    OpenServer& end = *servers.ends[0];
    end.server.recycle(std::vector<std::byte>(500'000));
    const auto received = [&](std::initializer_list<std::size_t> sizes) {
        std::size_t left = sizes.size();
        for (const std::size_t size : sizes) {
            const auto message = end.chunk(--left == 0 ? "MSGF" : "MSGC", 1, size);
            REQUIRE(end.server.feed(message, end.now));
            if (auto event = end.server.next_event()) {
                return std::move(event->body);
            }
        }
        return std::vector<std::byte>{};
    };
    CHECK(received({100}).capacity() == 100);
    CHECK(received({60'000, 100}).capacity() == 60'100);
    CHECK(received({60'000, 60'000, 60'000}).capacity() >= 500'000);
}

} // namespace spare_buffers_test
