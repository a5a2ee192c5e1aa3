#include <catch2/catch.hpp>

#include "bench/series.hpp"

namespace series_test {

using namespace busbar::bench;

TEST_CASE("a step is where a cost grows by more than half from one size to the next")
{
    const std::vector<Series> all = {
        {"sessions", {{1, 100, 2}, {10, 150, 3}, {100, 300, 3}, {1'000, 100, 30}}},
        {"items", {{10, 0, 0}, {20, 9, 9}}}, // what cost nothing does not grow
    };
    const auto steps = find_steps(all);
    REQUIRE(steps.size() == 2);
    CHECK(steps[0].of == "sessions");
    CHECK(steps[0].cost == "create");
    CHECK(steps[0].from == 10);
    CHECK(steps[0].to == 100);
    CHECK(steps[0].growth == Approx(2));
    CHECK(steps[1].cost == "read");
    CHECK(steps[1].from == 100);
    CHECK(steps[1].to == 1'000);
    CHECK(steps[1].growth == Approx(10));
}

TEST_CASE("figures without a step have none")
{
    CHECK(find_steps({}).empty());
    CHECK(find_steps({{"variables", {{1'000, 1, 2}}}}).empty());
    CHECK(find_steps({{"variables", {{1'000, 1, 2}, {10'000, 1.5, 1}}}}).empty());
}

} // namespace series_test
