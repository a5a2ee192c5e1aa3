#include <catch2/catch.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <string>
#include <vector>

#include <busbar/server/memory_source.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "core/kept_memory.hpp"
#include "support/allocation_count.hpp"
#include "support/server_fixture.hpp"

namespace large_read_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::size_t count = 25'000;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool is_sanitized = true;
#elif defined(__has_feature)
constexpr bool is_sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool is_sanitized = false;
#endif

server::ServerConfig large_config()
{
    server::ServerConfig config = ServerFixture::insecure_config();
    config.limits.operations.max_nodes_per_read = count;
    return config;
}

/// What the server's part of a Read costs.
struct Cost {
    std::size_t allocations{0};
    std::size_t bytes{0};
    long page_faults{0};
};

long page_faults()
{
    rusage usage{};
    REQUIRE(getrusage(RUSAGE_THREAD, &usage) == 0);
    return usage.ru_minflt;
}

struct Source {
    FixedWallClock source_clock;
    server::MemorySource source{source_clock};
};

struct LargeReadFixture : Source, ServerFixture {
    LargeReadFixture() : ServerFixture{large_config()}
    {
        const model::NodeIndex folder = server.address_space().find(id::ObjectsFolder);
        request.timestamps_to_return = TimestampsToReturn::Neither;
        for (std::size_t i = 0; i < count; ++i) {
            model::NewNode node;
            node.id = NodeId{1, String{"Machine.Variable" + std::to_string(i)}};
            node.browse_name = QualifiedName{1, node.id.string()};
            node.parent = folder;
            model::NewVariable variable;
            variable.data_type = NodeId{0, id::Int32};
            variable.source = index;
            variable.handle = source.add(Variant{static_cast<std::int32_t>(i)});
            REQUIRE(server.address_space().add_variable(node, variable));
            ReadValueId& item = request.nodes_to_read.emplace_back();
            item.node_id = node.id;
            item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        }
    }
    /// Sends the request, and checks the answer.
    Cost read()
    {
        request.request_header.authentication_token = client.authentication_token;
        request.request_header.request_handle = ++client.last_handle;
        const auto sent = client.channel.send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, ReadRequest::binary_encoding_id});
            encode(writer, request);
        });
        REQUIRE(sent);
        const std::vector<std::byte> bytes = take_output(client.channel);
        answer.clear();
        answer.reserve(1U << 20U);

        const std::size_t allocations = allocation_count();
        const std::size_t allocated = allocated_bytes();
        const long faults = page_faults();
        static_cast<void>(client.connection.feed(bytes, now));
        take_answer();
        while (client.connection.next_deadline() <= now) {
            client.connection.handle_deadline(now);
            take_answer();
        }
        const Cost cost{allocation_count() - allocations, allocated_bytes() - allocated,
                        page_faults() - faults};

        static_cast<void>(client.channel.feed(answer, now));
        const auto response = client.take<ReadResponse>(*sent);
        REQUIRE(response);
        REQUIRE(response->results.size() == count);
        CHECK(response->results[0].value == Variant{std::int32_t{0}});
        CHECK(response->results[count - 1].value == Variant{static_cast<std::int32_t>(count - 1)});
        return cost;
    }
    void take_answer()
    {
        const auto out = client.connection.output();
        answer.insert(answer.end(), out.begin(), out.end());
        client.connection.consume(out.size());
    }

    std::uint32_t index{server.add_source(source)};
    ReadRequest request;
    TestClient client{log_in()};
    std::vector<std::byte> answer;
};

} // namespace

TEST_CASE_METHOD(LargeReadFixture, "a large Read takes the memory of the one before")
{
    const Cost first = read();
    const Cost second = read();
    CAPTURE(first.allocations, first.bytes, second.allocations, second.bytes);
    CHECK(first.bytes > 3'000'000);
    CHECK(second.allocations <= 8);
    // None of these is one that malloc would take from the system and give back.
    CHECK(second.bytes < 16'384);

    // Nothing lies in pages that were given back in between. The system may take one away at any
    // time, though not each time; a sanitizer keeps memory of its own.
    if (!is_sanitized) {
        CHECK(std::min({read().page_faults, read().page_faults, read().page_faults}) == 0);
    }

    // None of it lies there for ever.
    CHECK(server.next_deadline() <= now + busbar::detail::KeptMemory::age);
    const std::size_t before = held_bytes();
    for (int i = 0; i < 3; ++i) {
        advance(busbar::detail::KeptMemory::age);
        server.handle_deadline(now);
    }
    CHECK(held_bytes() + 3'000'000 < before);
    CHECK(read().bytes > 3'000'000);
}

} // namespace large_read_test
