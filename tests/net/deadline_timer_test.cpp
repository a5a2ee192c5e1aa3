#include <catch2/catch.hpp>

#include <chrono>
#include <vector>

#include <asio/io_context.hpp>

#include "net/clock.hpp"

namespace deadline_timer_test {

using namespace busbar;
using net::detail::now;
using std::chrono::hours;
using std::chrono::milliseconds;

namespace {

/// A timer that notes when it called.
struct Timed {
    void await(TimePoint deadline)
    {
        timer.await(deadline, [this] { calls.push_back(now()); });
    }

    asio::io_context context;
    net::detail::DeadlineTimer timer{context.get_executor()};
    std::vector<TimePoint> calls;
};

} // namespace

TEST_CASE("a deadline that is put off is waited for, and called once")
{
    Timed timed;
    const TimePoint first = now() + milliseconds{2};
    timed.await(first);
    timed.await(first + milliseconds{30});
    timed.await(first + milliseconds{20}); // later than what the system knows of
    timed.context.run();
    REQUIRE(timed.calls.size() == 1);
    CHECK(timed.calls[0] >= first + milliseconds{20});
}

TEST_CASE("a deadline that is put forward is waited for instead of the later one")
{
    Timed timed;
    const TimePoint start = now();
    timed.await(start + hours{10});
    timed.await(start + milliseconds{2});
    timed.context.run(); // would not end for hours
    REQUIRE(timed.calls.size() == 1);
    CHECK(timed.calls[0] >= start + milliseconds{2});
}

TEST_CASE("a deadline that is gone is not waited for")
{
    Timed timed;
    const bool is_cancelled = GENERATE(false, true);
    timed.await(now() + milliseconds{2});
    timed.await(now() + hours{10});
    if (is_cancelled) {
        timed.timer.cancel();
    } else {
        timed.await(no_deadline);
    }
    timed.context.run();
    CHECK(timed.calls.empty());
    timed.await(now() + milliseconds{2});
    timed.context.restart();
    timed.context.run();
    CHECK(timed.calls.size() == 1);
}

TEST_CASE("a deadline that is put off while it is called is waited for")
{
    asio::io_context context;
    net::detail::DeadlineTimer timer{context.get_executor()};
    int calls = 0;
    struct Again {
        void operator()() const
        {
            if (++*calls < 3) {
                timer->await(now() + milliseconds{1}, *this);
            }
        }
        net::detail::DeadlineTimer* timer;
        int* calls;
    };
    timer.await(now() + milliseconds{1}, Again{&timer, &calls});
    context.run();
    CHECK(calls == 3);
}

} // namespace deadline_timer_test
