#include <map>

#include "failure_world.hpp"
#include "support/failing_worlds.hpp"

namespace subscription_allocation_failure_test {

/// Subscriptions of a client with the k-th of the client's allocations failing, for k = 1, 2,
/// ... until nothing fails. Whatever was under way, soon all items have their values again.
using namespace busbar;
using namespace busbar::test;

namespace {

/// A client that watches two Variables, one of them by its path.
class Watcher {
public:
    ~Watcher() { fail_allocation(0); }

    void begin()
    {
        try_often([&] {
            client::SubscriptionSettings settings;
            settings.publishing_interval = 100ms;
            settings.max_keep_alive_count = 10;
            subscription = world.client.subscriptions().create(settings, handlers()).value();
        });
        try_often([&] {
            items = world.client.subscriptions()
                        .add_items(subscription, {item(NodeId{1, "level"}), item(deep_path())})
                        .value();
        });
    }
    void change()
    {
        client::ItemSettings settings = item(NodeId{});
        settings.sampling_interval = 300ms;
        settings.timestamps = TimestampsToReturn::Server;
        try_often([&] {
            const auto changed = world.client.subscriptions().modify_items(items, settings);
            const Uncounted in_test;
            REQUIRE(changed);
        });
        try_often([&] {
            client::SubscriptionSettings slower;
            slower.publishing_interval = 200ms;
            const auto changed = world.client.subscriptions().modify(subscription, slower);
            const Uncounted in_test;
            REQUIRE(changed);
        });
        world.advance(3s);
    }
    /// Both Variables have this value from now on.
    void set(std::int32_t value)
    {
        for (const char* const name : {"level", "deep"}) {
            auto& space = world.site.server.address_space();
            REQUIRE(space.set_value(space.find(NodeId{1, name}), Variant{value}));
        }
    }
    void publish()
    {
        for (std::int32_t value = 1; value <= 3; ++value) {
            set(value);
            world.advance(300ms);
        }
    }
    /// The connection is away for that time, in which more changes than the server keeps messages.
    void be_away(Duration time)
    {
        world.cut();
        for (std::int32_t value = 11; value <= 15; ++value) {
            set(value);
            world.advance(time / 5, 1s);
        }
        world.is_reachable = true;
        world.advance(20s, 200ms);
    }
    [[nodiscard]] bool all_are(std::int32_t value) const
    {
        return items.size() == 2 && std::all_of(items.begin(), items.end(), [&](auto handle) {
                   const auto found = last.find(handle);
                   return found != last.end() && found->second == Variant{value};
               });
    }

    ClientWorld world;
    client::SubscriptionHandle subscription{0};
    std::vector<client::ItemHandle> items;
    std::map<client::ItemHandle, Variant> last;

private:
    [[nodiscard]] static client::NodeAddress deep_path()
    {
        return client::NodeAddress::path("/Objects/1:plant/1:left/1:deep").value();
    }
    [[nodiscard]] static client::ItemSettings item(client::NodeAddress node)
    {
        client::ItemSettings settings;
        settings.node = std::move(node);
        settings.sampling_interval = 50ms;
        return settings;
    }
    [[nodiscard]] client::SubscriptionHandlers handlers()
    {
        client::SubscriptionHandlers handlers;
        handlers.on_data = [this](std::span<const client::DataChange> changes) {
            const Uncounted in_test;
            for (const client::DataChange& change : changes) {
                last[change.item] = change.value.value;
            }
        };
        return handlers;
    }
    /// A wish that finds no memory changes nothing, and may be said again.
    template <typename Wish>
    void try_often(Wish wish)
    {
        bool is_done = false;
        for (int i = 0; i < 3 && !is_done; ++i) {
            try {
                const Counted while_it_works;
                wish();
                is_done = true;
            } catch (const std::bad_alloc&) {
                continue;
            }
        }
        REQUIRE(is_done);
    }
};

struct Row {
    const char* name;
    bool is_begun_before;
    void (*act)(Watcher&);
};

constexpr Row rows[] = {
    {"begin", false,
     [](Watcher& watcher) {
         watcher.begin();
         watcher.world.advance(2s);
     }},
    {"change", true, [](Watcher& watcher) { watcher.change(); }},
    {"publish", true, [](Watcher& watcher) { watcher.publish(); }},
    {"a connection lost", true, [](Watcher& watcher) { watcher.be_away(5s); }},
    {"a session lost", true, [](Watcher& watcher) { watcher.be_away(1h); }},
};

/// False if nothing failed.
bool fail_once(const Row& row, std::size_t k)
{
    Watcher watcher;
    REQUIRE(watcher.world.is_ready());
    if (row.is_begun_before) {
        watcher.begin();
        watcher.world.advance(2s);
        REQUIRE(watcher.all_are(1));
    }
    fail_allocation(k);
    row.act(watcher);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO(row.name << ", allocation " << k << "\n" << watcher.world.site.log.text);
    CHECK(watcher.world.thrown == 0);
    if (has_failed) {
        watcher.world.advance(60s, 500ms);
    }
    watcher.set(77);
    watcher.world.advance(5s);
    CHECK(watcher.world.is_ready());
    CHECK(watcher.all_are(77));
    CHECK(watcher.world.site.server.subscription_count() == 1);
    CHECK(watcher.world.site.server.monitored_item_count() == 2);
    return has_failed;
}

} // namespace

TEST_CASE("an allocation that fails leaves no item of a client without its values")
{
    for (const Row& row : rows) {
        DYNAMIC_SECTION(row.name)
        {
            check_failing_worlds(
                row.name, [&](std::size_t k) { return fail_once(row, k); },
                [](std::size_t k) { return k < 100 ? k + 1 : k + 7; });
        }
    }
}

} // namespace subscription_allocation_failure_test
