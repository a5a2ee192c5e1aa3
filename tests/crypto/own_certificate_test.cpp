#include <algorithm>
#include <map>

#include <catch2/catch.hpp>
#include <openssl/rsa.h>
#include <openssl/x509.h>

#include <busbar/core/record.hpp>

#include "hex.hpp"
#include "own_store.hpp"
#include "status_text.hpp"

namespace own_certificate_test {

using namespace busbar;
using namespace busbar::test;

namespace {

/// An RSA key of 1024 bits, which PrivateKey does not make.
crypto::PrivateKey weak_key()
{
    EVP_PKEY* key = EVP_RSA_gen(1024);
    unsigned char* der = nullptr;
    const int size = i2d_PrivateKey(key, &der);
    auto result =
        crypto::PrivateKey::parse(std::as_bytes(std::span{der, static_cast<std::size_t>(size)}));
    OPENSSL_free(der);
    EVP_PKEY_free(key);
    return *result;
}

class NewCertificateEar final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view text) override { line = text; }
    bool wants(RecordKind kind) const override { return kind == RecordKind::CertificateUpdated; }
    void record(const Record& record) override
    {
        CHECK_FALSE(record.status.is_bad());
        told.push_back(crypto::Certificate::parse(record.certificate).value());
    }

    std::string line;
    std::vector<crypto::Certificate> told;
};

/// All files below, by name and contents.
std::string listing(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator{folder}) {
        if (entry.is_regular_file()) {
            files[entry.path().string()] = read(entry.path());
        }
    }
    std::string text;
    for (const auto& [name, contents] : files) {
        text += name + "\n" + contents + "\n";
    }
    return text;
}

/// The refusal, which must have left everything as it was.
template <typename Call>
Refusal refused(const Store& store, Call call)
{
    const std::string before = listing(store.folder.path);
    const auto result = call();
    REQUIRE_FALSE(result);
    CHECK(listing(store.folder.path) == before);
    CHECK_FALSE(text(result.error()).empty());
    return result.error();
}

} // namespace

TEST_CASE("a missing certificate is made, and used from then on",
          "[crypto][own][unit:Security Default ApplicationInstance Certificate]")
{
    const Store store;
    CHECK_FALSE(store.store.load(uri)->has_value());
    const OwnCertificate made = store.start();
    const crypto::Certificate& certificate = made.certificates.front();
    CHECK(certificate.subject() == "CN=Line 3, O=Works");
    CHECK(certificate.application_uri() == uri);
    CHECK(certificate.host_names() == std::vector<std::string>{"plc.example", "192.0.2.7"});
    CHECK(certificate.key_bits() == 2048);
    CHECK(certificate.valid_from() == in_days(-1));
    CHECK(certificate.valid_to() == in_days(20 * 365 + 5));
    CHECK(to_string(certificate.valid_to()) == "2046-01-01T00:00:00Z");
    CHECK(made.key.belongs_to(certificate));

    CHECK(is_same(store.start(), made));
    CHECK(is_same(**store.store.load(uri), made));
    CHECK(mode_of(store.key()) == 0600);
    CHECK(mode_of(store.key().parent_path()) == 0700);
    CHECK(mode_of(store.replaced()) == 0700);
    CHECK_FALSE(fs::exists(store.pending()));
    CHECK(read(store.certificate()) == text_of(certificate.der()));
}

TEST_CASE("a certificate that is put in force is told as a renewal is", "[crypto][own]")
{
    const Store store;
    NewCertificateEar ear;
    const OwnCertificateStore told{*store.files, &ear};
    const auto made = told.load_or_create(settings(), now);
    REQUIRE(made);
    CHECK(ear.told == std::vector{made->certificates.front()});
    CHECK(ear.line.find("CN=Line 3, O=Works") != std::string::npos);
    CHECK(ear.line.find(made->certificates.front().thumbprint_text()) != std::string::npos);
    REQUIRE(told.load_or_create(settings(), now)); // it is there
    CHECK(ear.told.size() == 1);
    const auto second = told.regenerate(settings(), now);
    REQUIRE(second);
    CHECK(ear.told.back() == second->certificates.front());
    REQUIRE(told.install(*made, uri));
    REQUIRE(ear.told.size() == 3);
    CHECK(ear.told.back() == made->certificates.front());
    OwnCertificateSettings wrong = settings();
    wrong.subject.common_name.clear();
    CHECK_FALSE(told.regenerate(wrong, now));
    CHECK(ear.told.size() == 3);
}

TEST_CASE("keys have the configured size", "[crypto][own]")
{
    const Store store;
    OwnCertificateSettings wanted = settings();
    wanted.key_bits = 3072;
    CHECK(store.store.load_or_create(wanted, now)->certificates.front().key_bits() == 3072);
    for (const std::uint32_t bits : {0U, 1024U, 4097U}) {
        wanted.key_bits = bits;
        const auto refusal = refused(store, [&] { return store.store.regenerate(wanted, now); });
        CHECK(refusal.status == status::Bad_InvalidArgument);
    }
}

TEST_CASE("what cannot stand in a certificate changes nothing", "[crypto][own]")
{
    const Store store;
    const OwnCertificate made = store.start();
    const auto refuses = [&](auto change) {
        OwnCertificateSettings wrong = settings();
        change(wrong.subject);
        refused(store, [&] { return store.store.regenerate(wrong, now); });
        return refused(store, [&] {
                   return store.store.create_signing_request(wrong, RequestKey::New);
               }).status == status::Bad_InvalidArgument;
    };
    CHECK(refuses([](auto& subject) { subject.common_name.clear(); }));
    CHECK(refuses([](auto& subject) { subject.country = "Japan"; }));
    CHECK(refuses([](auto& subject) { subject.ip_addresses = {"the other one"}; }));
    CHECK(refuses([](auto& subject) { subject.application_uri = "urn:a,DNS:b"; }));
    OwnCertificateSettings wrong = settings();
    wrong.subject.valid_days = 0;
    refused(store, [&] { return store.store.regenerate(wrong, now); });
    CHECK(is_same(store.start(), made));
}

TEST_CASE("a certificate is made anew with chosen subject and validity", "[crypto][own]")
{
    const Store store;
    const OwnCertificate first = store.start();
    OwnCertificateSettings wanted = settings();
    wanted.subject.common_name = "Line 4";
    wanted.subject.organizational_unit = "Paint";
    wanted.subject.locality = "Graz";
    wanted.subject.state = "Styria";
    wanted.subject.country = "AT";
    wanted.subject.domain_component = "plc";
    wanted.subject.valid_days = 365;
    const auto second = store.store.regenerate(wanted, in_days(10));
    REQUIRE(second);
    const crypto::Certificate& certificate = second->certificates.front();
    CHECK(certificate.subject() == "CN=Line 4, O=Works, OU=Paint, L=Graz, ST=Styria, C=AT, DC=plc");
    CHECK(certificate.valid_to() == in_days(375));
    CHECK_FALSE(first.key.belongs_to(certificate));
    CHECK(is_same(**store.store.load(uri), *second));

    // The old pair lies where an operator finds it.
    const std::string name = first.certificates.front().thumbprint_text();
    CHECK(read(store.replaced() / (name + ".der")) == text_of(first.certificates.front().der()));
    CHECK(read(store.replaced() / (name + ".pem")) == first.key.to_pem()->text());
    CHECK(mode_of(store.replaced() / (name + ".pem")) == 0600);
}

TEST_CASE("what others put there is read as PEM or DER", "[crypto][own]")
{
    const Issued issued = issue({}, key_number(1), &ca());
    for (const bool is_pem : {true, false}) {
        const Store store;
        const auto certificate = is_pem
                                     ? joined(pem_of(issued.certificate), pem_of(ca().certificate))
                                     : copy_of(issued.certificate.der());
        write(store.certificate(), text_of(certificate));
        write(store.key(), is_pem ? std::string{issued.key.to_pem()->text()}
                                  : text_of(plain_der_key(issued.key)));
        const auto loaded = store.store.load(uri);
        REQUIRE(loaded);
        REQUIRE(loaded->has_value());
        CHECK((*loaded)->certificates.size() == (is_pem ? 2 : 1));
        CHECK((*loaded)->certificates.front() == issued.certificate);
    }
}

TEST_CASE("what is damaged or does not fit is refused and left alone", "[crypto][own][hostile]")
{
    const Issued issued = issue({}, key_number(1));
    const auto explain = [](const Store& store) {
        const auto load = refused(store, [&] { return store.store.load(uri); });
        const auto start =
            refused(store, [&] { return store.store.load_or_create(settings(), now); });
        CHECK(text(start) == text(load));
        return text(load);
    };
    const auto has = [](const std::string& line, const std::string& part) {
        return line.find(part) != std::string::npos;
    };
    const Store store;
    store.put(issued);
    REQUIRE(store.store.load(uri));

    const std::string der = read(store.certificate());
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, der.size() - 1}) {
        write(store.certificate(), std::string_view{der}.substr(0, size));
        CHECK(has(explain(store), store.certificate().string() + " cannot be read"));
    }
    write(store.certificate(), std::string(200'000, 'x'));
    CHECK(has(explain(store), "cannot be read"));
    write(store.certificate(), der);

    const std::string pem = read(store.key());
    for (const std::size_t size : {std::size_t{0}, pem.size() / 2}) {
        write(store.key(), std::string_view{pem}.substr(0, size));
        CHECK(has(explain(store), store.key().string() + " cannot be read"));
    }
    write(store.key(), text_of(encrypted_key(issued.key, "a pass phrase", true)));
    CHECK(has(explain(store), "without passphrase"));
    write(store.key(), key_number(2).to_pem()->text());
    CHECK(has(explain(store), "is not that of the certificate"));

    fs::remove(store.key());
    CHECK(has(explain(store), "not its key, " + store.key().string()));
    write(store.key(), pem);
    fs::remove(store.certificate());
    CHECK(has(explain(store), "not its certificate, " + store.certificate().string()));
    fs::remove(store.key());
    write(store.folder.path / "own/certs/plc.der", der);
    CHECK(has(explain(store), "found " + (store.folder.path / "own/certs/plc.der").string()));
    fs::remove(store.folder.path / "own/certs/plc.der");
    write(store.pending(), "half a ke");
    CHECK(has(text(refused(store, [&] { return store.store.load_or_create(settings(), now); })),
              store.pending().string() + " cannot be read"));
}

TEST_CASE("a certificate of another ApplicationUri or key size is refused",
          "[crypto][own][hostile]")
{
    const Store store;
    store.put(issue({}, key_number(1)));
    const auto other = refused(store, [&] { return store.store.load("urn:test:other"); });
    CHECK(other.status == status::Bad_CertificateUriInvalid);
    CHECK(other.found.find("urn:test:leaf") != std::string::npos);
    CHECK(other.found.find("urn:test:other") != std::string::npos);
    CHECK_FALSE(other.thumbprint.empty());
    CertificateOptions two;
    two.names = "URI:urn:test:first,URI:urn:test:second";
    store.put(issue(two, key_number(1)));
    CHECK(refused(store, [&] { return store.store.load(uri); }).status ==
          status::Bad_CertificateUriInvalid);
    CHECK(store.store.load("urn:test:second"));
    store.put(issue({}, weak_key()));
    CHECK(refused(store, [&] { return store.store.load(uri); }).status ==
          status::Bad_CertificatePolicyCheckFailed);
}

TEST_CASE("making anew repairs what is broken and loses nothing", "[crypto][own]")
{
    const Store store;
    write(store.certificate(), "not a certificate");
    write(store.key(), "not a key");
    const auto made = store.store.regenerate(settings(), now);
    REQUIRE(made);
    CHECK(is_same(store.start(), *made));
    const auto kept = [&](std::string_view contents) {
        const auto entries = fs::directory_iterator{store.replaced()};
        return std::count_if(begin(entries), end(entries),
                             [&](const auto& entry) { return read(entry.path()) == contents; });
    };
    CHECK(kept("not a certificate") == 1);
    CHECK(kept("not a key") == 1);
    // The same certificate with two keys: both stay.
    write(store.certificate(), "not a certificate");
    write(store.key(), "nor this");
    REQUIRE(store.store.regenerate(settings(), now));
    CHECK(kept("not a certificate") == 1);
    CHECK(kept("not a key") == 1);
    CHECK(kept("nor this") == 1);
}

TEST_CASE("the certificate of a request takes the place of the old one", "[crypto][own]")
{
    const Store store;
    const OwnCertificate first = store.start();
    REQUIRE(store.store.create_signing_request(settings(), RequestKey::New));
    CHECK(mode_of(store.pending()) == 0600);
    CHECK(is_same(store.start(), first)); // nothing has changed yet

    const auto issued = store.issue_pending(ca());
    const auto bundle = joined(pem_of(ca().certificate), pem_of(issued)); // the CA first
    const auto taken = store.store.take_in(bundle, uri);
    REQUIRE(taken);
    CHECK(taken->certificates == crypto::CertificateChain{issued, ca().certificate});
    CHECK(taken->key.belongs_to(issued));
    CHECK(is_same(store.start(), *taken));
    CHECK_FALSE(fs::exists(store.pending()));
    CHECK(fs::exists(store.replaced() / (first.certificates.front().thumbprint_text() + ".pem")));

    // A renewal with the same key.
    REQUIRE(store.store.create_signing_request(settings(), RequestKey::Present));
    CHECK_FALSE(fs::exists(store.pending()));
    const auto renewed = issue({}, taken->key, &ca()).certificate;
    REQUIRE(store.store.take_in(renewed.der(), uri));
    CHECK(store.start().certificates == crypto::CertificateChain{renewed});
    CHECK(fs::exists(store.replaced() / (issued.thumbprint_text() + ".der")));
}

TEST_CASE("a request is made before its key is kept", "[crypto][own]")
{
    const Store store;
    CHECK(store.start().key.belongs_to(store.start().certificates.front()));
    REQUIRE(store.store.create_signing_request(settings(), RequestKey::New));
    const std::string before = read(store.pending());
    const auto made = store.store.make_signing_request(settings(), RequestKey::New);
    REQUIRE(made);
    REQUIRE(made->new_key);
    CHECK_FALSE(made->request.empty());
    CHECK(read(store.pending()) == before);
    REQUIRE(store.store.keep_request_key(*made->new_key));
    CHECK(read(store.pending()) != before);
    CHECK(mode_of(store.pending()) == 0600);
    const auto present = store.store.make_signing_request(settings(), RequestKey::Present);
    REQUIRE(present);
    CHECK_FALSE(present->new_key);
}

TEST_CASE("a request can come before the first certificate", "[crypto][own]")
{
    const Store store;
    CHECK_FALSE(store.store.create_signing_request(settings(), RequestKey::Present));
    REQUIRE(store.store.create_signing_request(settings(), RequestKey::New));
    const auto issued = store.issue_pending(ca());
    SECTION("and be answered before it")
    {
        CHECK(store.store.take_in(issued.der(), uri)->certificates.front() == issued);
    }
    SECTION("and after it: the certificate in between has the same key")
    {
        CHECK(store.start().key.belongs_to(issued));
        CHECK(store.store.take_in(issued.der(), uri)->certificates.front() == issued);
    }
    CHECK(store.start().certificates.front() == issued);
}

TEST_CASE("a certificate that does not belong here is not taken in", "[crypto][own][hostile]")
{
    const Store store;
    const OwnCertificate first = store.start();
    REQUIRE(store.store.create_signing_request(settings(), RequestKey::New));
    const auto refuses = [&](std::span<const std::byte> bytes) {
        return refused(store, [&] { return store.store.take_in(bytes, uri); });
    };
    const auto stranger = refuses(issue({}, key_number(3), &ca()).certificate.der());
    CHECK(stranger.status == status::Bad_CertificateInvalid);
    CHECK(stranger.found.find("neither") != std::string::npos);
    CHECK_FALSE(stranger.thumbprint.empty());

    CertificateOptions other;
    other.names = "URI:urn:test:other";
    CHECK(refuses(store.issue_pending(ca(), other).der()).status ==
          status::Bad_CertificateUriInvalid);
    other.names.clear();
    CHECK(refuses(store.issue_pending(ca(), other).der()).status ==
          status::Bad_CertificateUriInvalid);

    const auto der = copy_of(store.issue_pending(ca()).der());
    refuses({});
    refuses(std::span{der}.first(der.size() - 1));
    refuses(from_text("-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n"));
    refuses(std::vector<std::byte>(200'000));
    std::vector<std::byte> many;
    for (std::size_t i = 0; i <= crypto::max_chain_length; ++i) {
        many = joined(many, pem_of(ca().certificate));
    }
    refuses(many);
    // A later request makes an earlier one void (Part 12, 7.10.10).
    REQUIRE(store.store.create_signing_request(settings(), RequestKey::New));
    refuses(der);
    CHECK(is_same(store.start(), first));
}

TEST_CASE("a certificate and key from elsewhere are installed",
          "[crypto][own][unit:Security Certificate Administration]")
{
    const Store store;
    const OwnCertificate first = store.start();
    const Issued issued = issue({}, key_number(1), &ca());
    const OwnCertificate mixed{{ca().certificate, issued.certificate}, issued.key};
    const auto installed = store.store.install(mixed, uri);
    REQUIRE(installed);
    CHECK(installed->certificates ==
          crypto::CertificateChain{issued.certificate, ca().certificate});
    CHECK(is_same(store.start(), *installed));
    refused(store, [&] { return store.store.install(first, "urn:test:other"); });
    refused(store, [&] { return store.store.install({{ca().certificate}, issued.key}, uri); });
    refused(store, [&] { return store.store.install({{}, issued.key}, uri); });
}

} // namespace own_certificate_test
