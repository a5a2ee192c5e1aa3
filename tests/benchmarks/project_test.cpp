#include <catch2/catch.hpp>

#include "model/project.hpp"

namespace project_test {

using namespace busbar::bench;

TEST_CASE("what a project costs for each node grows by 1 where it is linear")
{
    std::vector<ProjectPoint> points(2);
    points[0] = {.nodes = 100, .phase_us = {10, 0, 10}};
    points[1] = {.nodes = 1'000, .phase_us = {100, 5, 1'000}};
    CHECK_FALSE(project_growth(points, 0, 0));
    CHECK(project_growth(points, 1, 0).value() == Approx(1));
    CHECK_FALSE(project_growth(points, 1, 1)); // it cost nothing before
    CHECK(project_growth(points, 1, 2).value() == Approx(10));
}

} // namespace project_test
