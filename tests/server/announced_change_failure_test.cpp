#include "failure_cases.hpp"
#include "server/subscription/value_queue.hpp"
#include "support/failing_worlds.hpp"

namespace announced_change_failure_test {

/// A change that is to be reported to items while there is no memory.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Each of two Variables has two items, which have told their first values.
struct AnnouncedWorld : FailureFixture {
    AnnouncedWorld()
    {
        const std::uint32_t subscription = subscribe();
        monitor(subscription);
        monitor(subscription);
        pass(100ms, client);
        REQUIRE(ask(client, failing::publish_something()) == status::Good);
    }
};

bool fail_once(std::size_t k, std::size_t most)
{
    AnnouncedWorld world;
    fail_allocation(k, most);
    world.counted([&] { world.server.announce_structure_change(FailureFixture::own("level")); });
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k << ", " << most);
    const auto told = world.reported();
    CHECK(told.size() == (world.thrown == 0 ? 2 : 0));
    for (const MonitoredItemNotification& one : told) {
        CHECK((one.value.status.value() & server::detail::ValueQueue::structure_changed_bit) != 0);
    }
    return has_failed;
}

} // namespace

TEST_CASE("a change is told to all items, or to none where there was no memory")
{
    const std::size_t most = GENERATE(1U, 1'000'000U);
    check_failing_worlds("a change", [&](std::size_t k) { return fail_once(k, most); });
}

} // namespace announced_change_failure_test
