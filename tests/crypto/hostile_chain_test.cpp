#include "crypto/certificate_checks.hpp"
#include "hex.hpp"
#include "judging.hpp"

namespace hostile_chain_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::CertificateChain;
using crypto::max_chain_length;
using crypto::detail::SignatureChecks;

namespace {

/// Signatures that are verified to find a path for the chain, or to find that there is none.
std::size_t signatures_for(const CertificateChain& chain, const crypto::TrustList& list)
{
    SignatureChecks signatures;
    static_cast<void>(crypto::detail::find_path(chain, list, now, signatures));
    return signatures.count();
}

CertificateOptions without_key_identifiers(const std::string& name)
{
    CertificateOptions options = authority(name);
    options.key_identifiers = false;
    return options;
}

/// `count` authorities, the first a root, each signed by the one before.
std::vector<Issued> authorities_in_line(std::size_t count)
{
    std::vector<Issued> line{issue(authority("0"), key_number(2))};
    while (line.size() < count) {
        line.push_back(issue(authority(std::to_string(line.size())),
                             key_number(2 + line.size() % 2), &line.back()));
    }
    return line;
}

} // namespace

TEST_CASE("a loop of issuers ends before a signature is verified", "[crypto][validation][hostile]")
{
    // tests/attacks.txt, C2: A signed by B, B signed by A.
    Judge judge;
    const Issued first_a = issue(authority("A"), key_number(2));
    const Issued b = issue(authority("B"), key_number(3), &first_a);
    const Issued a = issue(authority("A"), key_number(2), &b);
    const Issued leaf = leaf_of(&a);
    const CertificateChain chain{leaf.certificate, a.certificate, b.certificate, a.certificate,
                                 b.certificate,    a.certificate, b.certificate};
    CHECK(judge.verdict(chain) == status::Bad_CertificateChainIncomplete);
    CHECK(judge.explains("Build Certificate Chain", leaf, {"sign each other", "no root"}));
    judge.knows_issuer(a);
    judge.knows_issuer(b);
    judge.trusts(b);
    CHECK(judge.verdict(chain) == status::Bad_CertificateChainIncomplete);
    CHECK(signatures_for(chain, judge.list) == 0);
    // The loop does not hide the way out.
    judge.trusts(first_a);
    judge.has(revoke(first_a));
    judge.has(revoke(b));
    CHECK(judge.verdict(chain) == good);
}

TEST_CASE("who issues itself is a root only if it signs itself", "[crypto][validation][hostile]")
{
    Judge judge;
    const Issued root = issue(authority("A"), key_number(2));
    const Issued self_issued = issue(authority("A"), key_number(3), &root); // "A" by "A"
    const Issued leaf = leaf_of(&self_issued);
    judge.trusts(self_issued);
    CHECK(judge.verdict(leaf) == status::Bad_CertificateChainIncomplete);
    judge.has(revoke(root));
    judge.has(revoke(self_issued));
    CHECK(judge.verdict({leaf.certificate, root.certificate}) == good);
    // Without key identifiers it looks like a root, until its signature is verified.
    const Issued plain_root = issue(without_key_identifiers("A"), key_number(2));
    const Issued plain = issue(without_key_identifiers("A"), key_number(3), &plain_root);
    judge.list = {};
    judge.trusts(plain);
    CHECK(judge.verdict(plain) == status::Bad_CertificateInvalid);
    CHECK(judge.explains("Signature", plain, {"not signed with its own key"}));
}

TEST_CASE("long chains are refused", "[crypto][validation][hostile]")
{
    // tests/attacks.txt, C2: 50 deep; as many as may be sent are accepted.
    Judge judge;
    const std::vector<Issued> line = authorities_in_line(50);
    judge.trusts(line.front());
    for (const Issued& one : line) {
        judge.has(revoke(one));
    }
    const auto chain_below = [&](std::size_t issuers) {
        CertificateChain chain{leaf_of(&line[issuers - 1]).certificate};
        for (std::size_t i = issuers; i-- > 0;) {
            chain.push_back(line[i].certificate);
        }
        return chain;
    };
    CHECK(judge.verdict(chain_below(max_chain_length - 1)) == good);
    const CertificateChain deep = chain_below(50);
    CHECK(judge.verdict(deep) == status::Bad_CertificateInvalid);
    CHECK(judge.refusal->check == "Certificate Structure");
    CHECK(judge.refusal->found.find("51 certificates") != std::string::npos);
    // The trust list does not make a chain any shorter.
    for (const Issued& one : line) {
        judge.knows_issuer(one);
    }
    const CertificateChain alone{deep.front()};
    CHECK(judge.verdict(alone) == status::Bad_CertificateChainIncomplete);
    CHECK(judge.refusal->found.find("more than 9 CAs") != std::string::npos);
    CHECK(signatures_for(alone, judge.list) == 0);
}

TEST_CASE("giant certificates are refused by their size", "[crypto][validation][hostile]")
{
    // tests/attacks.txt, C2.
    Judge judge;
    CertificateChain chain{self_signed().certificate};
    for (int i = 0; i < 9; ++i) {
        CertificateOptions options = authority("large");
        options.name_constraints = "permitted;DNS:" + std::string(9'000, 'x');
        chain.push_back(issue(options, key_number(2)).certificate);
    }
    judge.list.trusted = chain;
    CHECK(judge.verdict(chain) == status::Bad_CertificateInvalid);
    CHECK(judge.refusal->found.find("65536 bytes are allowed") != std::string::npos);
    chain.erase(chain.begin() + 2, chain.end());
    CHECK(judge.verdict(chain) == good);

    std::vector<std::byte> der;
    while (der.size() <= crypto::max_chain_size) {
        der.insert(der.end(), chain.back().der().begin(), chain.back().der().end());
    }
    CHECK_FALSE(crypto::parse_chain(der));
    CHECK_FALSE(crypto::parse_chain(std::vector<std::byte>(1U << 20U, std::byte{0x30})));
}

TEST_CASE("certificates that are sent twice cost nothing", "[crypto][validation][hostile]")
{
    const Family family;
    Judge judge;
    family.introduce_to(judge);
    CertificateChain chain{family.leaf.certificate};
    for (int i = 0; i < 3; ++i) {
        for (const Issued* one : {&family.middle, &family.root, &family.leaf}) {
            chain.push_back(one->certificate);
        }
    }
    CHECK(judge.verdict(chain) == good);
    CHECK(signatures_for(chain, judge.list) == 3);
    judge.list.trusted.clear();
    CHECK(judge.verdict(chain) == status::Bad_CertificateUntrusted);
    CHECK(signatures_for(chain, judge.list) == 3);
}

TEST_CASE("signatures are verified a limited number of times", "[crypto][validation][hostile]")
{
    // Everybody claims to be the issuer; who it is comes last.
    Judge judge;
    CertificateOptions options;
    options.key_identifiers = false;
    const CertificateOptions named = without_key_identifiers("root");
    const Issued root = issue(named, key_number(2));
    const Issued leaf = issue(options, key_number(1), &root);
    for (std::size_t i = 0; i < crypto::max_signature_checks - 2; ++i) {
        judge.trusts(issue(named, key_number(3)));
    }
    judge.trusts(root);
    judge.has(revoke(root));
    judge.settings.suppress_find_revocation_list = true; // there is no check left for the list
    CHECK(judge.verdict(leaf) == good);
    CHECK(judge.suppressed.size() == 1);
    judge.list.trusted.insert(judge.list.trusted.begin(), issue(named, key_number(3)).certificate);
    CHECK(judge.verdict(leaf) == status::Bad_CertificateInvalid);
    CHECK(judge.explains("Signature", leaf, {"more than 32 signatures"}));
    CHECK(signatures_for({leaf.certificate}, judge.list) == crypto::max_signature_checks);
    // Authorities that all vouch for each other offer very many paths.
    judge.list = {};
    std::vector<Certificate> crowd;
    for (std::size_t i = 0; i < 9; ++i) {
        const std::string to = i < 3 ? "x" : (i < 6 ? "y" : "z");
        const std::string by = i < 3 ? "y" : (i < 6 ? "z" : "x");
        const Issued issuer = issue(without_key_identifiers(by), key_number(2));
        crowd.push_back(issue(without_key_identifiers(to), key_number(2), &issuer).certificate);
    }
    const Issued x = issue(without_key_identifiers("x"), key_number(2));
    CertificateChain chain{issue(options, key_number(1), &x).certificate};
    chain.insert(chain.end(), crowd.begin(), crowd.end());
    CHECK(judge.verdict(chain) == status::Bad_CertificateChainIncomplete);
    judge.knows_issuer(x);
    CHECK(judge.verdict(chain) == status::Bad_CertificateUntrusted);
    CHECK(signatures_for(chain, judge.list) <= crypto::max_signature_checks);
}

TEST_CASE("keys that are too large or mean nothing are refused unread",
          "[crypto][validation][hostile]")
{
    // tests/attacks.txt, C3.
    const std::string odd = random_modulus(2048, true);
    CHECK(Certificate::parse(der_with_public_key(odd, "10001")));
    CHECK_FALSE(Certificate::parse(der_with_public_key(random_modulus(16'384, true), "10001")));
    CHECK_FALSE(Certificate::parse(der_with_public_key(random_modulus(2048, false), "10001")));
    CHECK_FALSE(Certificate::parse(der_with_public_key(odd, "01")));
    Judge judge;
    for (const int bits : {512, 1024, 8192}) {
        const auto odd_one =
            Certificate::parse(der_with_public_key(random_modulus(bits, true), "10001"));
        REQUIRE(odd_one);
        judge.list.trusted = {*odd_one};
        CHECK_FALSE(judge.verdict(CertificateChain{*odd_one}).is_good());
        CHECK_FALSE(crypto::check_certificate(*odd_one, judge.context));
    }
}

TEST_CASE("who takes a trusted name is not trusted", "[crypto][validation][hostile]")
{
    // tests/attacks.txt, C10.
    Judge judge;
    const Family family;
    family.introduce_to(judge);
    const Issued impostor = issue(authority("root"), key_number(4));
    const Issued below = leaf_of(&impostor);
    for (const CertificateChain& chain :
         {CertificateChain{below.certificate, impostor.certificate},
          CertificateChain{below.certificate}, CertificateChain{impostor.certificate},
          CertificateChain{below.certificate, impostor.certificate, family.root.certificate},
          CertificateChain{issue(authority("leaf"), key_number(4)).certificate}}) {
        CHECK_FALSE(judge.verdict(chain).is_good());
    }
    // Key identifiers are claims too: without them the names alone match.
    CertificateOptions options;
    options.key_identifiers = false;
    const Issued plain_impostor = issue(without_key_identifiers("root"), key_number(4));
    const Issued plain_below = issue(options, key_number(1), &plain_impostor);
    CHECK(judge.verdict(plain_below) == status::Bad_CertificateInvalid);
    CHECK(judge.verdict({plain_below.certificate, plain_impostor.certificate}) ==
          status::Bad_CertificateUntrusted);
    // The same subject, issuer and serial number, another key.
    options = {};
    options.serial = 7;
    const Issued trusted = issue(options, key_number(1));
    judge.trusts(trusted);
    CHECK(judge.verdict(trusted) == good);
    CHECK(judge.verdict(issue(options, key_number(4))) == status::Bad_CertificateUntrusted);
    // A trusted certificate behind another one trusts nobody.
    CHECK(judge.verdict({below.certificate, impostor.certificate, trusted.certificate}) ==
          status::Bad_CertificateUntrusted);
}

TEST_CASE("an application's certificate is no CA's", "[crypto][validation][hostile]")
{
    // tests/attacks.txt, C10.
    Judge judge;
    const Issued application = self_signed([](auto& o) { o.key_usage += ",keyCertSign"; });
    judge.trusts(application);
    CHECK(judge.verdict(application) == good);
    const Issued below = issue({}, key_number(4), &application);
    judge.has(revoke(application));
    CHECK(judge.verdict({below.certificate, application.certificate}) ==
          status::Bad_CertificateIssuerUseNotAllowed);
}

TEST_CASE("an explain line is one line, whatever a certificate names",
          "[crypto][validation][hostile]")
{
    Judge judge;
    CertificateOptions options;
    options.common_name = "press\n4\x1b[2J";
    options.names = "URI:urn:a\x1b";
    const Issued odd = issue(options, key_number(1));
    CHECK(judge.verdict(odd) == status::Bad_CertificateUntrusted);
    judge.trusts(odd);
    judge.context.application_uri = "urn:\nb";
    CHECK(judge.verdict(odd) == status::Bad_CertificateUriInvalid);
    const std::string line = text(*judge.refusal);
    CHECK(line.find_first_of("\n\x1b") == std::string::npos);
    CHECK(line.find(odd.certificate.thumbprint_text()) != std::string::npos);
}

} // namespace hostile_chain_test
