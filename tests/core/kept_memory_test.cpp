#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/core/array.hpp>

#include "core/kept_memory.hpp"
#include "support/allocation_count.hpp"

namespace kept_memory_test {

using namespace busbar;
using busbar::detail::KeptMemory;

namespace {

constexpr std::size_t megabyte = 1U << 20U;
using Numbers = Array<std::uint64_t>;

Numbers numbers(std::size_t bytes, KeptMemory& kept)
{
    Numbers made;
    made.reserve(bytes / sizeof(std::uint64_t), &kept);
    made.resize(bytes / sizeof(std::uint64_t));
    return made;
}

} // namespace

TEST_CASE("Large memory is used again by who needs as much")
{
    KeptMemory kept{4 * megabyte};
    const void* where = nullptr;
    {
        const Numbers first = numbers(megabyte, kept);
        where = first.data();
        CHECK(kept.held() == 0);
    }
    CHECK(kept.held() == megabyte);
    SECTION("of about the size")
    {
        const Numbers second = numbers(megabyte * 15 / 16, kept);
        CHECK(second.data() == where);
        CHECK(kept.held() == 0);
    }
    SECTION("not of less than eight ninths, and not of more")
    {
        const Numbers less = numbers(megabyte * 7 / 8, kept);
        const Numbers more = numbers(2 * megabyte, kept);
        CHECK(less.data() != where);
        CHECK(more.data() != where);
        CHECK(kept.held() == megabyte);
    }
    SECTION("the one that fits best")
    {
        {
            const Numbers larger = numbers(megabyte * 33 / 32, kept);
        }
        const Numbers second = numbers(megabyte * 15 / 16, kept);
        CHECK(second.data() == where);
    }
    SECTION("new values are there, whatever was before")
    {
        const Numbers second = numbers(megabyte, kept);
        CHECK(std::count(second.begin(), second.end(), 0U) ==
              static_cast<std::ptrdiff_t>(second.size()));
    }
}

TEST_CASE("No more large memory is kept than was said")
{
    KeptMemory kept{2 * megabyte};
    {
        std::vector<Numbers> many;
        for (int i = 0; i < 5; ++i) {
            many.push_back(numbers(megabyte, kept));
        }
    }
    CHECK(kept.held() == 2 * megabyte);
    {
        const Numbers small = numbers(1'000, kept);
    }
    CHECK(kept.held() == 2 * megabyte);
}

TEST_CASE("Large memory that nobody needs goes back")
{
    KeptMemory kept{4 * megabyte};
    TimePoint now{std::chrono::hours{1}};
    kept.note(now);
    CHECK(kept.next_deadline() == no_deadline);
    {
        const Numbers once = numbers(megabyte, kept);
        const Numbers often = numbers(2 * megabyte, kept);
    }
    kept.note(now);
    CHECK(kept.next_deadline() == now + KeptMemory::age);
    kept.handle_deadline(now); // too early
    CHECK(kept.held() == 3 * megabyte);
    now += KeptMemory::age;
    kept.handle_deadline(now);
    CHECK(kept.held() == 3 * megabyte);
    {
        const Numbers again = numbers(2 * megabyte, kept);
    }
    now += KeptMemory::age;
    kept.handle_deadline(now);
    CHECK(kept.held() == 2 * megabyte);
    now += KeptMemory::age;
    kept.handle_deadline(now);
    CHECK(kept.held() == 0);
    CHECK(kept.next_deadline() == no_deadline);
}

TEST_CASE("Large memory returns to where it was taken, from any thread")
{
    KeptMemory one{4 * megabyte};
    KeptMemory other{4 * megabyte};
    Numbers first = numbers(megabyte, one);
    Numbers second = numbers(megabyte, other);
    first.swap(second); // like a value that one server's program passes to another server
    second.reset();
    CHECK(one.held() == megabyte);
    CHECK(other.held() == 0);
    std::thread{[&] { first.reset(); }}.join();
    CHECK(other.held() == megabyte);

    const Numbers elsewhere(megabyte / sizeof(std::uint64_t));
    CHECK(one.held() == megabyte);
    CHECK(other.held() == megabyte);
}

TEST_CASE("Large memory may outlive what keeps it")
{
    const std::size_t before = busbar::test::held_bytes();
    {
        Numbers last;
        {
            KeptMemory kept{4 * megabyte};
            last = numbers(megabyte, kept);
            const Numbers one_more = numbers(2 * megabyte, kept);
        }
        CHECK(busbar::test::held_bytes() < before + 2 * megabyte);
        last[0] = 1;
    }
    CHECK(busbar::test::held_bytes() == before);
}

TEST_CASE("A vector that takes another's memory returns it where it was taken")
{
    using Vector = std::vector<std::uint64_t, busbar::detail::LargeAllocator<std::uint64_t>>;
    KeptMemory one{4 * megabyte};
    KeptMemory other{4 * megabyte};
    constexpr std::size_t count = megabyte / sizeof(std::uint64_t);
    {
        Vector first(count, Vector::allocator_type{&one});
        Vector second(count, Vector::allocator_type{&other});
        const void* const where = first.data();
        second = std::move(first);
        CHECK(second.data() == where);
        CHECK(other.held() == megabyte);
        second.resize(2 * count);
        CHECK(one.held() == megabyte);
    }
    CHECK(one.held() == 3 * megabyte);
}

} // namespace kept_memory_test
