#include <catch2/catch.hpp>

#include <cmath>
#include <string>

#include "core/number_text.hpp"

namespace number_text_test {

using busbar::detail::read_floating;

TEMPLATE_TEST_CASE("the C library reads numbers as std::from_chars does", "[core]", double, float)
{
    const std::string text =
        GENERATE("0", "-0", "1", "1.5", "-1.5e3", "1.", ".5", "1e", "1e+", "1e+2x", "1E-2", "007",
                 "", "-", ".", "+1", " 1", "e5", "0x10", "1,5", "1.5.5", "inf", "-INF", "Infinity",
                 "nan", "infi", "1e999", "-1e999", "1e-999", "0e-999", "3.14159265358979",
                 "4.9e-324", "1e-40", "1.7976931348623157e308", "123456789012345678901234567890");
    CAPTURE(text);
    const char* const first = text.data();
    const char* const last = first + text.size();
    TestType wanted{42};
    TestType found{42};
    const auto expected = std::from_chars(first, last, wanted);
    const auto result = read_floating(first, last, found);
    CHECK(result.ptr - first == expected.ptr - first);
    CHECK(result.ec == expected.ec);
    CHECK(((std::isnan(found) && std::isnan(wanted)) || found == wanted));
    CHECK(std::signbit(found) == std::signbit(wanted));
}

} // namespace number_text_test
