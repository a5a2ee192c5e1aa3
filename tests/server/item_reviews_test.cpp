#include <stdexcept>
#include <string>
#include <vector>

#include <busbar/core/detail/guarded.hpp>

#include "bare_subscription.hpp"
#include "subscription_fixture.hpp"
#include "thrown.hpp"

namespace item_reviews_test {

using namespace busbar;
using namespace busbar::server::detail;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr TimePoint start{};

/// Lets items of a test throw, and counts what happens to them.
struct Reviews {
    /// The item with this id throws so many times.
    std::uint32_t failing{0};
    std::size_t failures{0};
    std::size_t done{0};
    /// The state of the Subscription at the last one.
    SubscriptionState state{SubscriptionState::Closed};
};

class ReviewedItem final : public MonitoredItem {
public:
    ReviewedItem(Subscription& subscription, Reviews& reviews)
        : MonitoredItem{subscription, Kind::Data, 1, MonitoringMode::Reporting}, reviews_{reviews}
    {
    }
    [[nodiscard]] std::size_t queued() const override { return 0; }
    void take_notification(binary::Writer&, std::size_t) override {}
    void modify(const ItemContext&, const MonitoringParameters&, TimestampsToReturn,
                ItemRevision&) override
    {
    }
    void user_changed(const ItemContext&) override
    {
        if (id() == reviews_.failing && reviews_.failures != 0) {
            --reviews_.failures;
            throw std::runtime_error{"no plan"};
        }
        ++reviews_.done;
        reviews_.state = subscription().state();
    }

protected:
    void clear() override {}

private:
    Reviews& reviews_;
};

struct ReviewFixture : BareSubscription {
    Subscription& subscribe(std::size_t items, Reviews& reviews)
    {
        limits.subscriptions.max_subscriptions_per_session = 1'000;
        const auto made = all.create(session, {100ms, 30, 3, 0, 0}, true, start);
        REQUIRE(made);
        for (std::size_t i = 0; i < items; ++i) {
            (*made)->add_item(std::make_unique<ReviewedItem>(**made, reviews));
        }
        return **made;
    }
    void change_user()
    {
        busbar::detail::attempt([&] { all.user_changed(session, start); });
    }
    /// Returns whether all work that was due is done without a throw.
    bool finish(TimePoint now = start)
    {
        bool is_whole = true;
        for (int i = 0; i < 100 && all.next_deadline() <= now; ++i) {
            is_whole &= busbar::detail::caught([&] { all.handle_deadline(now); }).is_good();
        }
        return is_whole;
    }
};

} // namespace

TEST_CASE_METHOD(ReviewFixture, "items are reviewed although one of them throws the first time")
{
    Reviews reviews{1, 1};
    Subscription& first = subscribe(3, reviews);
    Reviews others{1, 1};
    Subscription& second = subscribe(3, others);
    SECTION("for another user")
    {
        change_user();
    }
    SECTION("for changed rights")
    {
        busbar::detail::attempt([&] { all.access_changed(start); });
    }
    CHECK((first.is_in_review() || reviews.done == 3));
    CHECK((second.is_in_review() || others.done == 3));
    CHECK(finish());
    CHECK(finish(start + 99ms));
    CHECK(reviews.done == 3);
    CHECK(others.done == 3);
    CHECK_FALSE(first.is_in_review());
    CHECK_FALSE(second.is_in_review());
}

TEST_CASE_METHOD(ReviewFixture, "an item that keeps throwing does not stop other Subscriptions")
{
    Reviews reviews{2, 1'000};
    Subscription& first = subscribe(3, reviews);
    Reviews others;
    Subscription& second = subscribe(1'000, others);
    change_user();
    CHECK(finish());
    CHECK(others.done == 1'000);
    CHECK_FALSE(second.is_in_review());
    CHECK(first.is_in_review()); // it publishes nothing
    CHECK(log.text.find("no plan") != std::string::npos);
    CHECK(all.next_deadline() > start); // it waits a little
    reviews.failures = 0;
    CHECK(finish(start + 99ms));
    CHECK(reviews.done == 3);
    CHECK_FALSE(first.is_in_review());
}

TEST_CASE_METHOD(ReviewFixture, "Subscriptions without items are reviewed in turns, too")
{
    Reviews none;
    std::vector<Subscription*> made;
    for (int i = 0; i < 500; ++i) {
        made.push_back(&subscribe(0, none));
    }
    const auto pending = [&] {
        return std::count_if(made.begin(), made.end(),
                             [](const Subscription* one) { return one->is_in_review(); });
    };
    change_user();
    CHECK(pending() >= 300);
    all.handle_deadline(start);
    CHECK(pending() >= 100);
    CHECK(finish());
    CHECK(pending() == 0);
}

TEST_CASE_METHOD(ReviewFixture, "items are reviewed after other work that is due")
{
    Reviews reviews;
    subscribe(200, reviews);
    change_user();
    CHECK(reviews.done == 199); // the fixture's own Subscription, without items, counts as one
    CHECK(reviews.state == SubscriptionState::Normal);
    all.handle_deadline(start + 100ms);
    CHECK(reviews.done == 200);
    CHECK(reviews.state == SubscriptionState::Late);
}

TEST_CASE_METHOD(ReviewFixture, "a Subscription may end while others are reviewed")
{
    Reviews reviews;
    std::vector<Subscription*> made;
    for (int i = 0; i < 5; ++i) {
        made.push_back(&subscribe(300, reviews));
    }
    change_user();
    for (const std::size_t index : {2U, 0U, 4U}) {
        all.remove(*made[index]);
    }
    CHECK(finish());
    CHECK(reviews.done >= 600);
    CHECK_FALSE(made[1]->is_in_review());
    CHECK_FALSE(made[3]->is_in_review());
}

namespace {

/// Gives its user other roles at each login.
struct OtherRoles final : server::UserStore {
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        user.roles.emplace_back("Observer");
        return user;
    }
    server::UserIdentity user{UserTokenType::UserName, "operator"};
};

struct ThrowingAccess final : server::AccessControl {
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId&) const override
    {
        throw_if(is_broken);
        return true;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity&, const NodeId&,
                                                 std::uint8_t level) const override
    {
        return level;
    }
    bool is_broken{false};
};

} // namespace

TEST_CASE("the record of a transfer that ends in a fault has its status")
{
    OtherRoles store;
    ThrowingAccess access;
    ServerFixture fixture;
    fixture.server =
        server::Server::create(ServerFixture::insecure_config(), {.random = &fixture.random,
                                                                  .wall_clock = &fixture.wall_clock,
                                                                  .log = &fixture.log,
                                                                  .validator = &fixture.validator,
                                                                  .users = &store,
                                                                  .access = &access})
            .value();
    TestClient first = fixture.connect();
    TestClient second = fixture.connect();
    for (TestClient* const client : {&first, &second}) {
        REQUIRE(client->create_session());
        REQUIRE(client->activate(client->user("any", "any-secret")) == status::Good);
    }
    TransferSubscriptionsRequest request;
    request.subscription_ids = {
        first.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
            .value()
            .subscription_id};
    CHECK(SubscriptionFixture::monitor(
              first, request.subscription_ids[0],
              SubscriptionFixture::item_request(NodeId{0, id::Server_ServerStatus_State}))
              .status_code == status::Good);
    fixture.log.keeps_records = true;
    access.is_broken = true;
    CHECK(second.status_of<TransferSubscriptionsResponse>(request) == status::Bad_InternalError);
    const auto& records = fixture.log.records;
    const auto record = std::find_if(records.begin(), records.end(), [](const auto& line) {
        return line.find("SubscriptionsTransferred") != std::string::npos;
    });
    REQUIRE(record != records.end());
    CHECK(record->find("Bad_InternalError") != std::string::npos);
}

} // namespace item_reviews_test
