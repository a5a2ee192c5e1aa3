#include <catch2/catch.hpp>

#include "bench/churn.hpp"

namespace churn_test {

using namespace busbar::bench;

TEST_CASE("a controller that lets nobody in has not borne anything")
{
    ChurnReport report;
    report.serves = true;
    report.needed = {"administrator comes", "come"};
    report.rows = {{"administrator comes", 3, 1}, {"come", 0, 40}, {"guess", 7, 0}};
    CHECK(report.never_done() == "come");
    CHECK_FALSE(report.is_well());
    report.rows[1].good = 1;
    CHECK(report.never_done().empty());
    CHECK(report.is_well());
    report.rows.erase(report.rows.begin()); // none has even tried
    CHECK(report.never_done() == "administrator comes");
    CHECK_FALSE(report.is_well());
    report.needed.clear();
    report.exit_code = 1;
    CHECK_FALSE(report.is_well());
}

} // namespace churn_test
