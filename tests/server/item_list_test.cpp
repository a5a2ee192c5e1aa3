#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <vector>

#include "bare_subscription.hpp"
#include "server/subscription/item_list.hpp"
#include "support/allocation_count.hpp"

namespace item_list_test {

using namespace busbar;
using namespace busbar::server::detail;
using namespace busbar::test;

namespace {

struct EmptyItem final : MonitoredItem {
    explicit EmptyItem(Subscription& subscription)
        : MonitoredItem{subscription, Kind::Data, 0, MonitoringMode::Reporting}
    {
    }
    [[nodiscard]] std::size_t queued() const override { return 0; }
    void take_notification(binary::Writer&, std::size_t) override {}
    void modify(const ItemContext&, const MonitoringParameters&, TimestampsToReturn,
                ItemRevision&) override
    {
    }
    void user_changed(const ItemContext&) override {}
    void clear() override {}
};

struct ListFixture {
    std::uint32_t add() { return list.add(std::make_unique<EmptyItem>(*parts.subscription)).id(); }
    [[nodiscard]] std::vector<std::uint32_t> ids() const
    {
        std::vector<std::uint32_t> found;
        list.for_each([&](const MonitoredItem& item) { found.push_back(item.id()); });
        CHECK(found.size() == list.size());
        for (const std::uint32_t id : found) {
            REQUIRE(list.find(id) != nullptr);
            CHECK(list.find(id)->id() == id);
        }
        return found;
    }

    BareSubscription parts;
    ItemList list;
};

using Ids = std::vector<std::uint32_t>;

} // namespace

TEST_CASE_METHOD(ListFixture, "items are found by their ids until they are removed, in any order")
{
    Ids expected;
    for (std::uint32_t id = 1; id <= 100; ++id) {
        CHECK(add() == id);
        expected.push_back(id);
    }
    Ids order = expected;
    SECTION("as they came") {}
    SECTION("backwards")
    {
        std::reverse(order.begin(), order.end());
    }
    SECTION("mixed")
    {
        std::shuffle(order.begin(), order.end(), std::minstd_rand{7});
    }
    for (const std::uint32_t id : order) {
        CHECK(list.remove(id));
        CHECK_FALSE(list.remove(id));
        CHECK(list.find(id) == nullptr);
        std::erase(expected, id);
        CHECK(ids() == expected);
    }
    CHECK(add() == 101);
    CHECK(ids() == Ids{101});
}

TEST_CASE_METHOD(ListFixture, "few items have no memory of the many that there were")
{
    constexpr std::uint32_t many = 10'000;
    for (std::uint32_t id = 1; id <= 10; ++id) {
        add();
    }
    const std::size_t before = held_bytes();
    for (std::uint32_t id = 11; id <= many; ++id) {
        add();
    }
    SECTION("removed as they came")
    {
        for (std::uint32_t id = 11; id <= many; ++id) {
            REQUIRE(list.remove(id));
        }
    }
    SECTION("removed from the end")
    {
        while (list.size() > 10) {
            list.remove_last();
        }
    }
    CHECK(held_bytes() < before + 10'000);
    CHECK(ids() == Ids{1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
}

TEST_CASE_METHOD(ListFixture, "the last items are removed first, whatever holes there are")
{
    for (int i = 0; i < 5; ++i) {
        add();
    }
    CHECK(list.remove(4));
    CHECK(list.remove(1));
    list.remove_last();
    CHECK(ids() == Ids{2, 3});
    list.remove_last();
    list.remove_last();
    CHECK(list.size() == 0);
    CHECK(add() == 6);
}

TEST_CASE_METHOD(ListFixture, "ids that begin anew pass over those that are in use")
{
    for (int i = 0; i < 6; ++i) { // 1 to 6
        add();
    }
    ItemList wrapped{UINT32_MAX - 1};
    std::swap(list, wrapped);
    CHECK(add() == UINT32_MAX);
    CHECK(add() == 1);
    CHECK(add() == 2);
    CHECK(list.remove(1));
    CHECK(ids() == Ids{2, UINT32_MAX});
}

} // namespace item_list_test
