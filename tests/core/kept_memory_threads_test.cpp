#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/core/array.hpp>

#include "core/kept_memory.hpp"

namespace kept_memory_threads_test {

using namespace busbar;
using busbar::detail::KeptMemory;

TEST_CASE("Large memory is freed by many threads while its owner takes it")
{
    constexpr std::size_t most = 4U << 20U;
    constexpr std::size_t size = busbar::detail::large_memory / sizeof(std::uint64_t);
    using Numbers = Array<std::uint64_t>;
    KeptMemory kept{most};
    std::atomic<bool> is_over{false};
    std::mutex mutex; // guards the following
    std::vector<Numbers> made;
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i) {
        threads.emplace_back([&] {
            while (!is_over) {
                std::vector<Numbers> taken;
                {
                    const std::lock_guard lock{mutex};
                    taken.swap(made);
                }
            }
        });
    }
    for (int i = 0; i < 2'000; ++i) {
        Numbers one;
        one.reserve(size, &kept);
        one.push_back(1);
        const std::lock_guard lock{mutex};
        made.push_back(std::move(one));
    }
    is_over = true;
    for (std::thread& each : threads) {
        each.join();
    }
    made.clear();
    CHECK(kept.held() <= most);
    CHECK(kept.held() > 0);
}

} // namespace kept_memory_threads_test
