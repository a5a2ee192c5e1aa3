#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <unistd.h>

#include <catch2/catch.hpp>

#include <busbar/crypto/certificate_validator.hpp>

#include "hex.hpp"
#include "issuing.hpp"
#include "status_text.hpp"

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::CertificateChain;
using crypto::TrustFolder;
using crypto::ValidationContext;
namespace fs = std::filesystem;

namespace {

class LogBook final : public LogSink {
public:
    void write(LogLevel, std::string_view source, std::string_view message) override
    {
        text += std::string{source} + ": " + std::string{message} + "\n";
    }

    std::string text;
};

/// A TrustFolder with verbs.
class Trust {
public:
    Trust() : folder_{make_folder()}, trust_{folder_.string(), log}
    {
        REQUIRE(trust_.create());
        context.policy = crypto::find_policy_by_name("Basic256Sha256");
        context.now = now;
    }
    ~Trust()
    {
        std::error_code error;
        fs::remove_all(folder_, error);
    }

    void trusts(const Certificate& certificate) const { put("trusted", certificate); }
    void knows_issuer(const Certificate& certificate) const { put("issuers", certificate); }
    void forgets(const Certificate& certificate) const
    {
        fs::remove(folder_ / "trusted" / (certificate.thumbprint_text() + ".der"));
    }
    [[nodiscard]] fs::path folder(const char* name) const { return folder_ / name; }
    [[nodiscard]] std::size_t count(const char* name) const
    {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator{folder_ / name}, fs::directory_iterator{}));
    }

    /// Good, or why the chain was refused.
    StatusCode verdict(const CertificateChain& chain)
    {
        log.text.clear();
        const auto result = trust_.validate(chain, context);
        if (result) {
            return {};
        }
        log.text = text(result.error());
        return result.error().status;
    }

    LogBook log;
    ValidationContext context;

private:
    static fs::path make_folder()
    {
        std::string name = (fs::temp_directory_path() / "busbar-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        return name;
    }
    void put(const char* where, const Certificate& certificate) const
    {
        std::ofstream file{folder_ / where / (certificate.thumbprint_text() + ".der"),
                           std::ios::binary};
        file.write(reinterpret_cast<const char*>(certificate.der().data()),
                   static_cast<std::streamsize>(certificate.der().size()));
    }

    fs::path folder_;
    TrustFolder trust_;
};

Issued leaf_with(void (*change)(CertificateOptions&), const Issued* issuer = nullptr)
{
    CertificateOptions options;
    change(options);
    return issue(options, key_number(1), issuer);
}

Issued plain_leaf(const Issued* issuer = nullptr)
{
    return issue({}, key_number(1), issuer);
}

/// Root, an authority below it and a leaf below that.
struct Family {
    Issued root = issue(authority("root"), key_number(2));
    Issued middle = issue(authority("middle"), key_number(3), &root);
    Issued leaf = plain_leaf(&middle);
};

constexpr StatusCode good{};

} // namespace

TEST_CASE("a self-signed certificate is trusted by being there", "[crypto][trust]")
{
    Trust trust;
    const Issued leaf = plain_leaf();
    CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateUntrusted);
    CHECK(trust.count("rejected") == 1);
    trust.trusts(leaf.certificate);
    CHECK(trust.verdict({leaf.certificate}) == good);
    CHECK(trust.log.text.empty());
    trust.forgets(leaf.certificate);
    CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateUntrusted);
    CHECK(trust.count("rejected") == 1);
}

TEST_CASE("the operator may move what was rejected", "[crypto][trust]")
{
    Trust trust;
    const Issued leaf = plain_leaf();
    CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateUntrusted);
    const fs::path file = fs::directory_iterator
    {
        trust.folder("rejected")
        } -> path();
    fs::rename(file, trust.folder("trusted") / "any name.crt");
    CHECK(trust.verdict({leaf.certificate}) == good);
}

TEST_CASE("files that are no certificates do no harm", "[crypto][trust]")
{
    Trust trust;
    const Issued leaf = plain_leaf();
    const auto pem = pem_of(leaf.certificate);
    std::ofstream{trust.folder("trusted") / "a.pem"}.write(
        reinterpret_cast<const char*>(pem.data()), static_cast<std::streamsize>(pem.size()));
    std::ofstream{trust.folder("trusted") / "notes.txt"} << "no certificate";
    std::ofstream{trust.folder("trusted") / "empty"};
    std::ofstream{trust.folder("trusted") / "large"} << std::string(100'000, 'x');
    // A certificate that OpenSSL would ask a terminal's passphrase for.
    std::ofstream{trust.folder("trusted") / "locked.pem"}
        << "-----BEGIN CERTIFICATE-----\nProc-Type: 4,ENCRYPTED\n"
           "DEK-Info: AES-256-CBC,00112233445566778899AABBCCDDEEFF\n\nAAAAAAAAAAAAAAAAAAAAAA==\n"
           "-----END CERTIFICATE-----\n";
    fs::create_directory(trust.folder("trusted") / "sub");
    fs::create_symlink("nowhere", trust.folder("trusted") / "dangling");
    CHECK(trust.verdict({leaf.certificate}) == good);
    // A file whose contents change is read again.
    std::ofstream{trust.folder("trusted") / "a.pem"} << "now something else";
    CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateUntrusted);
}

TEST_CASE("nothing is trusted when the folders are gone", "[crypto][trust]")
{
    Trust trust;
    const Issued leaf = plain_leaf();
    trust.trusts(leaf.certificate);
    fs::remove_all(trust.folder("trusted").parent_path());
    CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateUntrusted);
    CHECK(trust.verdict({}) == status::Bad_CertificateInvalid);
    LogBook log;
    std::ofstream{trust.folder("trusted").parent_path()} << "a file";
    CHECK(TrustFolder{trust.folder("trusted").parent_path().string(), log}.create().error() ==
          status::Bad_ConfigurationError);
}

TEST_CASE("a CA vouches for its leaf", "[crypto][trust]")
{
    Trust trust;
    const Issued root = issue(authority("root"), key_number(2));
    const Issued leaf = plain_leaf(&root);
    CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateChainIncomplete);
    CHECK(trust.verdict({leaf.certificate, root.certificate}) == status::Bad_CertificateUntrusted);
    SECTION("a trusted root")
    {
        trust.trusts(root.certificate);
        CHECK(trust.verdict({leaf.certificate}) == good);
        CHECK(trust.verdict({leaf.certificate, root.certificate}) == good);
    }
    SECTION("a root among the issuers alone trusts nobody")
    {
        trust.knows_issuer(root.certificate);
        CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateUntrusted);
        trust.trusts(leaf.certificate);
        CHECK(trust.verdict({leaf.certificate}) == good);
    }
    SECTION("a trusted leaf still needs its chain")
    {
        trust.trusts(leaf.certificate);
        CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateChainIncomplete);
        CHECK(trust.verdict({leaf.certificate, root.certificate}) == good);
    }
}

TEST_CASE("a CA below a CA vouches with the whole chain", "[crypto][trust]")
{
    Trust trust;
    const Family family;
    trust.trusts(family.middle.certificate);
    CHECK(trust.verdict({family.leaf.certificate}) == status::Bad_CertificateChainIncomplete);
    trust.knows_issuer(family.root.certificate);
    CHECK(trust.verdict({family.leaf.certificate}) == good);
    CHECK(trust.verdict({family.leaf.certificate, family.root.certificate,
                         family.middle.certificate}) == good); // in any order
    // Another leaf of the root is not trusted because the CA beside it is.
    const Issued other = plain_leaf(&family.root);
    CHECK(trust.verdict({other.certificate}) == status::Bad_CertificateUntrusted);
}

TEST_CASE("who takes a trusted name is not trusted", "[crypto][trust][hostile]")
{
    // ATTACKS C10.
    Trust trust;
    const Family family;
    trust.trusts(family.root.certificate);
    trust.knows_issuer(family.middle.certificate);
    const Issued impostor = issue(authority("root"), key_number(4));
    const Issued below = plain_leaf(&impostor);
    for (const CertificateChain& chain :
         {CertificateChain{below.certificate, impostor.certificate},
          CertificateChain{below.certificate}, CertificateChain{impostor.certificate},
          CertificateChain{below.certificate, impostor.certificate, family.root.certificate},
          CertificateChain{issue(authority("leaf"), key_number(4)).certificate}}) {
        CHECK_FALSE(trust.verdict(chain).is_good());
    }
    // The same subject and issuer, another key.
    const Issued trusted = plain_leaf();
    trust.trusts(trusted.certificate);
    CHECK_FALSE(trust.verdict({issue({}, key_number(4)).certificate}).is_good());
}

TEST_CASE("a signature with one wrong bit is none", "[crypto][trust][hostile]")
{
    Trust trust;
    const Family family;
    const Issued alone = plain_leaf();
    trust.trusts(family.root.certificate);
    trust.trusts(alone.certificate);
    trust.knows_issuer(family.middle.certificate);
    for (const Certificate& certificate : {alone.certificate, family.leaf.certificate}) {
        auto der = copy_of(certificate.der());
        der[der.size() - 10] ^= std::byte{1};
        const auto changed = Certificate::parse(der);
        REQUIRE(changed);
        CHECK(trust.verdict({*changed}) == status::Bad_CertificateInvalid);
    }
}

TEST_CASE("a leaf is no CA", "[crypto][trust][hostile]")
{
    Trust trust;
    const Issued application = leaf_with([](auto& o) { o.key_usage += ",keyCertSign"; });
    trust.trusts(application.certificate);
    CHECK(trust.verdict({application.certificate}) == good);
    const Issued below = issue({}, key_number(4), &application);
    CHECK_FALSE(trust.verdict({below.certificate, application.certificate}).is_good());

    CertificateOptions weak = authority("no CA");
    weak.basic_constraints = "";
    weak.key_usage = "";
    const Issued unmarked = issue(weak, key_number(5));
    trust.trusts(unmarked.certificate);
    CHECK(trust.verdict({plain_leaf(&unmarked).certificate}) ==
          status::Bad_CertificateIssuerUseNotAllowed);

    CertificateOptions short_path = authority("short");
    short_path.basic_constraints = "critical,CA:TRUE,pathlen:0";
    const Issued root = issue(short_path, key_number(2));
    const Issued middle = issue(authority("middle"), key_number(3), &root);
    trust.trusts(root.certificate);
    CHECK(trust.verdict({plain_leaf(&middle).certificate, middle.certificate}) ==
          status::Bad_CertificateIssuerUseNotAllowed);
}

TEST_CASE("loops and long chains end", "[crypto][trust][hostile]")
{
    // ATTACKS C2: A signed by B, B signed by A.
    Trust trust;
    const Issued a = issue(authority("A"), key_number(2));
    const Issued b = issue(authority("B"), key_number(3), &a);
    const Issued a_by_b = issue(authority("A"), key_number(2), &b);
    const Issued leaf = plain_leaf(&a_by_b);
    CHECK_FALSE(
        trust.verdict({leaf.certificate, a_by_b.certificate, b.certificate, a_by_b.certificate})
            .is_good());

    CertificateChain chain;
    std::vector<Issued> authorities{issue(authority("0"), key_number(2))};
    trust.trusts(authorities.front().certificate);
    for (std::size_t i = 1; i < crypto::max_chain_length + 1; ++i) {
        authorities.push_back(
            issue(authority(std::to_string(i)), key_number(2 + i % 2), &authorities.back()));
    }
    const auto chain_of = [&](std::size_t issuers) {
        CertificateChain all{plain_leaf(&authorities[issuers - 1]).certificate};
        for (std::size_t i = issuers; i-- > 0;) {
            all.push_back(authorities[i].certificate);
        }
        return all;
    };
    CHECK(trust.verdict(chain_of(crypto::max_chain_length - 1)) == good);
    CHECK_FALSE(trust.verdict(chain_of(crypto::max_chain_length)).is_good());
    for (const Issued& one : authorities) {
        trust.knows_issuer(one.certificate);
    }
    CHECK(trust.verdict({chain_of(crypto::max_chain_length).front()}) ==
          status::Bad_CertificateChainIncomplete);
}

TEST_CASE("times are checked for all of the chain, once it is trusted", "[crypto][trust]")
{
    Trust trust;
    const Issued expired = leaf_with([](auto& o) { o.valid_to = in_days(-1); });
    const Issued early = leaf_with([](auto& o) { o.valid_from = in_days(1); });
    CHECK(trust.verdict({expired.certificate}) == status::Bad_CertificateUntrusted);
    for (const Certificate& one : {expired.certificate, early.certificate}) {
        trust.trusts(one);
        CHECK(trust.verdict({one}) == status::Bad_CertificateTimeInvalid);
    }
    trust.context.now = in_days(1);
    CHECK(trust.verdict({early.certificate}) == good);
    trust.context.now = in_days(100);
    CHECK(trust.verdict({early.certificate}) == good);
    trust.context.now.ticks += DateTime::ticks_per_second;
    CHECK(trust.verdict({early.certificate}) == status::Bad_CertificateTimeInvalid);

    trust.context.now = now;
    CertificateOptions old = authority("old");
    old.valid_to = in_days(-1);
    const Issued root = issue(old, key_number(2));
    trust.trusts(root.certificate);
    CHECK(trust.verdict({plain_leaf(&root).certificate}) ==
          status::Bad_CertificateIssuerTimeInvalid);
    CHECK(trust.log.text.find("CN=old") != std::string::npos);
}

TEST_CASE("the policy asks for key size and digest", "[crypto][trust]")
{
    Trust trust;
    const Issued sha1 = leaf_with([](auto& o) { o.digest = "SHA1"; });
    const Issued sha512 = leaf_with([](auto& o) { o.digest = "SHA512"; });
    trust.trusts(sha1.certificate);
    trust.trusts(sha512.certificate);
    CHECK(trust.verdict({sha1.certificate}) == status::Bad_CertificatePolicyCheckFailed);
    CHECK(trust.verdict({sha512.certificate}) == good);
    crypto::SecurityPolicy strict = *trust.context.policy;
    strict.min_key_bits = 3072;
    trust.context.policy = &strict;
    CHECK(trust.verdict({sha512.certificate}) == status::Bad_CertificatePolicyCheckFailed);
    // An authority with a weak key or digest does not vouch; how a root signed itself is no matter.
    trust.context.policy = crypto::find_policy_by_name("Basic256Sha256");
    CertificateOptions options = authority("root");
    options.digest = "SHA1";
    const Issued root = issue(options, key_number(2));
    options.common_name = "middle";
    const Issued middle = issue(options, key_number(3), &root);
    trust.trusts(root.certificate);
    CHECK(trust.verdict({plain_leaf(&root).certificate}) == good);
    CHECK(trust.verdict({plain_leaf(&middle).certificate, middle.certificate}) ==
          status::Bad_CertificatePolicyCheckFailed);
}

TEST_CASE("the ApplicationUri matches whole and alone", "[crypto][trust]")
{
    Trust trust;
    trust.context.application_uri = "urn:plc";
    const auto verdict_on = [&](const char* names) {
        CertificateOptions options;
        options.names = names;
        const Issued leaf = issue(options, key_number(1));
        trust.trusts(leaf.certificate);
        return trust.verdict({leaf.certificate});
    };
    CHECK(verdict_on("URI:urn:plc") == good);
    for (const char* names : {"URI:urn:plc:x", "URI:urn:pl", "URI:urn:evil:urn:plc", "URI:URN:PLC",
                              "URI:urn:plc,URI:urn:other", "DNS:urn:plc", ""}) {
        INFO(names);
        CHECK(verdict_on(names) == status::Bad_CertificateUriInvalid);
    }
    const Issued in_name = leaf_with([](auto& o) {
        o.common_name = "urn:plc";
        o.names = "";
    });
    trust.trusts(in_name.certificate);
    CHECK(trust.verdict({in_name.certificate}) == status::Bad_CertificateUriInvalid);
}

TEST_CASE("a client checks the host it connected to", "[crypto][trust]")
{
    Trust trust;
    const Issued leaf = plain_leaf();
    trust.trusts(leaf.certificate);
    for (const char* host : {"", "plc.example", "PLC.EXAMPLE", "192.0.2.7"}) {
        trust.context.host_name = host;
        CHECK(trust.verdict({leaf.certificate}) == good);
    }
    for (const char* host : {"plc", "x.plc.example", "192.0.2.8", "example", "leaf"}) {
        INFO(host);
        trust.context.host_name = host;
        CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateHostNameInvalid);
    }
}

TEST_CASE("a key may be used as its certificate says", "[crypto][trust]")
{
    Trust trust;
    const auto verdict_on = [&](const char* usage, const char* extended) {
        CertificateOptions options;
        options.key_usage = usage;
        options.extended_key_usage = extended;
        const Issued leaf = issue(options, key_number(1));
        trust.trusts(leaf.certificate);
        return trust.verdict({leaf.certificate});
    };
    CHECK(verdict_on("digitalSignature,dataEncipherment", "clientAuth") == good);
    CHECK(verdict_on("", "") == good);
    for (const char* usage : {"digitalSignature", "dataEncipherment", "keyCertSign"}) {
        CHECK(verdict_on(usage, "clientAuth") == status::Bad_CertificateUseNotAllowed);
    }
    CHECK(verdict_on("digitalSignature,dataEncipherment", "codeSigning") ==
          status::Bad_CertificateUseNotAllowed);
}

TEST_CASE("what nobody understands and is critical is refused", "[crypto][trust][hostile]")
{
    Trust trust;
    const Issued odd = leaf_with([](auto& o) { o.extra = "\x05"; });
    trust.trusts(odd.certificate);
    CHECK(trust.verdict({odd.certificate}) == status::Bad_CertificateInvalid);
}

TEST_CASE("the log says what failed and what can be done", "[crypto][trust]")
{
    Trust trust;
    const Issued leaf = leaf_with([](auto& o) { o.common_name = "press\n4"; });
    CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateUntrusted);
    const std::string& text = trust.log.text;
    CHECK(text.find("Bad_CertificateUntrusted") != std::string::npos);
    CHECK(text.find(leaf.certificate.thumbprint_text()) != std::string::npos);
    CHECK(text.find("Part 4, 6.1.3") != std::string::npos);
    CHECK(text.find("rejected to trusted") != std::string::npos);
    CHECK(std::count(text.begin(), text.end(), '\n') == 0);
}

TEST_CASE("strangers do not fill the disk", "[crypto][trust][hostile]")
{
    // ATTACKS G2.
    Trust trust;
    std::string first;
    const std::size_t strangers = TrustFolder::max_rejected + 15;
    for (std::size_t i = 0; i < strangers; ++i) {
        trust.context.now = {now.ticks +
                             static_cast<std::int64_t>(i) * 6 * DateTime::ticks_per_second};
        const Issued leaf = plain_leaf();
        first = first.empty() ? leaf.certificate.thumbprint_text() : first;
        CHECK(trust.verdict({leaf.certificate}) == status::Bad_CertificateUntrusted);
    }
    CHECK(trust.count("rejected") == TrustFolder::max_rejected);
    CHECK_FALSE(fs::exists(trust.folder("rejected") / (first + ".der")));
}

TEST_CASE("strangers do not wear out the disk", "[crypto][trust][hostile]")
{
    Trust trust;
    for (std::size_t i = 0; i < 3 * TrustFolder::max_rejected_per_minute; ++i) {
        static_cast<void>(trust.verdict({plain_leaf().certificate}));
    }
    CHECK(trust.count("rejected") == TrustFolder::max_rejected_per_minute);
    trust.context.now.ticks += 60 * DateTime::ticks_per_second;
    static_cast<void>(trust.verdict({plain_leaf().certificate}));
    CHECK(trust.count("rejected") == TrustFolder::max_rejected_per_minute + 1);
    trust.context.now = in_days(-1); // the clock went back
    static_cast<void>(trust.verdict({plain_leaf().certificate}));
    CHECK(trust.count("rejected") == TrustFolder::max_rejected_per_minute + 2);
}

TEST_CASE("the insecure validator still wants a key of the policy", "[crypto][trust]")
{
    crypto::InsecureAcceptAnyCertificate any;
    const Issued leaf = plain_leaf();
    const auto* policy = crypto::find_policy_by_name("Basic256Sha256");
    CHECK(any.validate({leaf.certificate}, {policy, now, {}}));
    CHECK_FALSE(any.validate({}, {policy, now, {}}));
    crypto::SecurityPolicy strict = *policy;
    strict.min_key_bits = 3072;
    CHECK_FALSE(any.validate({leaf.certificate}, {&strict, now, {}}));
}
