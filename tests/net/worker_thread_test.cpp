#include <catch2/catch.hpp>

#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <busbar/harness/log_book.hpp>
#include <busbar/net/worker_thread.hpp>

namespace worker_thread_test {

using namespace busbar;

TEST_CASE("a worker does one job after the other, on its own thread")
{
    std::vector<int> done;
    std::promise<std::thread::id> last;
    net::WorkerThread worker;
    for (int i = 0; i < 10; ++i) {
        REQUIRE(worker.run([&done, i] { done.push_back(i); }));
    }
    REQUIRE(worker.run([&last] { last.set_value(std::this_thread::get_id()); }));
    CHECK(last.get_future().get() != std::this_thread::get_id());
    CHECK(done == std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
}

TEST_CASE("a worker goes on after a job that throws, and tells the log")
{
    harness::LogBook log;
    net::WorkerThread worker{64, &log};
    std::promise<void> last;
    REQUIRE(worker.run([] { throw std::runtime_error{"bus error"}; }));
    REQUIRE(worker.run([] { throw 1; }));
    REQUIRE(worker.run([&last] { last.set_value(); }));
    last.get_future().get();
    CHECK(log.contains("job of a WorkerThread threw: bus error"));
}

TEST_CASE("a worker that has too much to do says so, and stops when it goes")
{
    const auto held = std::make_shared<int>(0);
    std::promise<void> begun;
    std::promise<void> go_on;
    {
        net::WorkerThread worker{1};
        REQUIRE(worker.run([&] {
            begun.set_value();
            go_on.get_future().wait();
        }));
        begun.get_future().wait();
        CHECK(worker.run([held] { ++*held; })); // waits
        CHECK_FALSE(worker.run([] {}));
        go_on.set_value();
    }
    CHECK(held.use_count() == 1);
}

} // namespace worker_thread_test
