#pragma once

#include "subscription_fixture.hpp"

namespace busbar::test {

inline constexpr std::uint32_t overflow = 0x0480;

/// One client with a Subscription, and the variable `level`.
struct ItemFixture : SubscriptionFixture {
    explicit ItemFixture(const server::SubscriptionLimits& limits = small_limits())
        : SubscriptionFixture{limits}
    {
    }

    /// An item of `level` as `change` has it; the initial value is taken.
    template <typename Change>
    MonitoredItemCreateResult monitor_level(Change change)
    {
        auto item = item_request(level);
        change(item);
        const auto made = monitor(client, id, item);
        CHECK(made.status_code == status::Good);
        CHECK(next_data(client, cycle).size() == 1);
        return made;
    }
    /// Gives the variable each value and has it sampled; what of it was published then.
    std::vector<DataValue> reported(std::initializer_list<Variant> values)
    {
        for (const Variant& value : values) {
            set(0, value);
            advance(cycle / 2);
        }
        std::vector<DataValue> all;
        for (const auto& notification : next_data(client, cycle)) {
            all.push_back(notification.value);
        }
        return all;
    }

    NodeId level{add_variable("level", 1)};
    TestClient client{log_in()};
    std::uint32_t id{subscribe(client)};
};

} // namespace busbar::test
