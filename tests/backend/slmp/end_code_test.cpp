#include <busbar/backend/slmp_end_code.hpp>

#include <catch2/catch.hpp>

#include <busbar/core/status_codes.hpp>

namespace end_code_test {

using namespace busbar;
using namespace busbar::backend;

TEST_CASE("end codes of SLMP have a text, a status and what they are about")
{
    CHECK(slmp_end_code_text(0xC201) == "C201: the port is locked by a remote password");
    CHECK(slmp_end_code_text(0x0055).find("0055: the PLC is in RUN") == 0);
    CHECK(slmp_end_code_text(0x1234).find("1234: a code that is not known here") == 0);
    CHECK(slmp_end_code(0).status.is_good());
    CHECK(slmp_end_code(0xC051).fault == SlmpFault::Size);
    CHECK(slmp_end_code(0x4031).fault == SlmpFault::Address);
    CHECK(slmp_end_code(0x4031).status == StatusCode{status::Bad_ConfigurationError});
    CHECK(slmp_end_code(0xC810).status == StatusCode{status::Bad_UserAccessDenied});
    CHECK(slmp_end_code(0xFFFF).status == StatusCode{status::Bad_DeviceFailure});
    CHECK(slmp_end_code(0xFFFF).fault == SlmpFault::Request);
    for (std::uint32_t code = 0; code <= 0xFFFF; ++code) {
        const auto row = slmp_end_code(static_cast<std::uint16_t>(code));
        CHECK(row.code == code);
        CHECK(row.status.is_bad() == (code != 0));
    }
}

} // namespace end_code_test
