#include "judging.hpp"

namespace issuer_combinations_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::CertificateChain;
using crypto::TrustList;

/// Which certificates and revocation lists have to be registered where, for each way to trust a
/// client certificate that a CA has signed: the NJ/NX manual's table A-3-2, one case a row. Clients
/// send their certificate alone or with all of its chain.
namespace {

/// root - upper - a - b: "CA certificate a" is the one that signs "client certificate b".
struct Plant {
    Issued root = issue(authority("root"), key_number(2));
    Issued upper = issue(authority("upper"), key_number(3), &root);
    Issued intermediate = issue(authority("a"), key_number(4), &upper);
    Issued client_of_root = leaf_of(&root);
    Issued client_of_intermediate = leaf_of(&intermediate);
    Issued neighbour_of_root = leaf_of(&root);
    Issued neighbour_of_intermediate = leaf_of(&intermediate);

    /// Client certificate b, another one of the same CA, and the CAs above both.
    struct Line {
        const Issued& client;
        const Issued& neighbour;
        std::vector<const Issued*> authorities; // from CA certificate a to the root

        [[nodiscard]] CertificateChain whole_chain() const
        {
            CertificateChain chain{client.certificate};
            for (const Issued* authority : authorities) {
                chain.push_back(authority->certificate);
            }
            return chain;
        }
    };

    [[nodiscard]] Line below_root() const { return {client_of_root, neighbour_of_root, {&root}}; }
    [[nodiscard]] Line below_intermediate() const
    {
        return {client_of_intermediate, neighbour_of_intermediate, {&intermediate, &upper, &root}};
    }
};

const Plant& plant()
{
    static const Plant made;
    return made;
}

std::vector<Certificate> without(std::vector<Certificate> from, std::size_t index)
{
    from.erase(from.begin() + static_cast<std::ptrdiff_t>(index));
    return from;
}

class Row {
public:
    explicit Row(const Plant::Line& line) : line_{line} {}

    void trusts(const Issued& issued) { registered_.trusted.push_back(issued.certificate); }
    void knows(const Issued& issued) { registered_.issuers.push_back(issued.certificate); }
    void trusts_list_of(const Issued& issuer)
    {
        registered_.trusted_crls.push_back(revoke(issuer));
    }
    void knows_list_of(const Issued& issuer) { registered_.issuer_crls.push_back(revoke(issuer)); }

    /// All that the row promises.
    void check()
    {
        accepts_as_registered();
        needs_every_list();
        needs_every_certificate();
        refuses_what_is_revoked();
    }

    /// Whether another client of the same CA is accepted.
    [[nodiscard]] StatusCode verdict_on_neighbour()
    {
        judge_.list = registered_;
        return judge_.verdict(line_.neighbour);
    }

private:
    void accepts_as_registered()
    {
        judge_.list = registered_;
        CHECK(judge_.verdict(line_.client) == good);
        CHECK(judge_.verdict(line_.whole_chain()) == good);
    }

    void needs_every_list()
    {
        const auto drop_each = [&](auto TrustList::*lists) {
            for (std::size_t i = 0; i < (registered_.*lists).size(); ++i) {
                judge_.list = registered_;
                const auto at = (judge_.list.*lists).begin() + static_cast<std::ptrdiff_t>(i);
                const std::string issuer = at->issuer();
                INFO("without the list of " << issuer);
                const bool is_of_client =
                    issuer == line_.authorities.front()->certificate.subject();
                (judge_.list.*lists).erase(at);
                CHECK(judge_.verdict(line_.whole_chain()) ==
                      (is_of_client ? status::Bad_CertificateRevocationUnknown
                                    : status::Bad_CertificateIssuerRevocationUnknown));
                CHECK(text(*judge_.refusal).find(issuer) != std::string::npos);
            }
        };
        drop_each(&TrustList::trusted_crls);
        drop_each(&TrustList::issuer_crls);
    }

    /// Without a CA's certificate the chain is incomplete, unless the client sends it; without what
    /// is trusted nothing is, whatever the client sends.
    void needs_every_certificate()
    {
        for (std::size_t i = 0; i < registered_.issuers.size(); ++i) {
            judge_.list = registered_;
            judge_.list.issuers = without(registered_.issuers, i);
            CHECK(judge_.verdict(line_.client) == status::Bad_CertificateChainIncomplete);
            CHECK(judge_.verdict(line_.whole_chain()) == good);
        }
        judge_.list = registered_;
        judge_.list.trusted.clear();
        CHECK(judge_.verdict(line_.whole_chain()) == status::Bad_CertificateUntrusted);
        CHECK(judge_.explains("Trust List Check", line_.client, {"CN=root"}));
    }

    void refuses_what_is_revoked()
    {
        refuse_once_revoked(line_.client, *line_.authorities.front(),
                            status::Bad_CertificateRevoked);
        for (std::size_t i = 0; i + 1 < line_.authorities.size(); ++i) {
            refuse_once_revoked(*line_.authorities[i], *line_.authorities[i + 1],
                                status::Bad_CertificateIssuerRevoked);
        }
    }

    void refuse_once_revoked(const Issued& one, const Issued& issuer, StatusCode status)
    {
        RevocationOptions options;
        options.revoked = {one.certificate};
        judge_.list = registered_;
        for (auto* lists : {&judge_.list.trusted_crls, &judge_.list.issuer_crls}) {
            for (crypto::RevocationList& list : *lists) {
                if (list.names_issuer(issuer.certificate)) {
                    list = revoke(issuer, options);
                }
            }
        }
        CHECK(judge_.verdict(line_.client) == status);
        CHECK(judge_.verdict(line_.whole_chain()) == status);
        CHECK(judge_.explains("Revocation Check", one, {issuer.certificate.subject()}));
    }

    const Plant::Line line_;
    TrustList registered_;
    Judge judge_;
};

} // namespace

TEST_CASE("A-3-2: by the CA certificate only, a root certificate", "[crypto][validation]")
{
    const Plant& p = plant();
    Row row{p.below_root()};
    row.trusts(p.root);
    row.trusts_list_of(p.root);
    row.check();
    CHECK(row.verdict_on_neighbour() == good);
}

TEST_CASE("A-3-2: by the CA certificate only, an intermediate certificate", "[crypto][validation]")
{
    const Plant& p = plant();
    Row row{p.below_intermediate()};
    row.trusts(p.intermediate);
    row.trusts_list_of(p.intermediate);
    row.knows(p.upper);
    row.knows(p.root);
    row.knows_list_of(p.upper);
    row.knows_list_of(p.root);
    row.check();
    CHECK(row.verdict_on_neighbour() == good);
}

TEST_CASE("A-3-2: by client certificate and CA certificate, a root certificate",
          "[crypto][validation]")
{
    const Plant& p = plant();
    Row row{p.below_root()};
    row.trusts(p.client_of_root);
    row.trusts(p.root);
    row.trusts_list_of(p.root);
    row.check();
    // Part 4, 6.1.3: one trusted certificate of the chain is enough. To trust this client alone,
    // the CA has to lie among the issuers.
    CHECK(row.verdict_on_neighbour() == good);
}

TEST_CASE("A-3-2: by client certificate and CA certificate, an intermediate certificate",
          "[crypto][validation]")
{
    const Plant& p = plant();
    Row row{p.below_intermediate()};
    row.trusts(p.client_of_intermediate);
    row.trusts(p.intermediate);
    row.trusts_list_of(p.intermediate);
    row.knows(p.upper);
    row.knows(p.root);
    row.knows_list_of(p.upper);
    row.knows_list_of(p.root);
    row.check();
    CHECK(row.verdict_on_neighbour() == good);
}

TEST_CASE("A-3-2: by the client certificate alone, a root certificate among the issuers",
          "[crypto][validation]")
{
    const Plant& p = plant();
    Row row{p.below_root()};
    row.trusts(p.client_of_root);
    row.knows(p.root);
    row.knows_list_of(p.root);
    row.check();
    CHECK(row.verdict_on_neighbour() == status::Bad_CertificateUntrusted);
}

TEST_CASE("A-3-2: by the client certificate alone, an intermediate certificate among the issuers",
          "[crypto][validation]")
{
    const Plant& p = plant();
    Row row{p.below_intermediate()};
    row.trusts(p.client_of_intermediate);
    for (const Issued* one : {&p.intermediate, &p.upper, &p.root}) {
        row.knows(*one);
        row.knows_list_of(*one);
    }
    row.check();
    CHECK(row.verdict_on_neighbour() == status::Bad_CertificateUntrusted);
}

TEST_CASE("A-3-1: self-signed and CA-signed client certificates side by side",
          "[crypto][validation]")
{
    const Plant& p = plant();
    const Issued alone = self_signed();
    Judge judge;
    judge.trusts(p.root);
    judge.has(revoke(p.root));
    CHECK(judge.verdict(alone) == status::Bad_CertificateUntrusted);
    judge.knows_issuer(alone); // an issuer makes nothing trusted, not even itself
    CHECK(judge.verdict(alone) == status::Bad_CertificateUntrusted);
    judge.trusts(alone);
    CHECK(judge.verdict(alone) == good);
    CHECK(judge.verdict(p.client_of_root) == good);
    judge.list.issuer_crls.clear();
    CHECK(judge.verdict(alone) == good);
    CHECK(judge.verdict(p.client_of_root) == status::Bad_CertificateRevocationUnknown);
}

} // namespace issuer_combinations_test
