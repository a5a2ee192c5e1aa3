#include "hex.hpp"
#include "judging.hpp"

namespace validation_table_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::CertificateChain;

/// Part 4, 6.1.3, Table 100: one case for each row up to the trust list; the other rows
/// are in validation_content_test.cpp and revocation_test.cpp.

TEST_CASE("Table 100: Certificate Structure", "[crypto][validation]")
{
    Judge judge;
    CHECK(judge.verdict(CertificateChain{}) == status::Bad_CertificateInvalid);
    const Issued odd = self_signed([](auto& o) { o.extra = "\x05"; });
    judge.trusts(odd);
    CHECK(judge.verdict(odd) == status::Bad_CertificateInvalid);
    CHECK(judge.explains("Certificate Structure", odd,
                         {"unknown critical extension", "needs another certificate"}));

    const Issued old = self_signed([](auto& o) {
        o.version = 1;
        o.key_identifiers = false;
        o.names = o.basic_constraints = o.key_usage = o.extended_key_usage = "";
    });
    judge.trusts(old);
    CHECK(judge.verdict(old) == status::Bad_CertificateInvalid);
    CHECK(judge.explains("Certificate Structure", old, {"not an X.509 version 3 certificate"}));

    // Of an issuer, once it is known which one it is.
    CertificateOptions options = authority("odd root");
    options.extra = "\x05";
    const Issued root = issue(options, key_number(2));
    judge.trusts(root);
    CHECK(judge.verdict(leaf_of(&root)) == status::Bad_CertificateInvalid);
    CHECK(judge.explains("Certificate Structure", root, {"critical extension"}));
}

TEST_CASE("Table 100: Build Certificate Chain", "[crypto][validation]")
{
    Judge judge;
    const Family family;
    CHECK(judge.verdict(family.leaf) == status::Bad_CertificateChainIncomplete);
    CHECK(judge.explains("Build Certificate Chain", family.leaf,
                         {"its issuer, CN=middle, is neither in the trust list", "into issuers"}));
    // A trusted leaf needs its chain too, up to the root.
    judge.trusts(family.leaf);
    CHECK(judge.verdict(family.leaf) == status::Bad_CertificateChainIncomplete);
    CHECK(judge.verdict({family.leaf.certificate, family.middle.certificate}) ==
          status::Bad_CertificateChainIncomplete);
    CHECK(judge.explains("Build Certificate Chain", family.middle, {"its issuer, CN=root"}));

    judge.has(revoke(family.root));
    judge.has(revoke(family.middle));
    // In any order; what is missing comes from the trust list.
    CHECK(judge.verdict({family.leaf.certificate, family.root.certificate,
                         family.middle.certificate}) == good);
    judge.knows_issuer(family.root);
    CHECK(judge.verdict({family.leaf.certificate, family.middle.certificate}) == good);
    judge.knows_issuer(family.middle);
    CHECK(judge.verdict(family.leaf) == good);
}

TEST_CASE("Table 100: Signature", "[crypto][validation]"
                                  "[unit:CertificateSignatureAlgorithm_RSA-PKCS15-SHA2-256]")
{
    Judge judge;
    const Family family;
    family.introduce_to(judge);
    const Issued alone = self_signed();
    judge.trusts(alone);
    const auto with_wrong_bit = [](const Issued& issued) {
        auto der = copy_of(issued.certificate.der());
        der[der.size() - 10] ^= std::byte{1};
        return Issued{*Certificate::parse(der), issued.key};
    };
    const Issued forged = with_wrong_bit(family.leaf);
    CHECK(judge.verdict(forged) == status::Bad_CertificateInvalid);
    CHECK(judge.explains("Signature", forged,
                         {"not signed with the key of its issuer, CN=middle",
                          family.middle.certificate.thumbprint_text()}));
    const Issued self_forged = with_wrong_bit(alone);
    CHECK(judge.verdict(self_forged) == status::Bad_CertificateInvalid);
    CHECK(judge.explains("Signature", self_forged, {"not signed with its own key"}));
    // The wrong bit is found in an issuer as well, and an untouched copy of it is preferred.
    const Issued forged_middle = with_wrong_bit(family.middle);
    CHECK(judge.verdict({family.leaf.certificate, forged_middle.certificate}) == good);
    judge.list.issuers = {forged_middle.certificate};
    CHECK(judge.verdict({family.leaf.certificate, family.middle.certificate}) == good);
    CHECK(judge.verdict(family.leaf) == status::Bad_CertificateInvalid);
    CHECK(judge.explains("Signature", forged_middle, {"key of its issuer, CN=root"}));
}

TEST_CASE("Table 100: Security Policy Check",
          "[crypto][validation]"
          "[unit:CertificateSignatureAlgorithm_RSA-PKCS15-SHA2-256]"
          "[unit:CertificateKeyAlgorithm_RSA]")
{
    Judge judge;
    const Issued sha1 = self_signed([](auto& o) { o.digest = "SHA1"; });
    const Issued sha512 = self_signed([](auto& o) { o.digest = "SHA512"; });
    judge.trusts(sha1);
    judge.trusts(sha512);
    CHECK(judge.verdict(sha1) == status::Bad_CertificatePolicyCheckFailed);
    CHECK(
        judge.explains("Security Policy Check", sha1,
                       {"signed with sha1WithRSAEncryption", "Basic256Sha256", "RSA and SHA-256"}));
    CHECK(judge.verdict(sha512) == good);

    crypto::SecurityPolicy policy = *judge.context.policy;
    judge.context.policy = &policy;
    policy.min_key_bits = 3072;
    CHECK(judge.verdict(sha512) == status::Bad_CertificatePolicyCheckFailed);
    CHECK(judge.explains("Security Policy Check", sha512, {"2048 bits", "3072 to 4096"}));
    policy.min_key_bits = 1024;
    policy.max_key_bits = 1024;
    CHECK(judge.verdict(sha512) == status::Bad_CertificatePolicyCheckFailed);
    policy.max_key_bits = 4096;
    policy.allows_sha1_certificates = true;
    CHECK(judge.verdict(sha1) == good);

    judge.settings.suppress_security_policy_check = true;
    policy.allows_sha1_certificates = false;
    CHECK(judge.verdict(sha1) == good);
    REQUIRE(judge.suppressed.size() == 1);
    CHECK(Judge::explains(judge.suppressed.front(), "Security Policy Check", sha1, {"sha1"}));
    judge.settings = {};
    judge.context.policy = &crypto::policy_none();
    CHECK(judge.verdict(sha1) == good);
}

TEST_CASE("Table 100: Security Policy Check of issuers", "[crypto][validation]")
{
    Judge judge;
    CertificateOptions options = authority("root");
    options.digest = "SHA1";
    const Issued root = issue(options, key_number(2));
    options.common_name = "middle";
    const Issued middle = issue(options, key_number(3), &root);
    judge.trusts(root);
    judge.has(revoke(root));
    judge.has(revoke(middle));
    // How a root signed itself is no matter.
    CHECK(judge.verdict(leaf_of(&root)) == good);
    CHECK(judge.verdict({leaf_of(&middle).certificate, middle.certificate}) ==
          status::Bad_CertificatePolicyCheckFailed);
    CHECK(judge.explains("Security Policy Check", middle, {"sha1WithRSAEncryption"}));

    crypto::SecurityPolicy strict = *judge.context.policy;
    strict.min_key_bits = 3072;
    judge.context.policy = &strict;
    CHECK(judge.verdict(issue({}, key_number(1, 3072), &root)) ==
          status::Bad_CertificatePolicyCheckFailed);
    CHECK(judge.explains("Security Policy Check", root, {"2048 bits", "3072 to 4096"}));
}

TEST_CASE("Table 100: Trust List Check",
          "[crypto][validation][unit:Security Certificate Validation]")
{
    Judge judge;
    const Family family;
    const Issued alone = self_signed();
    CHECK(judge.verdict(alone) == status::Bad_CertificateUntrusted);
    CHECK(
        judge.explains("Trust List Check", alone,
                       {"not among the trusted certificates", "move it from rejected to trusted"}));
    judge.knows_issuer(family.root);
    judge.knows_issuer(family.middle);
    judge.has(revoke(family.root));
    judge.has(revoke(family.middle));
    CHECK(judge.verdict(family.leaf) == status::Bad_CertificateUntrusted);
    CHECK(judge.explains("Trust List Check", family.leaf,
                         {"neither it nor a CA above it, up to CN=root",
                          family.root.certificate.thumbprint_text(), "put the CA's certificate"}));
    SECTION("the leaf is trusted")
    {
        judge.trusts(family.leaf);
        CHECK(judge.verdict(family.leaf) == good);
    }
    SECTION("its issuer is trusted, but not who is beside that")
    {
        judge.trusts(family.middle);
        CHECK(judge.verdict(family.leaf) == good);
        CHECK(judge.verdict(leaf_of(&family.root)) == status::Bad_CertificateUntrusted);
    }
    SECTION("the root is trusted")
    {
        judge.trusts(family.root);
        CHECK(judge.verdict(family.leaf) == good);
    }
    SECTION("of two paths the trusted one is taken")
    {
        const Issued other_root = issue(authority("other root"), key_number(4));
        const Issued cross = issue(authority("middle"), key_number(3), &other_root);
        judge.knows_issuer(cross);
        judge.has(revoke(other_root));
        CHECK(judge.verdict(family.leaf) == status::Bad_CertificateUntrusted);
        judge.trusts(other_root);
        CHECK(judge.verdict(family.leaf) == good);
    }
}

} // namespace validation_table_test
