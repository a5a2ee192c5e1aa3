#include <catch2/catch.hpp>

#include "client/pending_requests.hpp"

namespace pending_requests_test {

using namespace busbar;
using client::detail::DeadlineHeap;
using client::detail::PendingRequests;

namespace {

TimePoint at(int seconds)
{
    return TimePoint{} + std::chrono::seconds{seconds};
}

} // namespace

TEST_CASE("requests end in the order of their deadlines", "[pending_requests]")
{
    PendingRequests pending;
    CHECK(pending.next_deadline() == no_deadline);
    CHECK_FALSE(pending.take_expired(no_deadline));
    pending.add(1, at(30), 101);
    pending.add(2, at(10), 102);
    pending.add(3, no_deadline, 103);
    pending.add(4, at(20), 104);
    CHECK(pending.next_deadline() == at(10));
    CHECK(pending.remove(2) == 102);
    CHECK_FALSE(pending.remove(2));
    CHECK_FALSE(pending.remove(9));
    CHECK(pending.next_deadline() == at(20));

    CHECK_FALSE(pending.take_expired(at(19)));
    const auto expired = pending.take_expired(at(20));
    REQUIRE(expired);
    CHECK(expired->id == 4);
    CHECK(expired->context == 104);
    CHECK_FALSE(pending.take_expired(at(20)));

    pending.add(5, at(25), 105);
    const auto all = pending.take_all();
    REQUIRE(all.size() == 3);
    CHECK(all[0].id == 5);
    CHECK(all[1].context == 101);
    CHECK(all[2].id == 3);
    CHECK(pending.next_deadline() == no_deadline);
    CHECK(pending.take_all().empty());
}

TEST_CASE("a request may have the id of an earlier one", "[pending_requests]")
{
    PendingRequests pending;
    pending.add(7, at(50), 1);
    pending.add(8, at(40), 2);
    CHECK(pending.remove(7) == 1);
    pending.add(7, at(60), 3);
    CHECK(pending.remove(8) == 2);
    CHECK(pending.next_deadline() == at(60));
    CHECK_FALSE(pending.take_expired(at(50)));
    const auto expired = pending.take_expired(at(60));
    REQUIRE(expired);
    CHECK(expired->context == 3);
}

TEST_CASE("deadlines that count no longer do not pile up", "[pending_requests]")
{
    DeadlineHeap<int> heap;
    heap.add(at(1), 0);
    const auto is_first = [](TimePoint, int id) { return id == 0; };
    for (int id = 1; id < 10'000; ++id) {
        heap.add(at(1 + id), id);
        heap.prune(1, is_first);
        REQUIRE(heap.size() <= 40);
    }
    CHECK(heap.first() == 0);
    heap.prune(0, [](TimePoint, int) { return false; });
    CHECK(heap.size() == 0);
    CHECK(heap.next_deadline() == no_deadline);
}

} // namespace pending_requests_test
