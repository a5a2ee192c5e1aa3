#include <busbar/crypto/store_validator.hpp>

#include "revoking.hpp"
#include "store_fixture.hpp"

namespace store_validator_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::CertificateChain;
using crypto::StoreList;
using crypto::StoreValidator;

namespace {

constexpr StatusCode good{};

/// A store and its validator, who is shown certificates.
class Gate {
public:
    explicit Gate(const crypto::ValidationSettings& settings = {})
        : validator{stores.store, stores.log, settings}
    {
        context.policy = crypto::find_policy_by_name("Basic256Sha256");
        context.now = now;
    }

    /// Good, or why the chain was refused.
    StatusCode verdict(const CertificateChain& chain)
    {
        const auto result = validator.validate(chain, context);
        return result ? good : result.error().status;
    }

    StoreFixture stores;
    StoreValidator validator;
    crypto::ValidationContext context;
};

} // namespace

TEST_CASE("an unknown certificate is refused, moved to trusted and accepted", "[crypto][store]")
{
    Gate gate;
    const Certificate leaf = issue({}, key_number(1)).certificate;
    CHECK(gate.verdict({leaf}) == status::Bad_CertificateUntrusted);
    REQUIRE(gate.stores.in(StoreList::Rejected) == std::set{leaf.thumbprint_text()});
    CHECK(gate.stores.log.lines.size() == 1);
    CHECK(gate.stores.log.count("was saved in rejected; to trust it, move it to trusted") == 1);
    CHECK(gate.verdict({leaf}) == status::Bad_CertificateUntrusted);
    CHECK(gate.stores.log.lines.size() == 1);

    REQUIRE(
        gate.stores.store.move(leaf.thumbprint_text(), StoreList::Rejected, StoreList::Trusted));
    CHECK(gate.verdict({leaf}) == good);
    REQUIRE(gate.stores.store.remove(StoreList::Trusted, leaf.thumbprint_text()));
    CHECK(gate.verdict({leaf}) == status::Bad_CertificateUntrusted);
    // By hand, under any name.
    fs::rename(gate.stores.path(gate.stores.store.list(StoreList::Rejected)[0].file),
               gate.stores.path("trusted/certs/any name.crt"));
    CHECK(gate.verdict({leaf}) == good);
    CHECK(gate.verdict({}) == status::Bad_CertificateInvalid);
}

TEST_CASE("a CA in the store vouches until it revokes", "[crypto][store]")
{
    Gate gate;
    const Issued root = issue(authority("root"), key_number(2));
    const Issued middle = issue(authority("middle"), key_number(3), &root);
    const Issued leaf = issue({}, key_number(1), &middle);
    CHECK(gate.verdict({leaf.certificate}) == status::Bad_CertificateChainIncomplete);
    CHECK(gate.stores.in(StoreList::Rejected) == std::set{leaf.certificate.thumbprint_text()});
    gate.stores.put("trusted/certs/middle.der", middle.certificate.der());
    gate.stores.put("issuers/certs/root.pem", pem_of(root.certificate));
    CHECK(gate.verdict({leaf.certificate}) == status::Bad_CertificateRevocationUnknown);
    gate.stores.put("issuers/crl/root.crl", pem_of(revoke(root)));
    gate.stores.put("trusted/crl/middle.crl", revoke(middle).der());
    CHECK(gate.verdict({leaf.certificate}) == good);

    fs::remove_all(gate.stores.path("rejected/certs"));
    REQUIRE(gate.stores.store.create());
    gate.stores.put("trusted/crl/middle.crl", revoke(middle, {{leaf.certificate}}).der());
    CHECK(gate.verdict({leaf.certificate}) == status::Bad_CertificateRevoked);
    CHECK(gate.stores.in(StoreList::Rejected) == std::set{leaf.certificate.thumbprint_text()});
}

TEST_CASE("a trusted certificate that is refused for another reason is not rejected",
          "[crypto][store]")
{
    Gate gate;
    const Certificate leaf = issue({}, key_number(1)).certificate;
    gate.stores.put("trusted/certs/leaf.der", leaf.der());
    gate.context.now = in_days(200);
    CHECK(gate.verdict({leaf}) == status::Bad_CertificateTimeInvalid);
    CHECK(gate.stores.count("rejected/certs") == 0);
    CHECK(gate.stores.log.lines.empty()); // the refusal is the caller's to log
}

TEST_CASE("what a setting lets pass is logged and told", "[crypto][store]")
{
    crypto::ValidationSettings settings;
    settings.suppress_validity_period = true;
    Gate gate{settings};
    const Certificate leaf = issue({}, key_number(1)).certificate;
    gate.stores.put("trusted/certs/leaf.der", leaf.der());
    gate.context.now = in_days(200);
    CHECK(gate.verdict({leaf}) == good);
    CHECK(gate.stores.log.count("accepted by a setting") == 1);
    CHECK(gate.stores.log.count("Bad_CertificateTimeInvalid") == 1);
    REQUIRE(gate.validator.suppressed().size() == 1);
    CHECK(gate.validator.suppressed().front().status == status::Bad_CertificateTimeInvalid);
    gate.context.now = now;
    CHECK(gate.verdict({leaf}) == good);
    CHECK(gate.validator.suppressed().empty());
}

TEST_CASE("a store that is gone trusts nobody", "[crypto][store]")
{
    Gate gate;
    const Certificate leaf = issue({}, key_number(1)).certificate;
    gate.stores.put("trusted/certs/leaf.der", leaf.der());
    CHECK(gate.verdict({leaf}) == good);
    fs::remove_all(gate.stores.folder.path);
    CHECK(gate.verdict({leaf}) == status::Bad_CertificateUntrusted);
    CHECK(gate.stores.log.count("cannot be saved in rejected") == 1);
}

TEST_CASE("the insecure validator still wants a key of the policy", "[crypto][store]")
{
    crypto::InsecureAcceptAnyCertificate any;
    const Issued leaf = issue({}, key_number(1));
    const auto* policy = crypto::find_policy_by_name("Basic256Sha256");
    CHECK(any.validate({leaf.certificate}, {policy, now, {}}));
    CHECK_FALSE(any.validate({}, {policy, now, {}}));
    crypto::SecurityPolicy strict = *policy;
    strict.min_key_bits = 3072;
    CHECK_FALSE(any.validate({leaf.certificate}, {&strict, now, {}}));
}

} // namespace store_validator_test
