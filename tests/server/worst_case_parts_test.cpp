#include <catch2/catch.hpp>

#include <optional>
#include <string>

#include <busbar/server/image_structure.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/types/view.hpp>

#include "management_fixture.hpp"
#include "memory_growth.hpp"
#include "server/engine/channel_guard.hpp"
#include "server/users/login_guard.hpp"
#include "subscription_fixture.hpp"

namespace worst_case_parts_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE("memory of Subscriptions and their items")
{
    server::ServerLimits limits = server::small_controller_limits();
    limits.subscriptions.max_subscriptions_per_session = limits.subscriptions.max_subscriptions;
    limits.subscriptions.max_subscriptions_per_user = limits.subscriptions.max_subscriptions;
    SubscriptionFixture fixture{limits.subscriptions};
    auto client = fixture.log_in();
    SECTION("without items")
    {
        const Growth growth;
        for (std::size_t i = 0; i < limits.subscriptions.max_subscriptions; ++i) {
            static_cast<void>(fixture.subscribe(client));
        }
        REQUIRE_FALSE(
            client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request()));
        CHECK(growth.now() >= 1'000);
        CHECK(growth.now() <= rows(limits, {"subscriptions.max_subscriptions"}) + of_client);
    }
    SECTION("with those that are deleted and whose items go when there is time")
    {
        const NodeId node = fixture.add_variable("level", 1);
        const Growth growth;
        std::size_t after_first = 0;
        for (std::size_t i = 0; i < 10 * limits.subscriptions.max_subscriptions; ++i) {
            const std::uint32_t id = fixture.subscribe(client);
            for (int item = 0; item < 30; ++item) {
                SubscriptionFixture::monitor(client, id, SubscriptionFixture::item_request(node));
            }
            REQUIRE(client.status_of<DeleteSubscriptionsResponse>(
                        DeleteSubscriptionsRequest{{}, {id}}) == status::Good);
            if (i + 1 == limits.subscriptions.max_subscriptions) {
                after_first = growth.now();
            }
        }
        CHECK(after_first >= 12'500 * sizeof(void*)); // most of an item are pointers, or as large
        CHECK(growth.now() <= after_first + after_first / 4);
    }
}

namespace {

/// Items of which each waits for a slow client, until there is no memory for more.
struct ItemMemory {
    explicit ItemMemory(server::SubscriptionLimits l)
        : limits{l}, fixture{limits}, client{fixture.log_in()}
    {
    }

    /// How many there are.
    std::size_t fill(const MonitoredItemCreateRequest& item)
    {
        const std::uint32_t id = fixture.subscribe(client);
        std::size_t count = 0;
        while (SubscriptionFixture::monitor(client, id, item).status_code == status::Good) {
            ++count;
        }
        CHECK(SubscriptionFixture::monitor(client, id, item).status_code ==
              status::Bad_TooManyMonitoredItems);
        return count;
    }

    server::SubscriptionLimits limits;
    SubscriptionFixture fixture;
    TestClient client;
};

server::SubscriptionLimits item_limits()
{
    server::SubscriptionLimits limits = SubscriptionFixture::small_limits();
    limits.max_subscription_memory = 400'000;
    limits.max_memory = 1'000'000;
    limits.max_queue_size = 10;
    return limits;
}

} // namespace

TEST_CASE("memory of items, queues and long NodeIds")
{
    ItemMemory items{item_limits()};
    auto [name, queue] = GENERATE(std::pair{std::size_t{10}, 1U}, std::pair{std::size_t{10}, 10U},
                                  std::pair{std::size_t{4'000}, 1U});
    model::AddressSpace& space = items.fixture.server.address_space();
    model::NewNode node;
    node.id = NodeId{1, std::string(name, 'n')};
    node.browse_name = QualifiedName{1, "counter"};
    node.parent = space.find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value = Variant{1};
    const auto made = space.add_variable(node, variable);
    REQUIRE(made);
    auto request = SubscriptionFixture::item_request(node.id);
    request.requested_parameters.queue_size = queue;
    const Growth growth;
    const std::size_t count = items.fill(request);
    for (int i = 0; i < 30; ++i) {
        REQUIRE(space.set_value(*made, Variant{i}));
        items.fixture.advance(50ms);
    }
    INFO(count << " items");
    CHECK(count >= 20);
    CHECK(growth.now() >= items.limits.max_subscription_memory / 4);
    CHECK(growth.now() <= items.limits.max_subscription_memory + of_client);
}

TEST_CASE("memory of long values and of messages kept for Republish")
{
    ItemMemory items{item_limits()};
    const NodeId node =
        items.fixture.add_variable("text", Variant{String{std::string(5'000, 'a')}}, id::String);
    auto request = SubscriptionFixture::item_request(node);
    request.requested_parameters.queue_size = 10;
    const std::uint32_t id = items.fixture.subscribe(items.client);
    const Growth growth;
    for (int i = 0; i < 20; ++i) {
        REQUIRE(SubscriptionFixture::monitor(items.client, id, request).status_code ==
                status::Good);
    }
    for (int i = 0; i < 60; ++i) {
        items.fixture.set(0, Variant{String{std::string(5'000, static_cast<char>('a' + i % 26))}});
        if (i % 2 == 0) {
            SubscriptionFixture::publish(items.client);
        }
        items.fixture.advance(50ms);
        items.client.run();
        items.client.messages.clear();
    }
    CHECK(growth.now() >= items.limits.max_subscription_memory / 2);
    CHECK(growth.now() <= items.limits.max_subscription_memory + 2 * of_client);
}

TEST_CASE("memory of StatusChangeNotifications")
{
    server::SubscriptionLimits limits = SubscriptionFixture::small_limits();
    limits.max_status_changes = 1'000;
    SubscriptionFixture fixture{limits};
    auto client = fixture.log_in();
    const auto let_some_end = [&] {
        for (int i = 0; i < 100; ++i) {
            static_cast<void>(fixture.subscribe(client));
        }
        for (int i = 0; i < 40; ++i) { // their lifetime passes
            fixture.advance(100ms);
        }
    };
    let_some_end(); // the address space keeps room for the nodes of as many
    const Growth growth;
    for (int round = 0; round < 12; ++round) {
        let_some_end();
    }
    CHECK(fixture.server.subscription_count() == 0);
    server::ServerLimits all;
    all.subscriptions = limits;
    all.max_sessions = 1;
    CHECK(growth.now() >= 20'000);
    CHECK(growth.now() <= rows(all, {"subscriptions.max_status_changes"}) + of_client);
}

TEST_CASE("memory of raised events, which is there from the beginning")
{
    FixedWallClock clock;
    for (const std::size_t size : {0U, 2U, 100U, 1'024U}) {
        server::ServerLimits limits;
        limits.events.max_raised_events = size;
        const Growth growth;
        const server::EventQueue queue{clock, nullptr, size};
        CHECK(growth.now() >= size * sizeof(server::Event));
        CHECK(growth.now() <= rows(limits, {"events.max_raised_events"}) + 64);
    }
}

TEST_CASE("memory of logins")
{
    server::ServerLimits limits;
    limits.max_login_entries = 20;
    server::detail::LoginGuard guard{limits};
    const Growth growth;
    const TimePoint now{1h};
    for (int source = 0; source < 60; ++source) {
        const std::string certificate = std::to_string(source) + std::string(300, 'c');
        for (int user = 0; user < 20; ++user) {
            const std::string name = std::to_string(user) + std::string(5'000, 'u');
            const server::detail::LoginAttempt attempt{name, certificate, "192.0.2.1"};
            static_cast<void>(guard.failed(attempt, now));
            static_cast<void>(guard.failed(attempt, now));
            guard.succeeded({"!" + name, certificate, "192.0.2.1"});
        }
    }
    CHECK(growth.now() >= 20 * 1'000);
    CHECK(growth.now() <= rows(limits, {"max_login_entries"}));
}

TEST_CASE("memory of what OpenSecureChannels are rationed by")
{
    server::ServerLimits limits;
    limits.max_channel_entries = 100;
    server::detail::ChannelGuard guard{limits};
    const Growth growth;
    for (int source = 0; source < 1'000; ++source) {
        const std::string name = std::to_string(source) + ":ffff:ffff:ffff::/64";
        static_cast<void>(guard.admit(name, Duration::max(), TimePoint{1h}));
    }
    CHECK(growth.now() >= 100 * sizeof(std::string));
    CHECK(growth.now() <= rows(limits, {"max_channel_entries"}));
}

TEST_CASE("memory of continuation points and of nodes that clients add")
{
    ManagementFixture fixture{true, 200};
    server::ServerLimits limits = fixture.server.config().limits;
    SECTION("continuation points")
    {
        BrowseRequest request;
        request.requested_max_references_per_node = 1;
        request.nodes_to_browse.resize(limits.max_browse_continuation_points);
        for (BrowseDescription& one : request.nodes_to_browse) {
            one.node_id = NodeId{0, id::BaseObjectType};
            one.browse_direction = BrowseDirection::Both;
        }
        const Growth growth;
        for (int i = 0; i < 50; ++i) {
            REQUIRE(fixture.client.status_of<BrowseResponse>(request) == status::Good);
        }
        CHECK(growth.now() <= of_client);
    }
    SECTION("nodes")
    {
        const Growth growth;
        std::size_t count = 0;
        StatusCode last;
        while (last.is_good() && count < 1'000) {
            AddNodesRequest request;
            auto item = ManagementFixture::item(("node" + std::to_string(count)).c_str());
            ObjectAttributes attributes;
            attributes.specified_attributes = 64; // DisplayName
            attributes.display_name = LocalizedText{"en", std::string(3'000, 'd')};
            item.node_attributes = ExtensionObject::from(attributes);
            request.nodes_to_add = {item};
            const auto response = fixture.client.call<AddNodesResponse>(request);
            REQUIRE(response);
            last = response->results[0].status_code;
            count += last.is_good() ? 1U : 0U;
        }
        CHECK(last == status::Bad_OutOfMemory);
        CHECK(count == 200);
        CHECK(growth.now() >= count * 3'000);
        CHECK(growth.now() <=
              rows(limits, {"max_client_nodes", "max_client_node_memory"}) + of_client);
        // Which is far away with nodes as small as these: the two limits are each for itself.
        limits.max_client_node_memory = count * (256 + 64 + 8 * 3'200);
        CHECK(growth.now() <=
              rows(limits, {"max_client_nodes", "max_client_node_memory"}) + of_client);
    }
}

namespace {

server::ServerConfig many_references()
{
    server::ServerConfig config = config_with(true, 10);
    config.limits.max_client_references = 100;
    return config;
}

struct ReferenceFixture : Outside, ServerFixture {
    ReferenceFixture() : ServerFixture{no_waker, many_references(), &rights}
    {
        // Whom the RolePermissions of namespace 0, too, let refer to any node.
        users.everybody.roles = {"ConfigureAdmin"};
        client.emplace(log_in());
    }

    /// From the Objects folder to that node.
    StatusCode add(std::uint32_t id)
    {
        const model::AddressSpace& space = server.address_space();
        AddReferencesItem item;
        item.source_node_id = NodeId{0, id::ObjectsFolder};
        item.reference_type_id = NodeId{0, id::Organizes};
        item.is_forward = true;
        item.target_node_id = NodeId{0, id};
        item.target_node_class = space.node_class(space.find(id));
        AddReferencesRequest request;
        request.references_to_add = {item};
        const auto response = client->call<AddReferencesResponse>(request);
        return response ? response->results[0] : response.error();
    }

    std::optional<TestClient> client;
};

} // namespace

TEST_CASE("memory of references that clients add")
{
    ReferenceFixture fixture;
    const server::ServerLimits limits = fixture.server.config().limits;
    const Growth growth;
    std::size_t count = 0;
    StatusCode last;
    for (std::uint32_t id = 1; id < 20'000 && last != status::Bad_OutOfMemory; ++id) {
        if (fixture.server.address_space().find(id) != model::no_node) {
            last = fixture.add(id);
            count += last.is_good() ? 1U : 0U;
        }
    }
    CHECK(last == status::Bad_OutOfMemory);
    CHECK(count == limits.max_client_references);
    CHECK(growth.now() >= count * 100);
    CHECK(growth.now() <= rows(limits, {"max_client_references"}) + of_client);
}

TEST_CASE("memory of structures in scans that are held")
{
    using server::ImageVariable;
    const auto structure = [](const std::vector<ImageVariable>& members) {
        return server::ImageStructure::create(NodeId{1, "Types/Point"}, members).value();
    };
    const auto point = structure({{BuiltInType::Int16}, {BuiltInType::Double}});
    const auto recipe = structure({{BuiltInType::String, {20}, 500}, {BuiltInType::Int32, {300}}});
    server::ImageLayout layout;
    for (int i = 0; i < 50; ++i) {
        REQUIRE(layout.add({BuiltInType::ExtensionObject, {}, 0, point}));
    }
    REQUIRE(layout.add({BuiltInType::ExtensionObject, {200}, 0, point}));
    REQUIRE(layout.add({BuiltInType::ExtensionObject, {3, 2}, 0, recipe}));
    server::ImageOptions options;
    options.max_pins = 3;
    const auto image = server::ProcessImage::create(std::move(layout), options);
    for (std::uint32_t i = 0; i < 6 * 20; ++i) { // as long as they may be
        REQUIRE(image->memory().structure(51, i / 20).set_text(0, std::string(500, 't'), i % 20));
    }
    image->follow_scans(true);
    image->publish(DateTime{1});

    const server::ProcessImage* const images[] = {image.get()};
    const auto all =
        server::worst_case_memory(server::small_controller_limits(), {.images = images});
    const server::MemoryRow row = all.rows.back();
    CHECK(row.limit == "ImageOptions::max_pins");
    CHECK(row.value == options.max_pins);
    CHECK(row.count == options.max_pins + 1);
    const server::MemoryRow waiting = *(all.rows.end() - 2);
    CHECK(waiting.limit == "ImageOptions::max_waiting_bytes");
    CHECK(waiting.bytes() == options.max_waiting_bytes);
    CHECK(all.total() - server::worst_case_memory(server::small_controller_limits()).total() ==
          waiting.bytes() + row.bytes());

    std::vector<server::ImagePin> pins;
    pins.reserve(row.count);
    const Growth growth;
    for (std::uint32_t i = 0; i < options.max_pins; ++i) {
        pins.push_back(image->pin());
    }
    CHECK_FALSE(image->pin());
    pins.push_back(image->next_scan());
    for (const server::ImagePin& pin : pins) {
        REQUIRE(pin);
        for (std::uint32_t handle = 0; handle < image->size(); ++handle) {
            server::ReadSlot slot;
            CHECK(pin.read(handle, slot));
        }
    }
    CHECK(growth.now() >= row.count * 6 * 20 * 500);
    CHECK(growth.now() <= row.bytes());
}

TEST_CASE("an image without structures holds none")
{
    server::ImageLayout layout;
    REQUIRE(layout.add({BuiltInType::String, {4}, 10}));
    const auto image = server::ProcessImage::create(std::move(layout));
    const server::ProcessImage* const images[] = {image.get()};
    const server::MemoryRow row = server::worst_case_memory({}, {.images = images}).rows.back();
    CHECK(row.limit == "ImageOptions::max_pins");
    CHECK(row.bytes() == 0);
    CHECK(row.held.empty());
}

} // namespace worst_case_parts_test
