// Tests that fail, so that adapters_test.sh sees what is printed.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <busbar/harness/doctest.hpp>

namespace doctest_cases {

using namespace busbar;
using namespace busbar::harness;

TEST_CASE_FIXTURE(Bench, "a value is another")
{
    const NodeId level = need(add_variable("Level", 1.5));
    CHECK(read(level) == holds(2.5));
}

TEST_CASE_FIXTURE(Bench, "what is needed fails")
{
    need(add_variable("Level", 1.5));
    need(add_variable("Level", 1.5));
}

TEST_CASE_FIXTURE(Bench, "a value never comes")
{
    const NodeId level = need(add_variable("Level", 1.5));
    await(level, holds(7.0), std::chrono::seconds{5});
}

TEST_CASE_FIXTURE(Bench, "a fault never acts")
{
    world().network().play(fault::cut().at(Message{"WriteRequest"}));
    CHECK(connect());
}

} // namespace doctest_cases
