#include "judging.hpp"

namespace revocation_test {

using namespace busbar;
using namespace busbar::test;

/// Part 4, 6.1.3, Table 100: the rows about revocation, the last two.

TEST_CASE("Table 100: Find Revocation List", "[crypto][validation]")
{
    Judge judge;
    const Family family;
    family.introduce_to(judge);
    CHECK(judge.verdict(family.leaf) == good);
    judge.list.issuer_crls = {revoke(family.root)};
    CHECK(judge.verdict(family.leaf) == status::Bad_CertificateRevocationUnknown);
    CHECK(judge.explains("Find Revocation List", family.leaf,
                         {"no revocation list of its issuer, CN=middle",
                          family.middle.certificate.thumbprint_text(), "crl folder"}));
    judge.settings.suppress_find_issuer_revocation_list = true;
    CHECK(judge.verdict(family.leaf) == status::Bad_CertificateRevocationUnknown);
    judge.settings = {};
    judge.settings.suppress_find_revocation_list = true;
    CHECK(judge.verdict(family.leaf) == good);
    CHECK(judge.suppressed.size() == 1);

    judge.list.issuer_crls = {revoke(family.middle)};
    CHECK(judge.verdict(family.leaf) == status::Bad_CertificateIssuerRevocationUnknown);
    CHECK(judge.explains("Find Revocation List", family.middle, {"of its issuer, CN=root"}));
    judge.settings = {};
    judge.settings.suppress_find_issuer_revocation_list = true;
    CHECK(judge.verdict(family.leaf) == good);
    // A list counts among the trusted ones as well; a root needs none above it.
    judge.settings = {};
    judge.list.issuer_crls.clear();
    judge.list.trusted_crls = {revoke(family.middle), revoke(family.root)};
    CHECK(judge.verdict(family.leaf) == good);
    const Issued alone = self_signed();
    judge.trusts(alone);
    judge.list.trusted_crls.clear();
    CHECK(judge.verdict(alone) == good);
}

TEST_CASE("Table 100: Find Revocation List that may be believed", "[crypto][validation]")
{
    Judge judge;
    const Issued root = issue(authority("root"), key_number(2));
    const Issued impostor = issue(authority("root"), key_number(4));
    const Issued leaf = leaf_of(&root);
    judge.trusts(root);
    const auto verdict_with = [&](const Issued& issuer, const RevocationOptions& options) {
        judge.list.issuer_crls = {revoke(issuer, options)};
        return judge.verdict(leaf);
    };
    CHECK(verdict_with(root, {}) == good);
    CHECK(verdict_with(impostor, {}) == status::Bad_CertificateRevocationUnknown);
    CHECK(judge.explains("Find Revocation List", leaf,
                         {"in the name of its issuer, CN=root", "signed with its key"}));

    RevocationOptions options;
    options.next_update = in_days(-1);
    options.this_update = in_days(-9);
    CHECK(verdict_with(root, options) == status::Bad_CertificateRevocationUnknown);
    CHECK(judge.explains("Find Revocation List", leaf,
                         {"renewed by 2025-12-31T00:00:00Z, now 2026-01-01T00:00:00Z", "CN=root"}));
    options.next_update = {};
    CHECK(verdict_with(root, options) == status::Bad_CertificateRevocationUnknown);
    options = {};
    options.this_update = in_days(1);
    CHECK(verdict_with(root, options) == status::Bad_CertificateRevocationUnknown);
    options = {};
    options.is_delta = true;
    CHECK(verdict_with(root, options) == status::Bad_CertificateRevocationUnknown);
    options = {};
    options.distribution_point = "critical,onlyuser:TRUE";
    CHECK(verdict_with(root, options) == status::Bad_CertificateRevocationUnknown);
    options.distribution_point = "critical,indirectCRL:TRUE";
    CHECK(verdict_with(root, options) == status::Bad_CertificateRevocationUnknown);
    options = {};
    options.extra = "\x05";
    CHECK(verdict_with(root, options) == status::Bad_CertificateRevocationUnknown);
    options = {};
    options.entry_extra = "\x05";
    options.revoked = {impostor.certificate};
    CHECK(verdict_with(root, options) == status::Bad_CertificateRevocationUnknown);

    CertificateOptions no_list = authority("other root");
    no_list.key_usage = "critical,keyCertSign";
    const Issued other = issue(no_list, key_number(5));
    judge.trusts(other);
    judge.list.issuer_crls = {revoke(other)};
    CHECK(judge.verdict(leaf_of(&other)) == status::Bad_CertificateRevocationUnknown);
}

TEST_CASE("Table 100: Revocation Check", "[crypto][validation]")
{
    Judge judge;
    const Family family;
    family.introduce_to(judge);
    const Issued other = leaf_of(&family.middle);
    RevocationOptions options;
    options.revoked = {family.leaf.certificate};
    judge.list.issuer_crls = {revoke(family.root), revoke(family.middle, options)};
    CHECK(judge.verdict(family.leaf) == status::Bad_CertificateRevoked);
    CHECK(judge.explains("Revocation Check", family.leaf,
                         {"revoked 2025-12-30T00:00:00Z by CN=middle", "new key"}));
    CHECK(judge.verdict(other) == good);

    options.revoked = {family.middle.certificate};
    judge.list.issuer_crls = {revoke(family.root, options), revoke(family.middle)};
    CHECK(judge.verdict(other) == status::Bad_CertificateIssuerRevoked);
    CHECK(judge.explains("Revocation Check", family.middle, {"by CN=root"}));

    // The same serial number in the list of another CA means nothing.
    options.revoked = {other.certificate};
    judge.list.issuer_crls = {revoke(family.root, options), revoke(family.middle)};
    CHECK(judge.verdict(other) == good);
}

TEST_CASE("Table 100: Revocation Check by the newest list", "[crypto][validation]")
{
    Judge judge;
    const Issued root = issue(authority("root"), key_number(2));
    const Issued impostor = issue(authority("root"), key_number(4));
    const Issued leaf = leaf_of(&root);
    judge.trusts(root);
    RevocationOptions revoking;
    revoking.revoked = {leaf.certificate};
    RevocationOptions older;
    older.this_update = in_days(-10);
    judge.list.trusted_crls = {revoke(root, older)};
    judge.list.issuer_crls = {revoke(root, revoking)};
    CHECK(judge.verdict(leaf) == status::Bad_CertificateRevoked);
    // No longer on hold: the newest list says so.
    older.revoked = {leaf.certificate};
    judge.list.trusted_crls = {revoke(root, older)};
    judge.list.issuer_crls = {revoke(root)};
    CHECK(judge.verdict(leaf) == good);
    // A stranger's list of the same name neither revokes nor hides.
    RevocationOptions newer;
    newer.this_update = now;
    judge.list.trusted_crls = {revoke(impostor, newer)};
    judge.list.issuer_crls = {revoke(root, revoking)};
    CHECK(judge.verdict(leaf) == status::Bad_CertificateRevoked);
    revoking.this_update = now;
    judge.list.trusted_crls = {revoke(impostor, revoking)};
    judge.list.issuer_crls = {revoke(root)};
    CHECK(judge.verdict(leaf) == good);
    // A delta list is not passed over: its issuer meant it to count.
    RevocationOptions delta;
    delta.is_delta = true;
    delta.this_update = now;
    judge.list.trusted_crls = {revoke(root, delta)};
    CHECK(judge.verdict(leaf) == status::Bad_CertificateRevocationUnknown);
    CHECK(judge.explains("Find Revocation List", leaf, {"a delta or partial list", "CN=root"}));
    judge.settings.suppress_find_revocation_list = true;
    CHECK(judge.verdict(leaf) == good);
    judge.list.issuer_crls = {revoke(root, older)};
    CHECK(judge.verdict(leaf) == status::Bad_CertificateRevoked);
    delta.revoked = {leaf.certificate};
    judge.list.trusted_crls = {revoke(root, delta)};
    judge.list.issuer_crls = {revoke(root)};
    CHECK(judge.verdict(leaf) == status::Bad_CertificateRevoked);
    judge.settings = {};
    // Whoever lets expired lists pass does not let revoked certificates pass.
    revoking.this_update = in_days(-10);
    revoking.next_update = in_days(-1);
    judge.list = {};
    judge.trusts(root);
    judge.has(revoke(root, revoking));
    CHECK(judge.verdict(leaf) == status::Bad_CertificateRevocationUnknown);
    judge.settings.suppress_find_revocation_list = true;
    CHECK(judge.verdict(leaf) == status::Bad_CertificateRevoked);
}

} // namespace revocation_test
