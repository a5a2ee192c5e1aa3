#include <catch2/catch.hpp>

#include "administration/subject_name.hpp"

namespace subject_name_test {

using namespace busbar;
using administration::detail::with_names;

TEST_CASE("subject name: fields in both forms, with quotes")
{
    crypto::CertificateSubject base;
    base.common_name = "Old";
    base.organization = "Works";
    base.dns_names = {"plc.example"};
    const auto made = with_names(base, "CN=Press 4/OU=\"Hall 2/3\"/C=DE");
    REQUIRE(made);
    CHECK(made->common_name == "Press 4");
    CHECK(made->organization.empty());
    CHECK(made->organizational_unit == "Hall 2/3");
    CHECK(made->country == "DE");
    CHECK(made->dns_names == base.dns_names);
    CHECK(with_names(base, " /CN=a, O=b , DC=c")->domain_component == "c");
    CHECK(with_names(base, "")->common_name == "Old");
}

TEST_CASE("subject name: anything else is refused")
{
    for (const char* text : {"Press 4", "XX=a", "CN=", "CN", "=", "CN=\"a", "CN=\"a\"b", "CN=a/=b",
                             "CN=\xff", "CN=a\n", "CN=\xe2\x80\xaetxt.exe", "CN=\" a\""}) {
        INFO(text);
        const auto made = with_names({}, text);
        REQUIRE_FALSE(made);
        CHECK(made.error().status == status::Bad_InvalidArgument);
    }
}

} // namespace subject_name_test
