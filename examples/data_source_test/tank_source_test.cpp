#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>

#include "tank_source.hpp"

namespace tank_source_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

/// The tank in a server, and a client.
class TankFixture : public BenchFixture {
public:
    TankSource& tank{make_source<TankSource>()};
    NodeId level{need(add_variable("Level", tank.variable(TankSource::level, 0.0)))};
    NodeId set_point{need(add_variable("SetPoint", tank.variable(TankSource::set_point, 0.0)))};
};

TEST_CASE_METHOD(TankFixture, "the level is read")
{
    tank.fill_to(80);
    CHECK_THAT(read(level), holds(80.0));
}

TEST_CASE_METHOD(TankFixture, "the set point is written within its range")
{
    CHECK(write(set_point, 30.0) == status::Good);
    CHECK_THAT(read(set_point), holds(30.0));
    CHECK(write(set_point, 130.0) == status::Bad_OutOfRange);
    CHECK(write(level, 1.0) == status::Bad_NotWritable);
    CHECK_THAT(read(set_point), holds(30.0));
}

TEST_CASE_METHOD(TankFixture, "a client that watches the level sees it change, and only then")
{
    REQUIRE(subscribe(level, 100ms) == status::Good);
    run_for(10s);
    tank.fill_to(1);
    run_for(10s);
    tank.fill_to(2);
    run_for(10s);
    const auto seen = values(level);
    REQUIRE(seen.size() == 3);
    CHECK_THAT(seen[0], holds(0.0));
    CHECK_THAT(seen[2], holds(2.0));
}

TEST_CASE_METHOD(TankFixture, "another client sees what is written, and when")
{
    BenchClient& panel = client("panel");
    REQUIRE(panel.subscribe(set_point) == status::Good);
    CHECK(write(set_point, 30.0) == status::Good);
    CHECK_THAT(panel.await(set_point, 30.0, 1s), holds(30.0));
}

TEST_CASE_METHOD(TankFixture, "a dead bus costs a Bad_Timeout, and the tank comes back")
{
    tank.connect_bus(false);
    CHECK_THAT(read(level), has_status(status::Bad_Timeout));
    tank.connect_bus(true);
    CHECK_THAT(read(level), holds(0.0));
}

TEST_CASE_METHOD(TankFixture, "a write whose answer is lost has been done")
{
    world().network().play(fault::cut().before(Message{"WriteResponse"}));
    CHECK(write(set_point, 20.0) == status::Bad_ConnectionClosed);
    CHECK_THAT(read(set_point), holds(20.0)); // over a new connection
    CHECK(world().network().pending_faults() == "");
}

} // namespace tank_source_test
