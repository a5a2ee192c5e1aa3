// Tests that fail, so that adapters_test.sh sees what is printed.
#include <busbar/harness/gtest.hpp>

namespace gtest_cases {

using namespace busbar;
using namespace busbar::harness;

class Cases : public BenchTest {};

TEST_F(Cases, AValueIsAnother)
{
    const NodeId level = need(add_variable("Level", 1.5));
    EXPECT_TRUE(holds(read(level), 2.5));
    EXPECT_TRUE(has_status(read(level), status::Good));
}

TEST_F(Cases, WhatIsNeededFails)
{
    need(add_variable("Level", 1.5));
    need(add_variable("Level", 1.5));
}

TEST_F(Cases, AValueNeverComes)
{
    const NodeId level = need(add_variable("Level", 1.5));
    await(level, 7.0, std::chrono::seconds{5});
}

TEST_F(Cases, AFaultNeverActs)
{
    world().network().play(fault::cut().at(Message{"WriteRequest"}));
    EXPECT_TRUE(succeeds(connect()));
}

} // namespace gtest_cases
