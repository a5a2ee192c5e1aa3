#include <busbar/crypto/certificate_store.hpp>

#include <sstream>

#include "revoking.hpp"
#include "store_fixture.hpp"

namespace certificate_store_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::CertificateStore;
using crypto::StoreEntry;
using crypto::StoreLimits;
using crypto::StoreList;

namespace {

Certificate named(const std::string& common_name)
{
    CertificateOptions options;
    options.common_name = common_name;
    return issue(options, key_number(1)).certificate;
}

} // namespace

TEST_CASE("a store has the folders that tools know", "[crypto][store]")
{
    StoreFixture fixture;
    for (const char* list : {"own", "trusted", "issuers", "rejected"}) {
        CHECK(fs::is_directory(fixture.path(list) / "certs"));
        CHECK(fs::is_directory(fixture.path(list) / "crl"));
    }
    CHECK(mode_of(fixture.path("own/private")) == 0700);
    CHECK(fixture.log.lines.empty());
    REQUIRE(fixture.store.create()); // again is fine
    LogBook log;
    write_text(fixture.path("file"), "");
    storage::FolderStorage file{fixture.path("file").string()};
    CHECK(CertificateStore{file, {}, log}.create().error() == status::Bad_ConfigurationError);
}

TEST_CASE("certificates and revocation lists are added, shown, moved and removed",
          "[crypto][store][unit:Security Certificate Administration]")
{
    StoreFixture fixture;
    const Issued root = issue(authority("root"), key_number(2));
    const Certificate press = named("Press 4");
    const auto list = revoke(root);
    const auto added = fixture.store.add(StoreList::Trusted, pem_of(press));
    REQUIRE(added);
    CHECK(added->file == "trusted/certs/Press 4 [" + press.thumbprint_text() + "].der");
    CHECK(added->subject == "CN=Press 4");
    CHECK(added->valid_to == in_days(100));
    REQUIRE(fixture.store.add(StoreList::Issuers, root.certificate.der()));
    REQUIRE(fixture.store.add(StoreList::Issuers, list.der()));
    CHECK(fs::exists(fixture.path("issuers/crl/root [" + list.thumbprint_text() + "].crl")));
    CHECK(fixture.in(StoreList::Trusted) == std::set{press.thumbprint_text()});
    CHECK(fixture.in(StoreList::Issuers) ==
          std::set{root.certificate.thumbprint_text(), list.thumbprint_text()});

    const std::string lower = [&] {
        std::string text = press.thumbprint_text();
        std::transform(text.begin(), text.end(), text.begin(), ::tolower);
        return text;
    }();
    REQUIRE(fixture.store.move(lower, StoreList::Trusted, StoreList::Rejected));
    CHECK(fixture.in(StoreList::Trusted).empty());
    CHECK(fixture.in(StoreList::Rejected) == std::set{press.thumbprint_text()});
    REQUIRE(fixture.store.move(list.thumbprint_text(), StoreList::Issuers, StoreList::Trusted));
    CHECK(fixture.count("trusted/crl") == 1);
    REQUIRE(fixture.store.remove(StoreList::Rejected, lower));
    CHECK(fixture.count("rejected/certs") == 0);
    CHECK(fixture.log.count("CN=Press 4, " + press.thumbprint_text()) == 3);
    CHECK(fixture.log.count("was moved from trusted to rejected") == 1);
}

TEST_CASE("operations say why they are refused", "[crypto][store]")
{
    StoreFixture fixture{crypto::nj501_store_limits()};
    const Certificate press = named("press");
    const auto status_of = [](const auto& result) {
        return result ? StatusCode{} : result.error().status;
    };
    REQUIRE(fixture.store.add(StoreList::Trusted, press.der()));
    CHECK(status_of(fixture.store.add(StoreList::Trusted, pem_of(press))) ==
          status::Bad_EntryExists);
    CHECK(status_of(fixture.store.add(StoreList::Own, named("own").der())) ==
          status::Bad_NotSupported);
    const auto half = press.der().first(press.der().size() / 2);
    CHECK(status_of(fixture.store.add(StoreList::Trusted, half)) == status::Bad_CertificateInvalid);
    auto two = pem_of(press);
    const auto second = pem_of(named("second"));
    two.insert(two.end(), second.begin(), second.end());
    CHECK(status_of(fixture.store.add(StoreList::Issuers, two)) == status::Bad_CertificateInvalid);
    CHECK(status_of(fixture.store.remove(StoreList::Issuers, press.thumbprint_text())) ==
          status::Bad_NotFound);
    CHECK(status_of(fixture.store.move("00", StoreList::Rejected, StoreList::Trusted)) ==
          status::Bad_NotFound);
    CHECK(status_of(fixture.store.show("../../etc/passwd")) == status::Bad_NotFound);

    for (std::size_t i = 1; i < 32; ++i) {
        REQUIRE(fixture.store.add(StoreList::Trusted, named("n").der()));
    }
    const Certificate last = named("last");
    const auto full = fixture.store.add(StoreList::Trusted, last.der());
    REQUIRE_FALSE(full);
    CHECK(full.error().status == status::Bad_ResourceUnavailable);
    CHECK(full.error().found.find("32 certificates") != std::string::npos);
    fixture.store.reject(last, now);
    CHECK(status_of(fixture.store.move(last.thumbprint_text(), StoreList::Rejected,
                                       StoreList::Trusted)) == status::Bad_ResourceUnavailable);
    CHECK(fixture.in(StoreList::Rejected) == std::set{last.thumbprint_text()});
}

TEST_CASE("what is in both lists leaves the one and stays in the other", "[crypto][store]")
{
    StoreFixture fixture;
    const Certificate press = named("press");
    fixture.put("trusted/certs/a.der", press.der());
    fixture.put("rejected/certs/b.pem", pem_of(press));
    fixture.put("rejected/certs/c.der", press.der());
    REQUIRE(fixture.store.move(press.thumbprint_text(), StoreList::Rejected, StoreList::Trusted));
    CHECK(fixture.count("rejected/certs") == 0);
    CHECK(fs::exists(fixture.path("trusted/certs/a.der")));
    CHECK(fixture.count("trusted/certs") == 1);
    // Removed is removed, in however many files it lies.
    fixture.put("trusted/certs/again.crt", pem_of(press));
    REQUIRE(fixture.store.remove(StoreList::Trusted, press.thumbprint_text()));
    CHECK(fixture.count("trusted/certs") == 0);
}

TEST_CASE("a moved file keeps its form and another one its place", "[crypto][store]")
{
    StoreFixture fixture;
    const Certificate press = named("press");
    const std::string target = "trusted/certs/press [" + press.thumbprint_text() + "]";
    fixture.put("rejected/certs/from a tool.pem", pem_of(press));
    REQUIRE(fixture.store.move(press.thumbprint_text(), StoreList::Rejected, StoreList::Trusted));
    CHECK(fs::exists(fixture.path(target + ".pem")));
    // Another certificate under that name is not lost; half a file is replaced.
    fixture.put("rejected/certs/x.pem", pem_of(press));
    fixture.put(target + ".pem", named("other").der());
    CHECK(fixture.store.move(press.thumbprint_text(), StoreList::Rejected, StoreList::Trusted)
              .error()
              .status == status::Bad_EntryExists);
    fixture.put(target + ".pem", press.der().first(100));
    REQUIRE(fixture.store.move(press.thumbprint_text(), StoreList::Rejected, StoreList::Trusted));
    CHECK(fixture.in(StoreList::Trusted) == std::set{press.thumbprint_text()});
}

TEST_CASE("names are harmless whatever a certificate says", "[crypto][store][hostile]")
{
    // tests/attacks.txt, G1.
    StoreFixture fixture;
    for (const std::string& name :
         {std::string{"../../../else/where"}, std::string{"/etc/passwd"}, std::string{"a\\b:c*d?"},
          std::string{"..."}, std::string{".hidden"}, std::string{"new\nline"},
          std::string{"nul\0byte", 8}, std::string{"\xC3\xA9\xE2\x82\xAC"}, std::string(64, '/')}) {
        const Certificate one = named(name);
        const auto added = fixture.store.add(StoreList::Trusted, one.der());
        REQUIRE(added);
        CHECK(fixture.in(StoreList::Trusted).count(one.thumbprint_text()) == 1);
        const fs::path file = fixture.path(added->file);
        CHECK(file.parent_path() == fixture.path("trusted/certs"));
        CHECK(file.filename().string().front() != '.');
        CHECK(fs::is_regular_file(file));
        CHECK(added->subject.find('\n') == std::string::npos);
    }
    CHECK(fixture.count("trusted/certs") == 9);
    CHECK(fixture.count("") == 4);
}

TEST_CASE("a certificate is shown line by line", "[crypto][store]")
{
    StoreFixture fixture;
    const Certificate press = named("press\nThumbprint: 00");
    const auto list = revoke(issue(authority("root"), key_number(2)), {{press}});
    REQUIRE(fixture.store.add(StoreList::Trusted, press.der()));
    REQUIRE(fixture.store.add(StoreList::Trusted, list.der()));
    const auto shown = fixture.store.show(press.thumbprint_text());
    REQUIRE(shown);
    for (const char* text :
         {"Subject:      CN=press", "Valid to:     2026-04-11", "Application:  urn:test:leaf\n",
          "Hosts:        plc.example, 192.0.2.7\n", "Key:          RSA, 2048 bits\n",
          "sha256WithRSAEncryption", "Digital Signature", "TLS Web Server Authentication",
          "Version:      3\n", "Public key:   308201",
          "Extension:    X509v3 Subject Alternative Name: URI:urn:test:leaf, DNS:plc.example"}) {
        INFO(*shown << " has no " << text);
        CHECK(shown->find(text) != std::string::npos);
    }
    std::istringstream lines{*shown};
    std::size_t named_lines = 0;
    for (std::string line; std::getline(lines, line);) {
        CHECK(line.find(':') != std::string::npos);
        named_lines += line.starts_with("Extension:") ? 0U : 1U;
    }
    CHECK(named_lines == 15);
    const auto revocations = fixture.store.show(list.thumbprint_text());
    REQUIRE(revocations);
    CHECK(revocations->find("Revoked:      1\n") != std::string::npos);
    CHECK(revocations->find("Next update:  2026-01-31") != std::string::npos);
    CHECK(revocations->find("Signature:    sha256WithRSAEncryption\n") != std::string::npos);
    const std::string serial = shown->substr(shown->find("Serial: "));
    CHECK(revocations->find(serial.substr(0, serial.find('\n')) + " since 20") !=
          std::string::npos);
    CHECK(fixture.path("trusted/crl/" + file_name_of(list)) ==
          fixture.path(fixture.store.list(StoreList::Trusted).back().file));
}

TEST_CASE("an older version's folders and another spelling are read", "[crypto][store]")
{
    StoreFixture fixture;
    const Certificate old = named("old");
    const Certificate stranger = named("stranger");
    const Issued root = issue(authority("root"), key_number(2));
    const Issued other = issue(authority("other"), key_number(3));
    const auto list = revoke(root);
    fs::create_directories(fixture.path("issuer/certs"));
    fs::create_directories(fixture.path("issuer/crl"));
    fixture.put("trusted/" + old.thumbprint_text() + ".der", old.der());
    fixture.put("rejected/" + stranger.thumbprint_text() + ".der", stranger.der());
    fixture.put("issuers/other.pem", pem_of(other.certificate));
    fixture.put("issuer/certs/root.der", root.certificate.der());
    fixture.put("issuer/crl/root.crl", list.der());
    const auto& trust = fixture.store.trust_list(long_after());
    CHECK(trust.trusted == std::vector{old});
    CHECK(trust.issuers == std::vector{other.certificate, root.certificate});
    CHECK(trust.issuer_crls == std::vector{list});
    // What lies there is within reach, and nothing is moved without being asked.
    REQUIRE(fixture.store.create());
    CHECK(fs::exists(fixture.path("trusted/" + old.thumbprint_text() + ".der")));
    REQUIRE(fixture.store.remove(StoreList::Trusted, old.thumbprint_text()));
    REQUIRE(
        fixture.store.move(stranger.thumbprint_text(), StoreList::Rejected, StoreList::Trusted));
    CHECK(fixture.store.trust_list(long_after()).trusted == std::vector{stranger});
    CHECK(fixture.count("trusted/certs") == 1);
    CHECK(fixture.log.count("cannot") == 0);
}

TEST_CASE("own certificates are listed and shown, with their chain behind them", "[crypto][store]")
{
    StoreFixture fixture;
    const Issued root = issue(authority("root"), key_number(2));
    const Issued leaf = issue({}, key_number(1), &root);
    auto chain = std::vector(leaf.certificate.der().begin(), leaf.certificate.der().end());
    chain.insert(chain.end(), root.certificate.der().begin(), root.certificate.der().end());
    fixture.put("own/certs/own.der", chain);
    CHECK(fixture.in(StoreList::Own) == std::set{leaf.certificate.thumbprint_text()});
    CHECK(fixture.store.show(leaf.certificate.thumbprint_text()));
    CHECK_FALSE(fixture.store.remove(StoreList::Own, leaf.certificate.thumbprint_text()));
    CHECK_FALSE(
        fixture.store.move(leaf.certificate.thumbprint_text(), StoreList::Own, StoreList::Trusted));
    // In a trust list it would not be clear which of them is trusted.
    fixture.put("trusted/certs/chain.der", chain);
    CHECK(fixture.store.trust_list(now).trusted.empty());
}

TEST_CASE("private keys are closed to others, and the operator hears of it", "[crypto][store]")
{
    StoreFixture fixture;
    REQUIRE(key_number(1).save(fixture.files, "own/private/own.pem"));
    REQUIRE(fixture.store.create());
    CHECK(fixture.log.lines.empty());
    fs::permissions(fixture.path("own/private/own.pem"), fs::perms{0640});
    fs::permissions(fixture.path("own/private"), fs::perms{0755});
    write_text(fixture.path("outside"), "");
    fs::permissions(fixture.path("outside"), fs::perms{0644});
    fs::create_symlink(fixture.path("outside"), fixture.path("own/private/link"));
    REQUIRE(fixture.store.create());
    CHECK(mode_of(fixture.path("own/private")) == 0700);
    CHECK(mode_of(fixture.path("own/private/own.pem")) == 0600);
    CHECK(mode_of(fixture.path("outside")) == 0644);
    CHECK(fixture.log.count("was open to other users") == 2);
    CHECK(fixture.log.count("own.pem") == 1);
    REQUIRE(fixture.store.create());
    CHECK(fixture.log.lines.size() == 2);
}

TEST_CASE("what a writer that died left is not read and goes", "[crypto][store]")
{
    StoreFixture fixture;
    const Certificate press = named("press");
    const std::string left = "trusted/certs/press.der.77-0.busbar-new";
    fixture.put(left, press.der());
    CHECK(fixture.store.trust_list(now).trusted.empty());
    CHECK(fixture.in(StoreList::Trusted).empty());
    fixture.put("own/private/own.pem.1-0.busbar-new", press.der());
    REQUIRE(fixture.store.create());
    CHECK(fixture.count("trusted/certs") == 0);
    CHECK(fixture.count("own/private") == 0);
}

} // namespace certificate_store_test
