#include "judging.hpp"

namespace validation_content_test {

using namespace busbar;
using namespace busbar::test;
using crypto::CertificatePurpose;

/// Part 4, 6.1.3, Table 100: the rows about what a certificate says, in the table's order.

TEST_CASE("Table 100: Validity Period", "[crypto][validation]")
{
    Judge judge;
    const Issued expired = self_signed([](auto& o) { o.valid_to = in_days(-1); });
    const Issued early = self_signed([](auto& o) { o.valid_from = in_days(1); });
    judge.trusts(expired);
    judge.trusts(early);
    CHECK(judge.verdict(expired) == status::Bad_CertificateTimeInvalid);
    CHECK(judge.explains("Validity Period", expired,
                         {"expired 2025-12-31T00:00:00Z, now 2026-01-01T00:00:00Z", "clock"}));
    CHECK(judge.verdict(early) == status::Bad_CertificateTimeInvalid);
    CHECK(judge.explains("Validity Period", early, {"not valid before 2026-01-02T00:00:00Z"}));
    for (const auto& [time, is_good] : {std::pair{in_days(1), true}, std::pair{in_days(100), true},
                                        std::pair{DateTime{in_days(100).ticks + 1}, false}}) {
        judge.context.now = time;
        CHECK((judge.verdict(early) == good) == is_good);
    }
    judge.context.now = now;
    judge.settings.suppress_issuer_validity_period = true;
    CHECK(judge.verdict(expired) == status::Bad_CertificateTimeInvalid);
    judge.settings.suppress_validity_period = true;
    CHECK(judge.verdict(expired) == good);
    REQUIRE(judge.suppressed.size() == 1);
    CHECK(judge.suppressed.front().status == status::Bad_CertificateTimeInvalid);
}

TEST_CASE("Table 100: a Validity Period that ends before it begins", "[crypto][validation]")
{
    Judge judge;
    const Issued reversed = self_signed([](auto& o) {
        o.valid_from = in_days(1);
        o.valid_to = in_days(-1);
    });
    judge.trusts(reversed);
    CHECK(judge.verdict(reversed) == status::Bad_CertificateTimeInvalid);
    CHECK(judge.explains("Validity Period", reversed, {"not valid before 2026-01-02T00:00:00Z"}));
    judge.context.now = in_days(1); // its first moment, which is late
    CHECK(judge.verdict(reversed) == status::Bad_CertificateTimeInvalid);
    CHECK(judge.explains("Validity Period", reversed, {"expired 2025-12-31T00:00:00Z"}));
}

TEST_CASE("Table 100: Validity Period of issuers", "[crypto][validation]")
{
    Judge judge;
    CertificateOptions options = authority("root");
    options.valid_to = in_days(-1);
    const Issued old = issue(options, key_number(2));
    const Issued leaf = leaf_of(&old);
    judge.trusts(old);
    judge.has(revoke(old));
    CHECK(judge.verdict(leaf) == status::Bad_CertificateIssuerTimeInvalid);
    CHECK(judge.explains("Validity Period", old, {"expired 2025-12-31T00:00:00Z"}));
    judge.settings.suppress_validity_period = true;
    CHECK(judge.verdict(leaf) == status::Bad_CertificateIssuerTimeInvalid);
    judge.settings = {};
    judge.settings.suppress_issuer_validity_period = true;
    CHECK(judge.verdict(leaf) == good);
    CHECK(judge.suppressed.size() == 1);
    // Renewed with the same key: the one that is valid is taken.
    judge.settings = {};
    options.valid_to = in_days(100);
    judge.trusts(issue(options, key_number(2)));
    CHECK(judge.verdict(leaf) == good);
}

TEST_CASE("Table 100: Host Name", "[crypto][validation]")
{
    Judge judge;
    const Issued leaf = self_signed();
    judge.trusts(leaf);
    for (const char* host : {"", "plc.example", "PLC.EXAMPLE", "192.0.2.7"}) {
        judge.context.host_name = host;
        CHECK(judge.verdict(leaf) == good);
    }
    for (const char* host : {"plc", "x.plc.example", "192.0.2.8", "example", "leaf"}) {
        INFO(host);
        judge.context.host_name = host;
        CHECK(judge.verdict(leaf) == status::Bad_CertificateHostNameInvalid);
    }
    CHECK(judge.explains("Host Name", leaf,
                         {"connected to leaf, but its host names are: "
                          "plc.example, 192.0.2.7",
                          "Connect by one of its names"}));
    const Issued nameless = self_signed([](auto& o) { o.names = "URI:urn:x"; });
    const Issued wild = self_signed([](auto& o) { o.names = "DNS:*.example"; });
    judge.trusts(nameless);
    judge.trusts(wild);
    judge.context.host_name = "leaf"; // as its CommonName has it
    CHECK(judge.verdict(nameless) == status::Bad_CertificateHostNameInvalid);
    judge.context.host_name = "plc.example";
    CHECK(judge.verdict(wild) == status::Bad_CertificateHostNameInvalid);
    CHECK(judge.explains("Host Name", wild, {"plc.example", "*.example"}));

    judge.settings.suppress_host_name = true;
    CHECK(judge.verdict(wild) == good);
    CHECK(judge.suppressed.size() == 1);
    judge.settings = {};
    judge.context.purpose = CertificatePurpose::User;
    CHECK(judge.verdict(wild) == good);
}

TEST_CASE("Table 100: URI", "[crypto][validation]")
{
    Judge judge;
    judge.context.application_uri = "urn:plc";
    const auto show = [&](const char* names) {
        CertificateOptions options;
        options.names = names;
        Issued leaf = issue(options, key_number(1));
        judge.trusts(leaf);
        static_cast<void>(judge.verdict(leaf));
        return leaf;
    };
    static_cast<void>(show("URI:urn:plc"));
    CHECK_FALSE(judge.refusal);
    // One of several, as companies put URIs of their own into certificates.
    for (const char* names : {"URI:urn:plc,URI:urn:other", "URI:urn:other,URI:urn:plc"}) {
        INFO(names);
        static_cast<void>(show(names));
        CHECK_FALSE(judge.refusal);
    }
    // tests/attacks.txt, C10.
    for (const char* names : {"URI:urn:plc:x", "URI:urn:pl", "URI:urn:evil:urn:plc", "URI:URN:PLC",
                              "URI:urn:plc:x,URI:urn:other", "DNS:urn:plc", ""}) {
        INFO(names);
        static_cast<void>(show(names));
        REQUIRE(judge.refusal);
        CHECK(judge.refusal->status == status::Bad_CertificateUriInvalid);
    }
    const Issued other = show("URI:urn:evil:urn:plc");
    CHECK(judge.explains("URI", other,
                         {"its ApplicationUri is urn:evil:urn:plc, the ApplicationDescription's "
                          "is urn:plc",
                          "Set the peer's ApplicationUri"}));
    const Issued two = show("URI:urn:one,URI:urn:other");
    CHECK(judge.explains("URI", two, {"its ApplicationUri is urn:one, urn:other"}));
    const Issued none = show("DNS:plc");
    CHECK(judge.explains("URI", none, {"it names no ApplicationUri"}));
    judge.context.purpose = CertificatePurpose::User;
    CHECK(judge.verdict(other) == good);
}

TEST_CASE("Table 100: Certificate Usage", "[crypto][validation]")
{
    Judge judge;
    const auto show = [&](const std::string& usage, const std::string& extended) {
        CertificateOptions options;
        options.key_usage = usage;
        options.extended_key_usage = extended;
        Issued leaf = issue(options, key_number(1));
        judge.trusts(leaf);
        static_cast<void>(judge.verdict(leaf));
        return leaf;
    };
    const auto verdict_on = [&](const char* usage, const char* extended) {
        return judge.verdict(show(usage, extended));
    };
    constexpr const char* both = "digitalSignature,dataEncipherment";
    CHECK(verdict_on(both, "clientAuth") == good);
    CHECK(verdict_on(both, "serverAuth") == good);
    CHECK(verdict_on("", "") == good);
    for (const char* usage : {"digitalSignature", "dataEncipherment", "keyCertSign"}) {
        CHECK(verdict_on(usage, "clientAuth") == status::Bad_CertificateUseNotAllowed);
    }
    const Issued lacking = show("digitalSignature", "clientAuth");
    CHECK(judge.explains("Certificate Usage", lacking,
                         {"lacks digitalSignature or dataEncipherment", "this key usage"}));
    CHECK(verdict_on(both, "codeSigning") == status::Bad_CertificateUseNotAllowed);

    judge.context.purpose = CertificatePurpose::ServerApplication;
    CHECK(verdict_on(both, "serverAuth") == good);
    CHECK(verdict_on(both, "clientAuth") == status::Bad_CertificateUseNotAllowed);
    judge.context.purpose = CertificatePurpose::ClientApplication;
    CHECK(verdict_on(both, "clientAuth") == good);
    const Issued server = show(both, "serverAuth");
    CHECK(judge.explains("Certificate Usage", server, {"extended key usage lacks clientAuth"}));

    judge.settings.suppress_certificate_usage = true;
    CHECK(judge.verdict(server) == good);
    CHECK(judge.suppressed.size() == 1);
    // What a certificate marks as mandatory no setting suppresses.
    CHECK(verdict_on(both, "critical,serverAuth") == status::Bad_CertificateUseNotAllowed);
    CHECK(verdict_on("critical,digitalSignature", "") == status::Bad_CertificateUseNotAllowed);
}

TEST_CASE("Table 100: Certificate Usage of users", "[crypto][validation]")
{
    Judge judge;
    judge.context.purpose = CertificatePurpose::User;
    const Issued user = self_signed([](auto& o) {
        o.names = "";
        o.key_usage = "critical,digitalSignature";
        o.extended_key_usage = "emailProtection";
    });
    const Issued reader = self_signed([](auto& o) { o.key_usage = "critical,dataEncipherment"; });
    const Issued ca = issue(authority("root"), key_number(2));
    const Issued signing_ca = self_signed([](auto& o) {
        o.basic_constraints = "critical,CA:TRUE";
        o.key_usage = "critical,digitalSignature,keyCertSign";
    });
    for (const Issued* one : {&user, &reader, &ca, &signing_ca}) {
        judge.trusts(*one);
    }
    CHECK(judge.verdict(user) == good);
    for (const Issued* one : {&reader, &ca, &signing_ca}) {
        CHECK(judge.verdict(*one) == status::Bad_CertificateUseNotAllowed);
    }
    CHECK(judge.explains("Certificate Usage", signing_ca, {"a CA's, not a user's"}));
}

TEST_CASE("Table 100: Certificate Usage of issuers", "[crypto][validation]")
{
    Judge judge;
    const auto verdict_below = [&](const CertificateOptions& options) {
        const Issued ca = issue(options, key_number(5));
        judge.list = {};
        judge.trusts(ca);
        judge.has(revoke(ca));
        const StatusCode verdict = judge.verdict(leaf_of(&ca));
        if (judge.refusal) {
            CHECK(judge.explains("Certificate Usage", ca, {"certificate of another CA"}));
        }
        return verdict;
    };
    CertificateOptions options = authority("issuer");
    CHECK(verdict_below(options) == good);
    options.key_usage = "";
    CHECK(verdict_below(options) == good);
    options.basic_constraints = "critical,CA:FALSE";
    CHECK(verdict_below(options) == status::Bad_CertificateIssuerUseNotAllowed);
    options.basic_constraints = "";
    CHECK(verdict_below(options) == status::Bad_CertificateIssuerUseNotAllowed);
    options = authority("issuer");
    options.key_usage = "critical,cRLSign";
    CHECK(verdict_below(options) == status::Bad_CertificateIssuerUseNotAllowed);
    options = authority("issuer");
    options.name_constraints = "critical,permitted;DNS:example";
    CHECK(verdict_below(options) == good);
    options.name_constraints = "critical,permitted;DNS:other.example";
    CHECK(verdict_below(options) == status::Bad_CertificateIssuerUseNotAllowed);
    REQUIRE(judge.refusal);
    CHECK(judge.refusal->found.find("nameConstraints") != std::string::npos);

    // No setting makes an application a CA, whatever it marks as mandatory.
    judge.settings.suppress_certificate_usage = true;
    options = {};
    options.common_name = "issuer";
    CHECK(verdict_below(options) == status::Bad_CertificateIssuerUseNotAllowed);

    options = authority("short");
    options.basic_constraints = "critical,CA:TRUE,pathlen:0";
    const Issued root = issue(options, key_number(2));
    const Issued middle = issue(authority("middle"), key_number(3), &root);
    judge.trusts(root);
    judge.has(revoke(root));
    judge.has(revoke(middle));
    CHECK(judge.verdict(leaf_of(&root)) == good);
    CHECK(judge.verdict({leaf_of(&middle).certificate, middle.certificate}) ==
          status::Bad_CertificateIssuerUseNotAllowed);
    CHECK(judge.explains("Certificate Usage", root, {"pathLenConstraint"}));
}

} // namespace validation_content_test
