#include <catch2/catch.hpp>

#include "client/subscription/sequence_tracker.hpp"

namespace sequence_tracker_test {

using namespace busbar;
using client::detail::SequenceTracker;
using Arrival = SequenceTracker::Arrival;

namespace {

struct Tracked {
    Arrival put(std::uint32_t number)
    {
        NotificationMessage message{number, {}, {}};
        return tracker.put(message);
    }
    std::vector<std::uint32_t> take_all()
    {
        std::vector<std::uint32_t> all;
        while (const auto message = tracker.take()) {
            all.push_back(message->sequence_number);
        }
        return all;
    }
    using Numbers = std::vector<std::uint32_t>;

    SequenceTracker tracker{5};
};

} // namespace

TEST_CASE_METHOD(Tracked, "Messages are taken in the order of their numbers", "[client]")
{
    CHECK(put(1) == Arrival::Kept);
    CHECK(put(3) == Arrival::Kept);
    CHECK(put(4) == Arrival::Kept);
    CHECK(take_all() == Numbers{1});
    CHECK(tracker.is_missing());
    CHECK(tracker.next() == 2);
    CHECK(put(2) == Arrival::Kept);
    CHECK(take_all() == Numbers{2, 3, 4});
    CHECK_FALSE(tracker.is_missing());
}

TEST_CASE_METHOD(Tracked, "Messages that come twice are taken once", "[client]")
{
    CHECK(put(2) == Arrival::Kept);
    CHECK(put(2) == Arrival::Repeated);
    CHECK(put(1) == Arrival::Kept);
    CHECK(take_all() == Numbers{1, 2});
    CHECK(put(1) == Arrival::Duplicate);
    CHECK(put(0) == Arrival::Duplicate); // no sequence number
}

TEST_CASE_METHOD(Tracked, "Sequence numbers begin again with 1", "[client]")
{
    tracker.restart(0xFFFF'FFFE);
    CHECK(put(1) == Arrival::Kept);
    CHECK(put(0xFFFF'FFFF) == Arrival::Kept);
    CHECK(tracker.is_missing());
    CHECK(put(0xFFFF'FFFE) == Arrival::Kept);
    CHECK(take_all() == Numbers{0xFFFF'FFFE, 0xFFFF'FFFF, 1});
    CHECK(tracker.next() == 2);
    CHECK(put(0xFFFF'FFFF) == Arrival::Duplicate);
}

TEST_CASE_METHOD(Tracked, "What was sent and is not here is missing", "[client]")
{
    CHECK(tracker.expect_before(1));
    CHECK_FALSE(tracker.is_missing());
    CHECK(tracker.expect_before(3));
    CHECK(tracker.is_missing());
    tracker.skip();
    CHECK(tracker.is_missing());
    tracker.skip();
    CHECK_FALSE(tracker.is_missing());
    CHECK(tracker.next() == 3);
    CHECK(tracker.expect_through(3));
    CHECK(tracker.is_missing());
}

TEST_CASE_METHOD(Tracked, "Numbers far ahead are not believed", "[client]")
{
    CHECK(put(6) == Arrival::Kept);
    CHECK(put(7) == Arrival::TooFar);
    CHECK_FALSE(tracker.expect_before(7));
    CHECK_FALSE(tracker.expect_through(7));
    CHECK(tracker.kept_count() == 1);
    tracker.restart(7);
    CHECK(tracker.kept_count() == 0);
    CHECK_FALSE(tracker.is_missing());
    CHECK(put(7) == Arrival::Kept);
    CHECK(take_all() == Numbers{7});
}

} // namespace sequence_tracker_test
