#include <array>

#include "judging.hpp"

namespace validation_order_test {

using namespace busbar;
using namespace busbar::test;
using crypto::CertificateChain;
using crypto::ValidationSettings;

/// Part 4, 6.1.3, Table 100 as a whole: the order of its rows, and which may be suppressed.

TEST_CASE("Table 100: the order of the steps",
          "[crypto][validation][unit:Security Certificate Validation]")
{
    // All is wrong with the leaf; what is put right uncovers the next step.
    Judge judge;
    judge.context.application_uri = "urn:plc";
    judge.context.host_name = "other.example";
    const Issued root = issue(authority("root"), key_number(2));
    const Issued impostor = issue(authority("root"), key_number(4));
    CertificateOptions options;
    options.digest = "SHA1";
    options.valid_to = in_days(-1);
    options.key_usage = "digitalSignature";
    options.extra = "\x05";
    options.key_identifiers = false;
    const auto verdict = [&] { return judge.verdict(issue(options, key_number(1), &root)); };
    CHECK(verdict() == status::Bad_CertificateInvalid);
    CHECK(judge.refusal->check == "Certificate Structure");
    options.extra = "";
    CHECK(verdict() == status::Bad_CertificateChainIncomplete);
    judge.knows_issuer(impostor);
    CHECK(verdict() == status::Bad_CertificateInvalid);
    CHECK(judge.refusal->check == "Signature");
    judge.knows_issuer(root);
    CHECK(verdict() == status::Bad_CertificatePolicyCheckFailed);
    options.digest = "SHA256";
    CHECK(verdict() == status::Bad_CertificateUntrusted);
    judge.trusts(root);
    CHECK(verdict() == status::Bad_CertificateTimeInvalid);
    options.valid_to = in_days(1);
    CHECK(verdict() == status::Bad_CertificateHostNameInvalid);
    judge.context.host_name = "plc.example";
    CHECK(verdict() == status::Bad_CertificateUriInvalid);
    judge.context.application_uri = "urn:test:leaf";
    CHECK(verdict() == status::Bad_CertificateUseNotAllowed);
    options.key_usage = "digitalSignature,dataEncipherment";
    CHECK(verdict() == status::Bad_CertificateRevocationUnknown);
    const Issued leaf = issue(options, key_number(1), &root);
    RevocationOptions revoking;
    revoking.revoked = {leaf.certificate};
    judge.has(revoke(root, revoking));
    CHECK(judge.verdict(leaf) == status::Bad_CertificateRevoked);
    CHECK(verdict() == good);
}

TEST_CASE("Table 100: a step is suppressed by its own setting alone", "[crypto][validation]")
{
    using Setting = bool ValidationSettings::*;
    struct Case {
        StatusCode status;
        Setting setting; // null: none suppresses it
    };
    constexpr std::array all = {&ValidationSettings::suppress_security_policy_check,
                                &ValidationSettings::suppress_validity_period,
                                &ValidationSettings::suppress_issuer_validity_period,
                                &ValidationSettings::suppress_host_name,
                                &ValidationSettings::suppress_certificate_usage,
                                &ValidationSettings::suppress_find_revocation_list,
                                &ValidationSettings::suppress_find_issuer_revocation_list};
    const auto check = [&](Judge& judge, const CertificateChain& chain, const Case& one) {
        INFO(name(one.status));
        judge.settings = {};
        CHECK(judge.verdict(chain) == one.status);
        for (const Setting setting : all) {
            judge.settings.*setting = setting != one.setting;
        }
        CHECK(judge.verdict(chain) == one.status);
        for (const Setting setting : all) {
            judge.settings.*setting = setting == one.setting;
        }
        CHECK(judge.verdict(chain) == (one.setting != nullptr ? good : one.status));
        CHECK(judge.suppressed.size() == (one.setting != nullptr ? 1 : 0));
    };
    const auto check_leaf = [&](void (*change)(CertificateOptions&), const Case& one) {
        Judge judge;
        judge.context.application_uri = "urn:test:leaf";
        judge.context.host_name = "plc.example";
        const Issued leaf = self_signed(change);
        judge.trusts(leaf);
        check(judge, {leaf.certificate}, one);
    };
    check_leaf([](auto& o) { o.digest = "SHA1"; },
               {status::Bad_CertificatePolicyCheckFailed, all[0]});
    check_leaf([](auto& o) { o.valid_to = in_days(-1); },
               {status::Bad_CertificateTimeInvalid, all[1]});
    check_leaf([](auto& o) { o.names = "URI:urn:test:leaf"; },
               {status::Bad_CertificateHostNameInvalid, all[3]});
    check_leaf([](auto& o) { o.names = "DNS:plc.example"; },
               {status::Bad_CertificateUriInvalid, nullptr});
    check_leaf([](auto& o) { o.key_usage = "dataEncipherment"; },
               {status::Bad_CertificateUseNotAllowed, all[4]});
    check_leaf([](auto& o) { o.extra = "\x05"; }, {status::Bad_CertificateInvalid, nullptr});

    const Family family;
    Judge judge;
    family.introduce_to(judge);
    const crypto::TrustList complete = judge.list;
    const CertificateChain chain{family.leaf.certificate};
    judge.list.issuer_crls = {revoke(family.root)};
    check(judge, chain, {status::Bad_CertificateRevocationUnknown, all[5]});
    judge.list.issuer_crls = {revoke(family.middle)};
    check(judge, chain, {status::Bad_CertificateIssuerRevocationUnknown, all[6]});
    RevocationOptions revoking;
    revoking.revoked = {family.leaf.certificate, family.middle.certificate};
    judge.list.issuer_crls = {revoke(family.root, revoking), revoke(family.middle)};
    check(judge, chain, {status::Bad_CertificateIssuerRevoked, nullptr});
    judge.list.issuer_crls = {revoke(family.root), revoke(family.middle, revoking)};
    check(judge, chain, {status::Bad_CertificateRevoked, nullptr});
    judge.list = complete;
    judge.list.issuers.clear();
    check(judge, chain, {status::Bad_CertificateChainIncomplete, nullptr});
    judge.list = complete;
    judge.list.trusted.clear();
    judge.knows_issuer(family.root);
    check(judge, chain, {status::Bad_CertificateUntrusted, nullptr});
}

} // namespace validation_order_test
