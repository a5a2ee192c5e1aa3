#include <catch2/catch.hpp>

#include "bench/startup.hpp"

namespace startup_test {

using namespace busbar::bench;

TEST_CASE("what costs each variable the same grows by 1 from one size to the next")
{
    std::vector<StartupPoint> points(3);
    points[0] = {.count = 100, .phase_ms = {2}, .running_ms = 10, .saving_ms = 0};
    points[1] = {.count = 1'000, .phase_ms = {20}, .running_ms = 50, .saving_ms = 1};
    points[2] = {.count = 5'000, .phase_ms = {500}, .running_ms = 500, .saving_ms = 5};
    CHECK_FALSE(growth(points, 0, &StartupPoint::running_ms));
    CHECK(growth(points, 1, &StartupPoint::running_ms).value() == Approx(0.5));
    CHECK(growth(points, 2, &StartupPoint::running_ms).value() == Approx(2));
    CHECK_FALSE(growth(points, 1, &StartupPoint::saving_ms)); // it cost nothing before
    CHECK(growth(points, 2, &StartupPoint::saving_ms).value() == Approx(1));
    CHECK_FALSE(phase_growth(points, 0, 0));
    CHECK(phase_growth(points, 1, 0).value() == Approx(1));
    CHECK(phase_growth(points, 2, 0).value() == Approx(5));
}

} // namespace startup_test
