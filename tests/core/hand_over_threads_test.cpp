#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/core/detail/bounded_ring.hpp>
#include <busbar/core/detail/hand_over.hpp>

namespace hand_over_threads_test {

using namespace busbar;

namespace {

constexpr int producers = 4;
constexpr int items_of_each = 5'000;

/// Has one thread wait until another one wakes it.
class Bell final : public Waker {
public:
    void wake() override
    {
        {
            const std::lock_guard lock{mutex_};
            is_rung_ = true;
        }
        rung_.notify_one();
    }
    void await()
    {
        std::unique_lock lock{mutex_};
        rung_.wait(lock, [this] { return is_rung_; });
        is_rung_ = false;
    }

private:
    std::mutex mutex_;
    std::condition_variable rung_;
    bool is_rung_{false};
};

struct Chained {
    int producer{0};
    int number{0}; // not atomic: the hand-over is what makes it visible
    Chained* next{nullptr};
};

struct Owned {
    int producer{0};
    int number{0};
    std::unique_ptr<Owned> next{};
};

Chained* following(Chained& item)
{
    return item.next;
}
Owned* following(Owned& item)
{
    return item.next.release();
}

/// Has several threads hand items over, and takes them when it is woken and not otherwise: a wake
/// that is missing is a test that does not end.
template <typename Item>
void check_hand_over()
{
    Bell bell;
    detail::WakerSlot slot{&bell};
    detail::HandOver<Item> given;
    std::vector<std::thread> threads;
    for (int producer = 0; producer < producers; ++producer) {
        threads.emplace_back([&, producer] {
            for (int number = 0; number < items_of_each; ++number) {
                auto item = std::make_unique<Item>();
                item->producer = producer;
                item->number = number;
                if (given.push(*item.release())) {
                    slot.wake();
                }
            }
        });
    }
    std::vector<int> seen(producers, 0);
    int out_of_order = 0;
    for (int left = producers * items_of_each; left > 0;) {
        bell.await();
        for (Item* item = given.take(); item != nullptr; --left) {
            const std::unique_ptr<Item> taken{item};
            item = following(*taken);
            int& expected = seen[static_cast<std::size_t>(taken->producer)];
            out_of_order += taken->number == expected ? 0 : 1;
            ++expected;
        }
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    CHECK(out_of_order == 0);
    CHECK(given.take() == nullptr);
}

/// The same with a ring that is often full, and with a flag that says whether the taker is awake.
void check_ring()
{
    struct Item {
        int producer{0};
        int number{0};
    };
    Bell bell;
    detail::WakerSlot slot{&bell};
    detail::BoundedRing<Item> ring{16};
    std::atomic<bool> is_awake{false};
    std::atomic<int> refused{0};
    std::vector<std::thread> threads;
    for (int producer = 0; producer < producers; ++producer) {
        threads.emplace_back([&, producer] {
            for (int number = 0; number < items_of_each;) {
                const bool is_put = ring.push([&](Item& item) { item = {producer, number}; });
                if (!is_awake.exchange(true)) {
                    slot.wake();
                }
                number += is_put ? 1 : 0;
                if (!is_put) {
                    ++refused;
                    std::this_thread::yield();
                }
            }
        });
    }
    std::vector<int> seen(producers, 0);
    int out_of_order = 0;
    for (int left = producers * items_of_each; left > 0;) {
        bell.await();
        is_awake = false; // before it looks
        Item taken;
        while (ring.take([&](Item& item) { taken = item; })) {
            int& expected = seen[static_cast<std::size_t>(taken.producer)];
            out_of_order += taken.number == expected ? 0 : 1;
            ++expected;
            --left;
        }
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    CHECK(out_of_order == 0);
    CHECK_FALSE(ring.take([](Item&) {}));
    UNSCOPED_INFO(refused << " refused");
}

/// Says whether it is used after its end.
class Mortal final : public Waker {
public:
    explicit Mortal(std::atomic<int>& late) : late_{&late} {}
    ~Mortal() override { is_alive_ = false; }

    void wake() override
    {
        ++count_; // of many threads
        if (!is_alive_) {
            ++*late_;
        }
    }

private:
    std::atomic<int>* late_;
    std::atomic<int> count_{0};
    std::atomic<bool> is_alive_{true};
};

} // namespace

TEST_CASE("a hand-over loses nothing, keeps the order and wakes whenever it is needed")
{
    SECTION("of items that others own")
    {
        check_hand_over<Chained>();
    }
    SECTION("of items that own each other")
    {
        check_hand_over<Owned>();
    }
    SECTION("of items in places of a ring")
    {
        check_ring();
    }
}

TEST_CASE("a ring refuses items that it has no place for, and keeps the others")
{
    detail::BoundedRing<int> ring{3}; // four
    for (int round = 0; round < 3; ++round) {
        for (int i = 0; i < 4; ++i) {
            CHECK(ring.push([&](int& place) { place = i; }));
        }
        CHECK_FALSE(ring.push([](int& place) { place = 9; }));
        for (int i = 0; i < 4; ++i) {
            int taken = -1;
            CHECK(ring.take([&](int& place) { taken = place; }));
            CHECK(taken == i);
        }
        CHECK_FALSE(ring.take([](int&) {}));
    }
}

TEST_CASE("what is lent is not used after it was taken back")
{
    struct Counter {
        int uses{0}; // not atomic: taking it back is what makes it visible
    };
    detail::Lent<Counter> lent;
    std::atomic<bool> is_over{false};
    std::atomic<int> used{0};
    std::thread user{[&] {
        while (!is_over) {
            lent.use([&](Counter& counter) {
                ++counter.uses;
                ++used;
            });
            std::this_thread::yield();
        }
    }};
    int counted = 0;
    for (int i = 0; i < 500; ++i) {
        auto counter = std::make_unique<Counter>();
        lent.set(counter.get());
        std::this_thread::yield();
        lent.set(nullptr, [] { std::this_thread::yield(); });
        counted += counter->uses;
    }
    is_over = true;
    user.join();
    CHECK(counted == used);
    CHECK(lent.is_empty());
}

TEST_CASE("a waker's slot does not use a Waker that was replaced")
{
    constexpr int rounds = 500;
    detail::WakerSlot slot;
    std::atomic<bool> is_over{false};
    std::atomic<int> late{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i) {
        threads.emplace_back([&] {
            while (!is_over) {
                slot.wake();
                std::this_thread::yield();
            }
        });
    }
    auto last = std::make_unique<Mortal>(late);
    slot.set(last.get());
    for (int i = 0; i < rounds; ++i) {
        auto next = std::make_unique<Mortal>(late);
        slot.set(i % 2 == 0 ? nullptr : next.get());
        last = std::move(next);
    }
    slot.set(nullptr);
    last = nullptr;
    is_over = true;
    for (std::thread& thread : threads) {
        thread.join();
    }
    CHECK(late == 0);
    CHECK(slot.is_empty());
}

} // namespace hand_over_threads_test
