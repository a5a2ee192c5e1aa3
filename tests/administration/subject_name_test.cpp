#include <catch2/catch.hpp>

#include "administration/own_certificate_methods.hpp"

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

TEST_CASE("subject name: a refusal names the field and what is expected of it")
{
    const auto found = [](std::string_view text) { return with_names({}, text).error().found; };
    CHECK(found("CN=X/O=Bad#Org/C=DEU") ==
          "C is \"DEU\", expected two letters, such as JP in CN=X/O=Bad#Org/C=DEU");
    CHECK(found("CN=X/C=1A") == "C is \"1A\", expected two letters, such as JP in CN=X/C=1A");
    CHECK(found("O=Works") == "found no CN in O=Works");
    CHECK(found("CN=X/XX=a").starts_with("found \"XX\", expected one of CN, O, OU"));
    CHECK(found("CN=").starts_with("CN has no value"));
    CHECK(found("CN=" + std::string(65, 'x')).find("expected at most 64 characters") !=
          std::string::npos);
    CHECK(with_names({}, "CN=" + std::string(64, 'x')));
    const auto umlauts = [](int count) {
        std::string text = "CN=";
        for (int i = 0; i < count; ++i) {
            text += "\u00fc";
        }
        return text;
    };
    CHECK(with_names({}, umlauts(64)));
    CHECK_FALSE(with_names({}, umlauts(65)));
}

} // namespace subject_name_test
