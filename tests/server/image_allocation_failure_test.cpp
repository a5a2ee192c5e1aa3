#include "bare_subscription.hpp"
#include "support/failing_worlds.hpp"
#include "support/source_caller.hpp"

namespace image_allocation_failure_test {

/// Counts and charges for the items of a process image when there is no memory.
using namespace busbar;
using namespace busbar::server::detail;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t max_memory = 8U << 20U;

/// A watch of the array, and an account of its own that pays for it.
struct Watched {
    /// False if there was no memory for it.
    [[nodiscard]] bool add()
    {
        return survives_counted([&] { place = watch.add(*item, array.handle); });
    }

    LargeArray array{max_memory};
    ValueItem* item{array.parts.add_item(1, array.curve, "0")};
    MemoryAccount account{max_memory, nullptr};
    ImageWatch watch{*array.image, account};
    std::uint32_t place{0};
};

bool fail_to_watch(std::size_t k)
{
    Watched clean;
    REQUIRE(clean.add());
    Watched world;
    fail_allocation(k);
    const bool is_added = world.add();
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k);
    CHECK(is_added != has_failed);
    if (!is_added) {
        CHECK(world.account.left() == max_memory);
        CHECK(world.watch.size() == 0);
        CHECK_FALSE(world.watch.is_wasteful());
        REQUIRE(world.add());
    }
    CHECK(world.account.left() == clean.account.left());
    CHECK_FALSE(world.watch.is_wasteful());
    world.watch.remove(world.place);
    CHECK(world.watch.is_wasteful()); // nobody uses the only variable
    return has_failed;
}

/// Items of a source that ends, which the next sample takes from the watch of its image.
bool fail_to_take_back(std::size_t k, std::size_t most)
{
    constexpr std::uint32_t item_count = 20;
    LargeArray array{max_memory};
    for (std::uint32_t handle = 1; handle <= item_count; ++handle) {
        array.parts.add_item(handle, array.curve, "0");
    }
    SubscriptionTable& all = array.parts.all;
    CHECK(array.parts.take() == item_count);
    array.source.reset();
    fail_allocation(k, most);
    for (int i = 0; i < 3; ++i) {
        static_cast<void>(survives_counted([&] { all.handle_deadline(all.next_deadline()); }));
    }
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k);
    for (int i = 0; i < 3; ++i) {
        all.handle_deadline(all.next_deadline());
    }
    CHECK(array.parts.take() == item_count); // that there is no source any more
    CHECK(array.image.use_count() == 1);
    for (std::uint32_t item = 1; item <= item_count; ++item) {
        CHECK(array.parts.subscription->remove_item(item));
    }
    while (all.next_deadline() < TimePoint{1s}) { // nobody looks at what is gone
        all.handle_deadline(all.next_deadline());
    }
    return has_failed;
}

} // namespace

TEST_CASE("items that are taken from a watch find no memory for their places")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("sample", [&](std::size_t k) { return fail_to_take_back(k, most); });
}

TEST_CASE("an item that finds no memory in the watch of an image is not counted or paid for")
{
    check_failing_worlds("ImageWatch::add", fail_to_watch);
}

TEST_CASE("the next item of a variable that the watch knows finds no memory")
{
    Watched world;
    REQUIRE(world.add());
    const std::uint32_t first = world.place;
    const std::size_t left = world.account.left();
    std::size_t failures = 0;
    for (int i = 0; i < 10; ++i) { // the places double
        fail_allocation(1);
        const bool is_added = world.add();
        fail_allocation(0);
        failures += is_added ? 0 : 1;
        if (is_added) {
            world.watch.remove(world.place);
        }
    }
    CHECK(failures != 0);
    CHECK(world.account.left() == left);
    CHECK_FALSE(world.watch.is_wasteful());
    world.watch.remove(first);
    CHECK(world.watch.is_wasteful());
}

TEST_CASE("a variable that has an item again is no waste")
{
    Watched world;
    for (int i = 0; i < 3; ++i) {
        REQUIRE(world.add());
        CHECK_FALSE(world.watch.is_wasteful());
        world.watch.remove(world.place);
        CHECK(world.watch.is_wasteful());
    }
}

TEST_CASE("an image whose new items were taken back is let go before they are sampled")
{
    TestWaker waker;
    LargeArray array{max_memory};
    array.parts.environment.waker = &waker; // so that scans can be followed
    Sampler& sampler = array.parts.all.sampler();
    array.parts.add_new_item(1, array.curve, "0", 0);
    CHECK(array.image.use_count() == 3); // the source and the sampler have it
    CHECK(array.parts.subscription->remove_item(1));
    array.scan(0, 1.5);
    sampler.handle_scans(TimePoint{});
    CHECK(array.image.use_count() == 2);
    sampler.sample_new(TimePoint{});
    CHECK(array.parts.take() == 0);
}

} // namespace image_allocation_failure_test
