// Tests that fail, so that adapters_test.sh sees what is printed.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>

namespace catch_cases {

using namespace busbar;
using namespace busbar::harness;

TEST_CASE_METHOD(BenchFixture, "a value is another")
{
    const NodeId level = need(add_variable("Level", 1.5));
    CHECK_THAT(read(level), holds(2.5));
}

TEST_CASE_METHOD(BenchFixture, "what is needed fails")
{
    need(add_variable("Level", 1.5));
    need(add_variable("Level", 1.5));
}

TEST_CASE_METHOD(BenchFixture, "a value never comes")
{
    const NodeId level = need(add_variable("Level", 1.5));
    await(level, holds(7.0), std::chrono::seconds{5});
}

TEST_CASE_METHOD(BenchFixture, "a fault never acts")
{
    world().network().play(fault::cut().at(Message{"WriteRequest"}));
    CHECK_THAT(connect(), succeeds<void>());
}

} // namespace catch_cases
