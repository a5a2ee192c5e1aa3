#include "crypto/openssl.hpp"
#include "hex.hpp"
#include "judging.hpp"
#include "support/seeded_random.hpp"

namespace revocation_list_test {

using namespace busbar;
using namespace busbar::test;
using crypto::RevocationList;

namespace {

const Issued& root()
{
    static const Issued made = issue(authority("root"), key_number(2));
    return made;
}

const Issued& leaf()
{
    static const Issued made = leaf_of(&root());
    return made;
}

RevocationOptions revoking_leaf()
{
    RevocationOptions options;
    options.revoked = {root().certificate, leaf().certificate};
    return options;
}

/// Where the parameters of the algorithm stand that nobody signed: behind the last of its OIDs.
std::size_t parameters_beside_signature(const RevocationList& list)
{
    static constexpr unsigned char sha256_with_rsa[] = {0x2A, 0x86, 0x48, 0x86, 0xF7,
                                                        0x0D, 0x01, 0x01, 0x0B, 0x05};
    const auto oid = std::as_bytes(std::span{sha256_with_rsa});
    const auto der = list.der();
    const auto found = std::find_end(der.begin(), der.end(), oid.begin(), oid.end());
    REQUIRE(found != der.end());
    return static_cast<std::size_t>(found - der.begin()) + oid.size() - 1;
}

/// Everything that can be asked of a list whose bytes a stranger chose.
void ask_everything(const RevocationList& list)
{
    static_cast<void>(list.issuer());
    static_cast<void>(list.thumbprint_text());
    static_cast<void>(list.this_update());
    static_cast<void>(list.next_update());
    static_cast<void>(list.size());
    static_cast<void>(list.is_complete());
    static_cast<void>(list.is_signed_by(root().certificate));
    static_cast<void>(list.revoked_at(leaf().certificate));
}

} // namespace

TEST_CASE("a revocation list tells what it says", "[crypto][revocation]")
{
    const RevocationList list = revoke(root(), revoking_leaf());
    CHECK(list.issuer() == "CN=root");
    CHECK(list.this_update() == in_days(-1));
    CHECK(list.next_update() == in_days(30));
    CHECK(list.size() == 2);
    CHECK(list.is_complete());
    CHECK(list.thumbprint_text().size() == 40);
    CHECK(list.revoked_at(leaf().certificate) == in_days(-2));
    CHECK_FALSE(list.revoked_at(leaf_of(&root()).certificate));
    const RevocationList empty = revoke(root());
    CHECK(empty.size() == 0);
    CHECK_FALSE(empty.revoked_at(leaf().certificate));
    CHECK_FALSE(empty == list);

    CHECK(*RevocationList::parse(list.der()) == list);
    CHECK(*RevocationList::parse_file(list.der()) == list);
    CHECK(*RevocationList::parse_file(pem_of(list)) == list);
}

TEST_CASE("a revocation list is believed with its issuer's signature", "[crypto][revocation]")
{
    const RevocationList list = revoke(root());
    const Issued impostor = issue(authority("root"), key_number(4));
    const Issued other = issue(authority("other"), key_number(2));
    CHECK(list.is_signed_by(root().certificate));
    CHECK(list.names_issuer(impostor.certificate));
    CHECK_FALSE(list.is_signed_by(impostor.certificate));
    CHECK_FALSE(list.names_issuer(other.certificate));
    CHECK_FALSE(list.is_signed_by(other.certificate)); // the same key under another name
    CertificateOptions options = authority("root");
    options.key_usage = "critical,keyCertSign";
    CHECK_FALSE(list.is_signed_by(issue(options, key_number(2)).certificate));
    options.key_usage = "";
    CHECK(list.is_signed_by(issue(options, key_number(2)).certificate));
}

TEST_CASE("a revocation list that is a part only says so", "[crypto][revocation]")
{
    const auto is_complete = [](void (*change)(RevocationOptions&)) {
        RevocationOptions options = revoking_leaf();
        change(options);
        return revoke(root(), options).is_complete();
    };
    CHECK(is_complete([](auto&) {}));
    CHECK_FALSE(is_complete([](auto& o) { o.is_delta = true; }));
    CHECK_FALSE(is_complete([](auto& o) { o.extra = "\x05"; }));
    CHECK_FALSE(is_complete([](auto& o) { o.entry_extra = "\x05"; }));
    for (const char* point : {"critical,onlyCA:TRUE", "onlyuser:TRUE", "critical,indirectCRL:TRUE",
                              "critical,onlysomereasons:keyCompromise"}) {
        INFO(point);
        RevocationOptions options;
        options.distribution_point = point;
        CHECK_FALSE(revoke(root(), options).is_complete());
    }
}

TEST_CASE("a revocation list cut or lengthened is none", "[crypto][revocation][hostile]")
{
    const RevocationList list = revoke(root(), revoking_leaf());
    for (std::size_t size = 0; size < list.der().size(); ++size) {
        const auto cut = RevocationList::parse(list.der().first(size));
        REQUIRE_FALSE(cut);
        CHECK(cut.error() == status::Bad_CertificateInvalid);
    }
    auto longer = copy_of(list.der());
    longer.push_back(std::byte{0});
    CHECK_FALSE(RevocationList::parse(longer));
    // A second list in a file would be overlooked.
    auto two = pem_of(list);
    const auto second = pem_of(revoke(root()));
    two.insert(two.end(), second.begin(), second.end());
    CHECK_FALSE(RevocationList::parse_file(two));
    CHECK_FALSE(RevocationList::parse(leaf().certificate.der()));
    CHECK_FALSE(RevocationList::parse_file(pem_of(leaf().certificate)));
}

TEST_CASE("a revocation list with flipped bits is not believed", "[crypto][revocation][hostile]")
{
    const auto der = copy_of(revoke(root(), revoking_leaf()).der());
    for (std::size_t bit = 0; bit < der.size() * 8; ++bit) {
        auto changed = der;
        changed[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        const auto parsed = RevocationList::parse(changed);
        if (parsed) {
            ask_everything(*parsed);
            CHECK_FALSE(parsed->is_signed_by(root().certificate));
        }
    }
}

TEST_CASE("a revocation list whose algorithm is not the signed one is not believed",
          "[crypto][revocation][hostile]")
{
    const RevocationList list = revoke(root(), revoking_leaf());
    REQUIRE(crypto::detail::names_one_algorithm(list.native(), list.der()));
    struct Change {
        const char* what;
        std::size_t from_parameters; // the byte, counted from the NULL of RSA's parameters
        int value;
    };
    static constexpr Change changes[] = {
        {"parameters that are an OCTET STRING", 0, 0x04},
        {"parameters that are a SEQUENCE", 0, 0x30},
        {"parameters of another class", 0, 0x85},
        {"SHA-384 instead of SHA-256", std::size_t(-1), 0x0C},
        {"SHA-1 instead of SHA-256", std::size_t(-1), 0x05},
    };
    const auto at = parameters_beside_signature(list);
    for (const Change& change : changes) {
        INFO(change.what);
        auto der = copy_of(list.der());
        der[at + change.from_parameters] = static_cast<std::byte>(change.value);
        const auto parsed = RevocationList::parse(der);
        REQUIRE(parsed);
        CHECK_FALSE(crypto::detail::names_one_algorithm(parsed->native(), parsed->der()));
        CHECK_FALSE(parsed->is_signed_by(root().certificate));
    }
}

TEST_CASE("random bytes are no revocation list", "[crypto][revocation][hostile]")
{
    SeededRandom random{10};
    for (int i = 0; i < 2'000; ++i) {
        std::vector<std::byte> bytes(1 + static_cast<std::size_t>(i) % 300);
        REQUIRE(random.fill(bytes));
        CHECK_FALSE(RevocationList::parse(bytes));
        bytes.front() = std::byte{0x30};
        CHECK_FALSE(RevocationList::parse_file(bytes));
    }
}

TEST_CASE("a revocation list is limited in size", "[crypto][revocation][hostile]")
{
    RevocationOptions options;
    options.revoked.assign(20'000, leaf().certificate);
    const RevocationList large = revoke(root(), options);
    CHECK(large.der().size() > RevocationList::max_size / 3);
    CHECK(large.size() == 20'000);
    CHECK(large.revoked_at(leaf().certificate));
    const std::vector<std::byte> endless(RevocationList::max_size + 1, std::byte{0x30});
    CHECK_FALSE(RevocationList::parse(endless));
    const std::vector<std::byte> text(2 * RevocationList::max_size + 1, std::byte{'-'});
    CHECK_FALSE(RevocationList::parse_file(text));
}

} // namespace revocation_list_test
