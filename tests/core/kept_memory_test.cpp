#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/core/array.hpp>

#include "core/kept_memory.hpp"

namespace kept_memory_test {

using namespace busbar;
using busbar::detail::KeptMemory;

namespace {

constexpr std::size_t megabyte = 1U << 20U;
using Numbers = Array<std::uint64_t>;

Numbers numbers(std::size_t bytes)
{
    return Numbers(bytes / sizeof(std::uint64_t));
}

} // namespace

TEST_CASE("Large memory is used again by who needs as much")
{
    KeptMemory kept{4 * megabyte};
    const KeptMemory::Use use{kept};
    const void* where = nullptr;
    {
        const Numbers first = numbers(megabyte);
        where = first.data();
        CHECK(kept.held() == 0);
    }
    CHECK(kept.held() == megabyte);
    SECTION("of about the size")
    {
        const Numbers second = numbers(megabyte * 15 / 16);
        CHECK(second.data() == where);
        CHECK(kept.held() == 0);
    }
    SECTION("not of less than eight ninths, and not of more")
    {
        const Numbers less = numbers(megabyte * 7 / 8);
        const Numbers more = numbers(2 * megabyte);
        CHECK(less.data() != where);
        CHECK(more.data() != where);
        CHECK(kept.held() == megabyte);
    }
    SECTION("the one that fits best")
    {
        {
            const Numbers larger = numbers(megabyte * 33 / 32);
        }
        const Numbers second = numbers(megabyte * 15 / 16);
        CHECK(second.data() == where);
    }
    SECTION("new values are there, whatever was before")
    {
        const Numbers second = numbers(megabyte);
        CHECK(std::count(second.begin(), second.end(), 0U) ==
              static_cast<std::ptrdiff_t>(second.size()));
    }
}

TEST_CASE("No more large memory is kept than was said")
{
    KeptMemory kept{2 * megabyte};
    const KeptMemory::Use use{kept};
    {
        std::vector<Numbers> many;
        for (int i = 0; i < 5; ++i) {
            many.push_back(numbers(megabyte));
        }
    }
    CHECK(kept.held() == 2 * megabyte);
    {
        const Numbers small = numbers(1'000);
    }
    CHECK(kept.held() == 2 * megabyte);
}

TEST_CASE("Large memory that nobody needs goes back")
{
    KeptMemory kept{4 * megabyte};
    const KeptMemory::Use use{kept};
    TimePoint now{std::chrono::hours{1}};
    kept.note(now);
    CHECK(kept.next_deadline() == no_deadline);
    {
        const Numbers once = numbers(megabyte);
        const Numbers often = numbers(2 * megabyte);
    }
    kept.note(now);
    CHECK(kept.next_deadline() == now + KeptMemory::age);
    kept.handle_deadline(now); // too early
    CHECK(kept.held() == 3 * megabyte);
    now += KeptMemory::age;
    kept.handle_deadline(now);
    CHECK(kept.held() == 3 * megabyte);
    {
        const Numbers again = numbers(2 * megabyte);
    }
    now += KeptMemory::age;
    kept.handle_deadline(now);
    CHECK(kept.held() == 2 * megabyte);
    now += KeptMemory::age;
    kept.handle_deadline(now);
    CHECK(kept.held() == 0);
    CHECK(kept.next_deadline() == no_deadline);
}

TEST_CASE("Large memory goes to who is told to keep it, and from any thread")
{
    KeptMemory one{4 * megabyte};
    KeptMemory other{4 * megabyte};
    Numbers outside = numbers(megabyte);
    {
        const KeptMemory::Use use{one};
        {
            const KeptMemory::Use inner{other};
            outside.reset();
        }
        CHECK(other.held() == megabyte);
        outside = numbers(megabyte);
        std::thread{[&] { outside.reset(); }}.join(); // keeps nothing
    }
    CHECK(one.held() == 0);
    const Numbers last = numbers(megabyte);
    CHECK(other.held() == megabyte);
}

} // namespace kept_memory_test
