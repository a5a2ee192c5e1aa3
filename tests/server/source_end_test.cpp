#include <catch2/catch.hpp>

#include <memory>
#include <optional>

#include <busbar/server/process_image.hpp>

#include "method_fixture.hpp"
#include "subscription_fixture.hpp"
#include "support/slow_server.hpp"

namespace source_end_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration sample = 50ms;

NodeId add_variable(server::Server& server, const char* name, std::uint32_t source,
                    std::uint64_t handle = 0)
{
    model::NewNode node;
    node.id = NodeId{1, name};
    node.browse_name = QualifiedName{1, name};
    node.parent = server.address_space().find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.access_level = model::Access::ReadWrite;
    variable.source = source;
    variable.handle = handle;
    REQUIRE(server.address_space().add_variable(node, variable));
    return node.id;
}

struct SourceEndParts {
    CountingWaker waker_of_sources;
    FixedWallClock source_clock;
    server::MemorySource lasting{source_clock};
    std::optional<server::MemorySource> passing{source_clock};
};

/// A client of a server, and two sources: of one of them there will be an end.
struct SourceEndFixture : SourceEndParts, ServerFixture {
    SourceEndFixture() : ServerFixture{waker_of_sources, insecure_config()}
    {
        lasts = add_variable(server, "lasts", server.add_source(lasting), lasting.add(Variant{1}));
        index = server.add_source(*passing);
        passes = add_variable(server, "passes", index, passing->add(Variant{2}));
    }
    TestClient log_in_to_write()
    {
        users.everybody.access_level_mask = 0xFF;
        return log_in();
    }
    std::vector<StatusCode> read_both()
    {
        ReadRequest request = SlowFixture::read(lasts, 2);
        request.nodes_to_read[1].node_id = passes;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return {response->results[0].status, response->results[1].status};
    }
    StatusCode write(const NodeId& node)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = node;
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value.value = 1;
        const auto response = client.call<WriteResponse>(request);
        return response ? response->results[0] : response.error();
    }
    void monitor(const NodeId& node, double interval)
    {
        const std::uint32_t subscription =
            client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
                .value()
                .subscription_id;
        auto item = SubscriptionFixture::item_request(node);
        item.requested_parameters.sampling_interval = interval;
        REQUIRE(SubscriptionFixture::monitor(client, subscription, item).status_code ==
                status::Good);
    }
    /// The last sample that three cycles of publishing bring; nothing if they bring none.
    std::optional<DataValue> next()
    {
        std::optional<DataValue> last;
        for (int i = 0; i < 3; ++i) {
            SubscriptionFixture::publish(client);
            server.handle_completions(now);
            advance(2 * sample);
            client.run();
            while (!client.messages.empty()) {
                const auto response =
                    SubscriptionFixture::take(client, client.messages[0].request_id);
                REQUIRE(response);
                for (const auto& one : SubscriptionFixture::data(response->notification_message)) {
                    last = one.value;
                }
            }
        }
        return last;
    }

    [[nodiscard]] StatusCode next_status()
    {
        const auto last = next();
        return last ? last->status : StatusCode{status::Bad_NothingToDo};
    }
    [[nodiscard]] Variant next_value() { return next().value_or(DataValue{}).value; }

    NodeId lasts;
    NodeId passes;
    std::uint32_t index{0};
    TestClient client{log_in_to_write()};
};

using Codes = std::vector<StatusCode>;

} // namespace

TEST_CASE_METHOD(SourceEndFixture, "a source that ends before its server is not called any more")
{
    CHECK(read_both() == Codes{status::Good, status::Good});
    CHECK(write(passes) == status::Good);
    passing.reset();
    CHECK(read_both() == Codes{status::Good, status::Bad_NoCommunication});
    CHECK(write(passes) == status::Bad_NoCommunication);
    CHECK(write(lasts) == status::Good);
    server.handle_completions(now);
    advance(1s);
    // The place is not given to another.
    passing.emplace(source_clock);
    CHECK(server.add_source(*passing) == index + 1);
    CHECK(read_both() == Codes{status::Good, status::Bad_NoCommunication});
}

TEST_CASE_METHOD(SourceEndFixture, "what is monitored of a source that ends says so")
{
    monitor(passes, 50);
    CHECK(next_status() == status::Good);
    passing.reset();
    CHECK(next_status() == status::Bad_NoCommunication);
    CHECK_FALSE(next());
}

namespace {

/// A session, a Subscription and an item are there when this ends, but no connection.
void leave_a_monitored_item(ServerFixture& site, server::MemorySource& memory)
{
    const NodeId node =
        add_variable(site.server, "left", site.server.add_source(memory), memory.add(Variant{1}));
    TestClient client = site.log_in();
    const auto response =
        client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request());
    REQUIRE(response);
    REQUIRE(SubscriptionFixture::monitor(client, response->subscription_id,
                                         SubscriptionFixture::item_request(node))
                .status_code == status::Good);
    site.advance(sample);
}

} // namespace

TEST_CASE("no order in which source and server are declared is wrong")
{
    const FixedWallClock clock;
    SECTION("the source first")
    {
        server::MemorySource memory{clock};
        ServerFixture site;
        leave_a_monitored_item(site, memory);
        CHECK(site.server.monitored_item_count() == 1);
    }
    SECTION("the server first")
    {
        ServerFixture site;
        server::MemorySource memory{clock};
        leave_a_monitored_item(site, memory);
        CHECK(site.server.monitored_item_count() == 1);
    }
}

TEST_CASE_METHOD(SourceEndFixture, "what waits for a source that ends is answered")
{
    auto slow = std::make_unique<SlowSource>();
    const NodeId node = add_variable(server, "slow", server.add_source(*slow));
    const std::uint32_t request = client.send(SlowFixture::read(node));
    CHECK(answer(client, request) == status::Bad_WouldBlock);
    REQUIRE(slow->batches.size() == 1);
    SECTION("what the source holds ends with it")
    {
        slow.reset();
    }
    SECTION("what somebody else holds is still good")
    {
        auto batches = std::move(slow->batches);
        slow.reset();
        batches.front().fail(status::Bad_NoCommunication);
    }
    CHECK(waker_of_sources.count == 1);
    server.handle_completions(now);
    client.run();
    const auto response = client.take<ReadResponse>(request);
    REQUIRE(response);
    CHECK(response->results[0].status == status::Bad_NoCommunication);
}

TEST_CASE("a Method of a source that ends answers Bad_NoCommunication")
{
    MethodFixture fixture;
    auto passing = std::make_unique<server::MethodTable>();
    model::NewMethod method;
    method.source = fixture.server.add_source(*passing);
    method.handle = passing->add([](server::MethodCall call) { call.succeed(); });
    const NodeId node = fixture.add(MethodFixture::named("Passing", fixture.machine), method);
    TestClient client = fixture.log_in();
    const auto call = [&] {
        const auto response =
            client.call<CallResponse>(MethodFixture::request({MethodFixture::to_call(node)}));
        REQUIRE(response);
        return response->results[0].status_code;
    };
    CHECK(call() == status::Good);
    passing.reset();
    CHECK(call() == status::Bad_NoCommunication);
}

namespace {

/// A variable of an image whose source ends.
struct ImageEndFixture : SourceEndFixture {
    ImageEndFixture()
    {
        server::ImageLayout layout;
        static_cast<void>(layout.add({BuiltInType::Int32, {}}));
        image = server::ProcessImage::create(std::move(layout));
        kept = image;
        source = std::make_unique<server::ImageSource>(image);
        lies_in_image = add_variable(server, "image", server.add_source(*source));
        scan(1);
    }
    void scan(std::int32_t value)
    {
        REQUIRE(image->memory().store(0, Variant{value}).is_good());
        image->begin_scan();
        image->publish(today);
    }

    std::shared_ptr<server::ProcessImage> image;
    std::weak_ptr<server::ProcessImage> kept;
    std::unique_ptr<server::ImageSource> source;
    NodeId lies_in_image;
};

} // namespace

TEST_CASE_METHOD(ImageEndFixture, "what is monitored in an image whose source ends says so")
{
    monitor(lies_in_image, GENERATE(50.0, 0.0));
    scan(2);
    CHECK(next_value() == Variant{2});
    waker_of_sources.count = 0;
    source.reset();
    CHECK(waker_of_sources.count == 1);
    SECTION("with the image")
    {
        image.reset();
        CHECK(next_status() == status::Bad_NoCommunication);
        CHECK_FALSE(next());
    }
    SECTION("while the image goes on, for a source that comes after it")
    {
        CHECK(next_status() == status::Bad_NoCommunication);
        scan(3);
        CHECK_FALSE(next());
        source = std::make_unique<server::ImageSource>(image);
        model::AddressSpace& space = server.address_space();
        space.bind(space.find(lies_in_image), server.add_source(*source), 0);
        scan(4);
        CHECK(next_value() == Variant{4});
        scan(5);
        CHECK(next_value() == Variant{5});
    }
}

TEST_CASE_METHOD(ImageEndFixture, "a server keeps an image no longer than it has items of it")
{
    monitor(lies_in_image, GENERATE(50.0, 0.0));
    CHECK(next_value() == Variant{1});
    source.reset();
    image.reset();
    CHECK(next_status() == status::Bad_NoCommunication);
    CloseSessionRequest request;
    request.delete_subscriptions = true;
    REQUIRE(client.call<CloseSessionResponse>(request));
    server.handle_completions(now);
    advance(1s);
    CHECK(kept.expired());
}

} // namespace source_end_test
