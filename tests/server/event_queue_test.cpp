#include <catch2/catch.hpp>

#include <set>
#include <thread>

#include "model/model_fixture.hpp"
#include "server/engine/event_item_queue.hpp"
#include "server/event/notifiers.hpp"
#include "support/channel_pair.hpp"

#include <busbar/server/event.hpp>

namespace busbar::server::event_queue_test {

namespace {

struct CountingWaker final : Waker {
    void wake() override { ++count; }
    std::atomic<int> count{0};
};

Event numbered(std::uint16_t severity)
{
    Event event;
    event.severity = severity;
    return event;
}

struct QueueFixture {
    test::FixedWallClock clock;
    CountingWaker waker;
    EventQueue queue{clock, &waker, 4};

    std::vector<int> take()
    {
        queue.begin();
        std::vector<int> severities;
        Event event;
        while (queue.next(event)) {
            severities.push_back(event.severity);
        }
        return severities;
    }
};

} // namespace

TEST_CASE_METHOD(QueueFixture, "raised events arrive in their order and wake the server once")
{
    CHECK(queue.raise(numbered(1)));
    CHECK(queue.raise(numbered(2)));
    CHECK(waker.count == 1);
    CHECK(take() == std::vector{1, 2});
    CHECK(take().empty());
    CHECK(queue.raise(numbered(3)));
    CHECK(waker.count == 2);
    Event event;
    CHECK(queue.next(event));
    CHECK(event.time == clock.now());
    event.time = DateTime::from_unix_seconds(5);
    CHECK(queue.raise(event));
    CHECK(queue.next(event));
    CHECK(event.time == DateTime::from_unix_seconds(5));
}

TEST_CASE_METHOD(QueueFixture, "a queue that is full drops the newest and counts it")
{
    for (std::uint16_t round = 0; round < 3; ++round) {
        for (std::uint16_t i = 0; i < 4; ++i) {
            CHECK(queue.raise(numbered(i)));
        }
        CHECK_FALSE(queue.raise(numbered(9)));
        CHECK_FALSE(queue.raise(numbered(9)));
        CHECK(queue.dropped() == 2U * (round + 1U));
        CHECK(take() == std::vector{0, 1, 2, 3});
    }
}

TEST_CASE_METHOD(QueueFixture, "a queue whose server is gone refuses")
{
    CHECK(queue.raise(numbered(1)));
    queue.close();
    CHECK_FALSE(queue.raise(numbered(2)));
    CHECK(queue.dropped() == 0);
    CHECK(waker.count == 1);
    CHECK(take().empty());
}

TEST_CASE("events are raised by many threads at once")
{
    constexpr int thread_count = 4;
    constexpr int each = 2'000;
    test::FixedWallClock clock;
    CountingWaker waker;
    EventQueue queue{clock, &waker, 64};
    std::atomic<int> running{thread_count};
    std::vector<std::thread> threads;
    for (int t = 0; t < thread_count; ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < each; ++i) {
                Event event;
                event.source_name = String{std::to_string(t)};
                event.set({0, "Number"}, i);
                while (!queue.raise(event)) {
                    std::this_thread::yield();
                }
            }
            --running;
        });
    }
    int next[thread_count] = {};
    bool is_in_order = true;
    Event event;
    while (running > 0 || next[0] + next[1] + next[2] + next[3] < thread_count * each) {
        queue.begin();
        while (queue.next(event)) {
            const int thread = event.source_name.view()[0] - '0';
            is_in_order = is_in_order && event.fields.size() == 1 &&
                          event.fields[0].value == Variant{next[thread]};
            ++next[thread];
        }
        std::this_thread::yield();
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    CHECK(is_in_order);
    CHECK_FALSE(queue.next(event));
    CHECK(waker.count > 0);
}

using namespace detail;

namespace {

struct ItemQueueFixture {
    MemoryAccount account{10'000, nullptr};
    EventItemQueue queue{account};

    static EventItemQueue::Fields fields(int number) { return {Variant{number}}; }
    /// As an item does; -1 stands for the overflow event.
    void push(int number)
    {
        if (!queue.push(fields(number)) && queue.wants_overflow()) {
            queue.push_overflow(fields(-1));
        }
    }
    void resize(std::uint32_t capacity, bool discards_oldest)
    {
        if (!queue.set_capacity(capacity, discards_oldest) && queue.wants_overflow()) {
            queue.push_overflow(fields(-1));
        }
    }
    std::vector<int> take(std::size_t most = SIZE_MAX)
    {
        std::vector<int> numbers;
        while (queue.size() != 0 && numbers.size() < most) {
            numbers.push_back(*queue.oldest()[0].get_if<int>());
            queue.pop();
        }
        return numbers;
    }
};

using Numbers = std::vector<int>;

} // namespace

TEST_CASE_METHOD(ItemQueueFixture, "an item that discards the oldest says so in front")
{
    resize(3, true);
    for (int i = 1; i <= 3; ++i) {
        push(i);
    }
    CHECK(queue.size() == 3);
    push(4);
    CHECK(queue.size() == 4); // the overflow event is on top of the size
    push(5);
    CHECK(take() == Numbers{-1, 3, 4, 5});
    push(6);
    CHECK(take() == Numbers{6});
    for (int i = 1; i <= 5; ++i) {
        push(i);
    }
    CHECK(take(1) == Numbers{-1});
    push(6);
    CHECK(take() == Numbers{-1, 4, 5, 6});
}

TEST_CASE_METHOD(ItemQueueFixture, "an item that discards the newest says so at the end")
{
    resize(3, false);
    for (int i = 1; i <= 5; ++i) {
        push(i);
    }
    CHECK(take() == Numbers{1, 2, 5, -1});
    for (int i = 1; i <= 4; ++i) {
        push(i);
    }
    CHECK(take(2) == Numbers{1, 2});
    push(5); // there is place again, behind the loss
    push(6);
    push(7);
    CHECK(take() == Numbers{4, -1, 5, 7, -1});
}

TEST_CASE_METHOD(ItemQueueFixture, "a queue of one holds the newest event")
{
    for (const bool discards_oldest : {true, false}) {
        resize(1, discards_oldest);
        push(1);
        push(2);
        push(3);
        CHECK(take() == (discards_oldest ? Numbers{-1, 3} : Numbers{3, -1}));
    }
    resize(0, true);
    push(1);
    CHECK(take() == Numbers{1});
}

TEST_CASE_METHOD(ItemQueueFixture, "a queue that shrinks discards by its policy")
{
    resize(5, true);
    for (int i = 1; i <= 5; ++i) {
        push(i);
    }
    resize(2, true);
    CHECK(take() == Numbers{-1, 4, 5});
    resize(5, true);
    for (int i = 1; i <= 5; ++i) {
        push(i);
    }
    resize(2, false);
    CHECK(take() == Numbers{1, 2, -1});
}

TEST_CASE_METHOD(ItemQueueFixture, "events that cannot be paid for are lost, and that is told")
{
    const std::size_t all = account.left();
    resize(1'000, true);
    const EventItemQueue::Fields large{Variant{1}, Variant{String{std::string(3'000, 'x')}}};
    int lost = 0;
    for (int i = 0; i < 10; ++i) {
        if (!queue.push(large)) {
            ++lost;
            if (queue.wants_overflow()) {
                queue.push_overflow(fields(-1));
            }
        }
    }
    CHECK(lost == 7);
    CHECK(queue.size() == 4);
    CHECK(take() == Numbers{-1, 1, 1, 1});
    CHECK(account.left() == all);
    push(1);
    queue.clear();
    CHECK(account.left() == all);
}

namespace {

struct NotifierFixture : model::ModelFixture {
    std::set<std::string> names_above(const std::string& name)
    {
        std::set<std::string> names;
        for (const model::NodeIndex node : notifiers.above(find(name))) {
            CHECK(names.insert(space.browse_name(node).name.str()).second);
        }
        return names;
    }
    void link(const std::string& above, std::uint32_t type, const std::string& below)
    {
        REQUIRE(space.add_reference(find(above), NodeId{0, type}, find(below)));
    }

    Notifiers notifiers{space, 1'000};
};

using Names = std::set<std::string>;

} // namespace

TEST_CASE_METHOD(NotifierFixture, "an event reaches what is above its source")
{
    for (const char* name : {"plant", "hall", "press", "valve", "other", "label"}) {
        add_folder(name, objects);
    }
    CHECK(names_above("valve") == Names{"Server", "valve"});
    CHECK(names_above("nowhere") == Names{"Server"});
    link("plant", id::HasNotifier, "hall");
    link("hall", id::HasNotifier, "press");
    link("press", id::HasEventSource, "valve");
    link("label", id::Organizes, "valve");
    CHECK(names_above("valve") == Names{"Server", "valve", "press", "hall", "plant"});
    CHECK(names_above("press") == Names{"Server", "press", "hall", "plant"});
    CHECK(names_above("other") == Names{"Server", "other"});
    // A second way up, and a change that takes one away.
    link("other", id::HasEventSource, "valve");
    link("plant", id::HasNotifier, "other");
    CHECK(names_above("valve") == Names{"Server", "valve", "press", "hall", "plant", "other"});
    REQUIRE(space.remove_reference(find("hall"), NodeId{0, id::HasNotifier}, find("press")));
    CHECK(names_above("valve") == Names{"Server", "valve", "press", "plant", "other"});
    REQUIRE(space.remove(find("other")));
    CHECK(names_above("valve") == Names{"Server", "valve", "press"});
}

TEST_CASE_METHOD(NotifierFixture, "only what is above a node that changed is looked for again")
{
    for (const char* name : {"press", "valve", "other"}) {
        add_folder(name, objects);
    }
    link("press", id::HasEventSource, "valve");
    CHECK(names_above("valve") == Names{"Server", "valve", "press"});
    CHECK(notifiers.remembered() == 2);
    add_folder("elsewhere", find("other"));
    REQUIRE(space.remove(find("elsewhere")));
    CHECK(notifiers.remembered() == 2);
    add_folder("part", find("press"));
    CHECK(notifiers.remembered() == 1);
    CHECK(names_above("valve") == Names{"Server", "valve", "press"});
    CHECK(notifiers.remembered() == 2);
    REQUIRE(space.remove(find("valve")));
    REQUIRE(space.remove(find("press")));
    CHECK(notifiers.remembered() == 0);
}

TEST_CASE_METHOD(NotifierFixture, "nodes that come and go are not remembered for ever")
{
    Notifiers few{space, 3};
    for (int i = 0; i < 50; ++i) {
        const std::string name = std::to_string(i % 7);
        add_folder(name, objects);
        REQUIRE(
            space.add_reference(space.find(id::Server), NodeId{0, id::HasEventSource}, find(name)));
        CHECK(few.above(find(name)).size() == 2);
        REQUIRE(space.remove(find(name)));
        CHECK(few.remembered() == 0);
    }
}

TEST_CASE_METHOD(NotifierFixture, "references that go round do no harm")
{
    for (const char* name : {"a", "b", "c"}) {
        add_folder(name, objects);
    }
    link("a", id::HasNotifier, "b");
    link("b", id::HasNotifier, "c");
    link("c", id::HasNotifier, "a");
    CHECK(names_above("a") == Names{"Server", "a", "b", "c"});
    CHECK(names_above("c") == Names{"Server", "a", "b", "c"});
    Notifiers few{space, 2};
    CHECK(few.above(find("a")).size() == 2);
    CHECK(space.browse_name(few.above(find("a"))[0]).name == "Server");
}

} // namespace busbar::server::event_queue_test
