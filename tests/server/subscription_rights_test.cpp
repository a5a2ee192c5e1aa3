#include <algorithm>

#include <catch2/catch.hpp>

#include "subscription_fixture.hpp"

namespace subscription_rights_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

// What a user may read, and who the user is, can change while items are sampled: Bad_NotReadable
// or Bad_UserAccessDenied comes with a Publish response then (Part 4, 5.13.2.1).

namespace {

constexpr Duration cycle = 100ms;

/// Lets in whom a test wants.
class NextUser final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        return next;
    }
    [[nodiscard]] server::UserIdentity anonymous() const override { return everybody; }

    server::UserIdentity next{UserTokenType::UserName, "operator"};
    server::UserIdentity everybody{server::anonymous_reader()};
};

/// Only one user may read anything.
class OneReader final : public server::AccessControl {
public:
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId&) const override
    {
        return true;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity& user, const NodeId&,
                                                 std::uint8_t access_level) const override
    {
        return user.name == reader ? access_level : std::uint8_t{0};
    }

    std::string reader{"operator"};
};

struct Rights {
    NextUser store;
    OneReader access;
};

struct RightsFixture : Rights, SubscriptionParts, ServerFixture {
    RightsFixture()
    {
        server = server::Server::create(insecure_config(), {.random = &random,
                                                            .wall_clock = &wall_clock,
                                                            .log = &log,
                                                            .validator = &validator,
                                                            .users = &store,
                                                            .access = &access})
                     .value();
        model::NewVariable variable;
        variable.source = server.add_source(memory);
        variable.handle = handle = memory.add(Variant{1});
        variable.data_type = NodeId{0, id::Int32};
        variable.value_rank = -1;
        model::NewNode node;
        node.id = level;
        node.browse_name = QualifiedName{1, "level"};
        node.parent = server.address_space().find(id::ObjectsFolder);
        REQUIRE(server.address_space().add_variable(node, variable));
        client.emplace(connect());
        REQUIRE(client->create_session());
        activate();
        id = client->call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
                 .value()
                 .subscription_id;
        auto item = SubscriptionFixture::item_request(level);
        item.requested_parameters.queue_size = 10;
        CHECK(SubscriptionFixture::monitor(*client, id, item).status_code == status::Good);
    }
    /// The session gets the user whom the store has next.
    void activate()
    {
        REQUIRE(client->activate(client->user("any", "any-secret")) == status::Good);
    }
    void set(int value) { memory.set(handle, Variant{value}); }
    /// Adds items to the Subscription until the server has so many.
    void fill(std::uint32_t subscription, std::size_t items)
    {
        while (server.monitored_item_count() < items) {
            auto item = SubscriptionFixture::item_request(level);
            item.requested_parameters.queue_size = 10;
            REQUIRE(SubscriptionFixture::monitor(*client, subscription, item).status_code ==
                    status::Good);
        }
    }
    /// Logs the user in once more, perhaps with other roles.
    TestClient log_in_again()
    {
        auto other = connect();
        REQUIRE(other.create_session());
        REQUIRE(other.activate(other.user("any", "any-secret")) == status::Good);
        return other;
    }
    /// What comes in the next cycle.
    std::vector<DataValue> next()
    {
        SubscriptionFixture::publish(*client);
        advance(cycle);
        client->run();
        std::vector<DataValue> values;
        while (!client->messages.empty()) {
            const auto id_of_next = client->messages.front().request_id;
            if (const auto response = SubscriptionFixture::take(*client, id_of_next)) {
                for (const auto& one : SubscriptionFixture::data(response->notification_message)) {
                    values.push_back(one.value);
                }
            }
        }
        return values;
    }

    NodeId level{1, "level"};
    std::uint64_t handle{0};
    std::optional<TestClient> client;
    std::uint32_t id{0};
};

using Values = std::vector<DataValue>;
const Values denied{DataValue{status::Bad_UserAccessDenied}};

} // namespace

TEST_CASE_METHOD(RightsFixture, "an item of a user whose token has expired is not readable")
{
    store.next.valid_until = {wall_clock.time.ticks + DateTime::ticks_per_second};
    activate();
    CHECK(next() == Values{Variant{1}});
    // In time, without any request.
    const auto request = SubscriptionFixture::publish(*client);
    advance(900ms);
    CHECK(log.text.find("has expired") != std::string::npos);
    advance(cycle);
    const auto response = SubscriptionFixture::take(*client, request);
    REQUIRE(response);
    const auto values = SubscriptionFixture::data(response->notification_message);
    REQUIRE(values.size() == 1);
    CHECK(values[0].value == denied[0]);
    set(5);
    CHECK(next().empty());
}

TEST_CASE_METHOD(RightsFixture, "many items get the rights of another user before they send again")
{
    constexpr std::size_t items = 1'000;
    fill(id, items);
    CHECK(next() == Values(items, DataValue{Variant{1}}));
    set(2);
    advance(60ms); // sampled for the first user
    store.next.name = "guest";
    activate();

    const auto publish = SubscriptionFixture::publish(*client);
    std::size_t turns = 0;
    for (; server.next_deadline() <= now; ++turns) {
        CHECK(SubscriptionFixture::status_of(*client, publish) == status::Bad_WouldBlock);
        server.handle_deadline(now);
    }
    CHECK(turns >= 4);
    advance(cycle);
    client->run();
    const auto response = SubscriptionFixture::take(*client, publish);
    REQUIRE(response);
    const auto values = SubscriptionFixture::data(response->notification_message);
    REQUIRE(values.size() == items);
    for (const auto& one : values) {
        REQUIRE(one.value == denied[0]);
    }
    SECTION("also if the Subscription ends meanwhile")
    {
        store.next.name = "operator";
        activate();
        CHECK(SubscriptionFixture::remove(*client, id) == status::Good);
        while (server.next_deadline() <= now) {
            server.handle_deadline(now);
        }
        CHECK(server.monitored_item_count() == 0);
    }
}

TEST_CASE_METHOD(RightsFixture, "a late Subscription sends its data when its items are reviewed")
{
    constexpr std::size_t items = 300;
    fill(id, items);
    CHECK(next() == Values(items, DataValue{Variant{1}}));
    set(2);
    advance(cycle); // it is late from now on
    store.next.roles = {"Observer"};
    TestClient other = log_in_again();
    TestClient* asking = &*client;
    std::uint32_t publish = 0;
    SECTION("for another user")
    {
        activate();
        publish = SubscriptionFixture::publish(*asking);
    }
    SECTION("for another session")
    {
        asking = &other;
        CHECK(other.call<CreateSubscriptionResponse>(
            SubscriptionFixture::subscription_request(10'000)));
        publish = SubscriptionFixture::publish(other);
        CHECK(SubscriptionFixture::transfer(other, id, true).status_code == status::Good);
    }
    CHECK(SubscriptionFixture::status_of(*asking, publish) == status::Bad_WouldBlock);
    while (server.next_deadline() <= now) {
        server.handle_deadline(now);
    }
    asking->run();
    const auto response = SubscriptionFixture::take(*asking, publish);
    REQUIRE(response);
    CHECK(response->subscription_id == id);
    const auto values = SubscriptionFixture::data(response->notification_message);
    CHECK(values.size() == items);
    CHECK(std::all_of(values.begin(), values.end(),
                      [](const auto& one) { return one.value == DataValue{Variant{2}}; }));
}

TEST_CASE_METHOD(RightsFixture, "the items of Subscriptions that move cost turns")
{
    constexpr std::size_t subscriptions = 20;
    constexpr std::size_t items = 20;
    TransferSubscriptionsRequest request;
    request.send_initial_values = true;
    request.subscription_ids = {id};
    while (request.subscription_ids.size() < subscriptions) {
        request.subscription_ids.push_back(
            client->call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
                .value()
                .subscription_id);
    }
    for (std::size_t i = 0; i < subscriptions; ++i) {
        fill(request.subscription_ids[i], (i + 1) * items);
    }
    store.next.roles = {"Observer"};
    TestClient other = log_in_again();
    const auto sent = other.send(request);
    std::size_t turns = 1;
    for (; other.connection.next_deadline() <= now; ++turns) {
        other.connection.handle_deadline(now);
    }
    CHECK(turns >= 10);
    const auto response = other.take<TransferSubscriptionsResponse>(sent);
    REQUIRE(response);
    CHECK(response->results.size() == subscriptions);
    CHECK(std::all_of(response->results.begin(), response->results.end(),
                      [](const auto& one) { return one.status_code == status::Good; }));
}

TEST_CASE_METHOD(RightsFixture, "a user who has expired may do what everybody may in that store")
{
    const auto [mask, expected] =
        GENERATE(std::pair{server::anonymous_reader().access_level_mask, status::Good},
                 std::pair{std::uint8_t{0}, status::Bad_UserAccessDenied});
    store.everybody.access_level_mask = mask;
    access.reader = ""; // whom anonymous users are called by
    store.next.valid_until = {wall_clock.time.ticks + DateTime::ticks_per_second};
    activate();
    advance(1s);
    ReadRequest request;
    request.nodes_to_read.push_back({level, 13, {}, {}});
    const auto response = client->call<ReadResponse>(request);
    REQUIRE(response);
    CHECK(response->results[0].status == expected);
}

TEST_CASE_METHOD(RightsFixture, "a user who expires loses what nobody has fetched")
{
    store.next.valid_until = {wall_clock.time.ticks + DateTime::ticks_per_second};
    activate();
    CHECK(next() == Values{Variant{1}});
    for (int i = 2; i < 8; ++i) {
        set(i);
        advance(cycle);
    }
    advance(500ms);
    CHECK(next() == denied);
}

TEST_CASE_METHOD(RightsFixture, "another user does not get what was queued for the one before")
{
    CHECK(next() == Values{Variant{1}});
    set(2);
    advance(cycle);
    store.next.name = "guest";
    activate();
    CHECK(next().empty()); // the Subscription was late: a keep-alive
    CHECK(next() == denied);
    set(3);
    CHECK(next().empty());
    store.next.name = "operator";
    activate();
    CHECK(next() == Values{Variant{3}});
}

TEST_CASE_METHOD(RightsFixture, "another user with the same rights gets what is queued")
{
    CHECK(next() == Values{Variant{1}});
    set(2);
    advance(cycle);
    store.next.roles = {"Observer"};
    activate();
    CHECK(next() == Values{Variant{2}});
}

TEST_CASE_METHOD(RightsFixture, "the same user with fewer rights")
{
    CHECK(next() == Values{Variant{1}});
    store.next.access_level_mask = 0;
    activate();
    CHECK(next() == denied);
}

TEST_CASE_METHOD(RightsFixture, "rights that the AccessControl takes and gives back")
{
    CHECK(next() == Values{Variant{1}});
    access.reader = "nobody";
    server.announce_access_change(now);
    CHECK(next() == denied);
    access.reader = "operator";
    server.announce_access_change(now);
    CHECK(next() == Values{Variant{1}});
}

TEST_CASE_METHOD(RightsFixture, "users of one name that others vouch for are not the same")
{
    store.next = {UserTokenType::IssuedToken, "maria", 0xFF, {}, "https://one"};
    activate();
    auto other = connect();
    REQUIRE(other.create_session());
    store.next.issuer = "https://other";
    REQUIRE(other.activate(other.user("any", "any-secret")) == status::Good);
    CHECK(SubscriptionFixture::transfer(other, id).status_code == status::Bad_UserAccessDenied);
    store.next.issuer = "https://one";
    REQUIRE(other.activate(other.user("any", "any-secret")) == status::Good);
    CHECK(SubscriptionFixture::transfer(other, id).status_code == status::Good);
}

TEST_CASE_METHOD(SubscriptionFixture, "a session that moves leaves no Publish request behind")
{
    const NodeId level = add_variable("level", 1);
    auto old = log_in();
    const std::uint32_t id = subscribe(old);
    CHECK(monitor(old, id, item_request(level)).status_code == status::Good);
    const std::uint32_t left = publish(old);
    auto client = connect();
    client.adopt(old);
    CHECK(client.activate(TestClient::anonymous()) == status::Good);
    // Nobody listens there any more.
    CHECK(take(old, left).error() == status::Bad_SecureChannelClosed);
    const std::uint32_t next = publish(client);
    advance(100ms);
    const auto response = take(client, next);
    REQUIRE(response);
    CHECK(data(response->notification_message).size() == 1);
}

} // namespace subscription_rights_test
