#include <catch2/catch.hpp>

#include "client/subscription/publish_queue.hpp"

namespace publish_queue_test {

using namespace busbar;
using client::detail::PublishQueue;

namespace {

using Numbers = std::vector<std::uint32_t>;

Numbers numbers_of(const PublishQueue::Acknowledgements& acknowledgements)
{
    Numbers numbers;
    for (const auto& acknowledgement : acknowledgements) {
        numbers.push_back(acknowledgement.sequence_number);
    }
    return numbers;
}

} // namespace

TEST_CASE("Acknowledgements go with the next request, the oldest first", "[publish_queue]")
{
    PublishQueue queue{10};
    for (std::uint32_t number = 1; number <= 1'002; ++number) {
        queue.acknowledge(7, number);
    }
    const auto first = queue.add();
    CHECK(first.acknowledgements.size() == 1'000);
    CHECK(first.acknowledgements[0].subscription_id == 7);
    CHECK(numbers_of(queue.add().acknowledgements) == Numbers{1'001, 1'002});
    CHECK(queue.add().acknowledgements.empty());
    CHECK(queue.size() == 3);
}

TEST_CASE("What was not carried out is acknowledged again", "[publish_queue]")
{
    PublishQueue queue{10};
    queue.acknowledge(7, 1);
    const auto first = queue.add();
    queue.acknowledge(7, 2);
    CHECK(queue.failed(first.number));
    CHECK_FALSE(queue.failed(first.number));
    const auto second = queue.add();
    CHECK(numbers_of(second.acknowledgements) == Numbers{2, 1});
    queue.end_session();
    CHECK(queue.size() == 0);
    CHECK_FALSE(queue.answered(second.number));
    const auto third = queue.add();
    CHECK(numbers_of(third.acknowledgements) == Numbers{2, 1});
    REQUIRE(queue.answered(third.number));
    CHECK(queue.add().acknowledgements.empty());
}

TEST_CASE("Acknowledgements that nobody takes are given up, the oldest first", "[publish_queue]")
{
    PublishQueue queue{100};
    constexpr std::uint32_t count = 15'000;
    for (std::uint32_t i = 1; i <= count; ++i) {
        queue.acknowledge(1, i);
    }
    std::size_t kept = 0;
    std::uint32_t last = 0;
    for (auto next = queue.add(); !next.acknowledgements.empty(); next = queue.add()) {
        kept += next.acknowledgements.size();
        last = next.acknowledgements.back().sequence_number;
    }
    CHECK(kept < count);
    CHECK(kept >= 10'000);
    CHECK(last == count);
}

TEST_CASE("A Subscription that is gone is not acknowledged any more", "[publish_queue]")
{
    PublishQueue queue{10};
    queue.acknowledge(7, 1);
    queue.acknowledge(8, 2);
    const auto first = queue.add();
    queue.acknowledge(7, 3);
    queue.forget(7);
    CHECK(queue.failed(first.number));
    const auto second = queue.add();
    CHECK(numbers_of(second.acknowledgements) == Numbers{2});
    queue.forget(8);
    const auto acknowledged = queue.answered(second.number);
    REQUIRE(acknowledged);
    REQUIRE(acknowledged->size() == 1); // results are told apart by their places
    CHECK((*acknowledged)[0].subscription_id == 0);
}

TEST_CASE("No more Publish requests wait than are allowed",
          "[publish_queue][unit:Subscription Client Publish Configurable]")
{
    PublishQueue queue{3};
    CHECK(queue.missing(2) == 2);
    CHECK(queue.missing(9) == 3);
    const auto first = queue.add();
    CHECK(queue.missing(9) == 2);
    static_cast<void>(queue.add());
    static_cast<void>(queue.add());
    CHECK(queue.missing(9) == 0);
    CHECK(queue.missing(0) == 0);

    // The server refuses one of the three: two wait and no third.
    CHECK(queue.failed(first.number));
    CHECK(queue.refuse());
    CHECK(queue.missing(9) == 0);
    queue.end_session();
    CHECK(queue.missing(9) == 2);
    queue.begin_session();
    CHECK(queue.missing(9) == 3);
    CHECK_FALSE(queue.refuse());
    CHECK(queue.missing(9) == 1);
    CHECK(PublishQueue{0}.missing(9) == 1);
}

TEST_CASE("Requests that may be forgotten are renewed once", "[publish_queue]")
{
    PublishQueue queue{2};
    queue.acknowledge(7, 1);
    const auto first = queue.add();
    static_cast<void>(queue.add());
    queue.renew();
    CHECK(queue.missing(9) == 2);
    CHECK(queue.size() == 2);
    CHECK(numbers_of(queue.add().acknowledgements) == Numbers{1});
    queue.renew(); // the first two still wait
    CHECK(queue.missing(9) == 1);
    const auto acknowledged = queue.answered(first.number);
    REQUIRE(acknowledged);
    CHECK(acknowledged->empty());
    CHECK(queue.size() == 2);
}

} // namespace publish_queue_test
