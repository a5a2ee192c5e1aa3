#include <filesystem>
#include <fstream>
#include <iterator>

#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "hex.hpp"
#include "issuing.hpp"
#include "status_text.hpp"
#include "support/effort.hpp"
#include "support/kept_keys.hpp"

namespace private_key_test {

using namespace busbar;
using namespace busbar::test;
using crypto::CertificateSubject;
using crypto::create_self_signed;
using crypto::PrivateKey;
namespace fs = std::filesystem;

namespace {

/// A folder of this test's own, removed at its end.
class Folder {
public:
    Folder()
    {
        std::string name = (fs::temp_directory_path() / "busbar-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        path = name;
    }
    ~Folder()
    {
        std::error_code error;
        fs::remove_all(path, error);
    }

    fs::path path;
};

unsigned mode_of(const fs::path& file)
{
    struct ::stat facts {};
    REQUIRE(::stat(file.c_str(), &facts) == 0);
    return static_cast<unsigned>(facts.st_mode) & 07777U;
}

std::string read(const fs::path& file)
{
    std::ifstream stream{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

std::size_t count_files(const fs::path& folder)
{
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator{folder}, fs::directory_iterator{}));
}

bool is_same(const PrivateKey& a, const PrivateKey& b)
{
    return a.to_pem()->text() == b.to_pem()->text();
}

CertificateSubject subject()
{
    return {.common_name = "Busbar @ press 4",
            .organization = "Works",
            .application_uri = "urn:press-4:busbar",
            .dns_names = {"press-4", "press-4.example"},
            .ip_addresses = {"192.0.2.7", "2001:db8::7"},
            .valid_from = in_days(-1),
            .valid_days = 30};
}

} // namespace

TEST_CASE("a host is a name or an address")
{
    crypto::CertificateSubject subject;
    for (const char* host : {"press-4", "192.0.2.7", "4.example", "2001:db8::7"}) {
        crypto::add_host(subject, host);
    }
    CHECK(subject.dns_names == std::vector<std::string>{"press-4", "4.example"});
    CHECK(subject.ip_addresses == std::vector<std::string>{"192.0.2.7", "2001:db8::7"});
}

TEST_CASE("keys of the usual sizes are made", "[crypto][key][unit:CertificateKeyAlgorithm_RSA]")
{
    for (const std::uint32_t bits : {2048U, 3072U, 4096U}) {
        CHECK(key_number(1, bits).key_size() == bits / 8);
    }
    for (const std::uint32_t bits : {0U, 1024U, 2047U, 4097U, 0xFFFF'FFFFU}) {
        CHECK(PrivateKey::generate(bits).error() == status::Bad_InvalidArgument);
    }
}

TEST_CASE("each key that is made is another", "[crypto][key][unit:CertificateKeyAlgorithm_RSA]")
{
    const RealKeys real;
    const auto first = PrivateKey::generate(2048);
    const auto second = PrivateKey::generate(2048);
    REQUIRE(first);
    REQUIRE(second);
    CHECK(first->key_size() == 256);
    CHECK_FALSE(is_same(*first, *second));
    CHECK_FALSE(is_same(*first, key_number(1)));
}

TEST_CASE("keys are read in every usual form", "[crypto][key]")
{
    const PrivateKey& key = key_number(1);
    const auto pem = key.to_pem();
    REQUIRE(pem);
    CHECK(pem->text().rfind("-----BEGIN PRIVATE KEY-----", 0) == 0);
    for (const auto& contents : {copy_of(pem->span()), plain_der_key(key)}) {
        const auto back = PrivateKey::parse(contents);
        REQUIRE(back);
        CHECK(is_same(*back, key));
        CHECK(PrivateKey::parse(contents, "not needed"));
    }
    for (const bool as_pem : {true, false}) {
        const auto contents = encrypted_key(key, "a pass phrase", as_pem);
        const auto back = PrivateKey::parse(contents, "a pass phrase");
        REQUIRE(back);
        CHECK(is_same(*back, key));
        CHECK(PrivateKey::parse(contents, "another").error() == status::Bad_ConfigurationError);
        CHECK(PrivateKey::parse(contents).error() == status::Bad_ConfigurationError);
        CHECK_FALSE(PrivateKey::parse(contents, std::string(100'000, 'x')));
    }
}

TEST_CASE("what is no key is not read", "[crypto][key][hostile]")
{
    const auto pem = copy_of(key_number(1).to_pem()->span());
    const auto der = plain_der_key(key_number(1));
    // libcrypto tries all formats that it knows for milliseconds: a fourth a day.
    const std::size_t parts = is_full_effort() ? 1 : 4;
    const std::size_t part = part_of_round("no key", parts);
    for (std::size_t size = 7 * part; size < der.size(); size += 7 * parts) {
        CHECK_FALSE(PrivateKey::parse(std::span{der}.first(size)));
        CHECK_FALSE(PrivateKey::parse(std::span{pem}.first(size)));
    }
    CHECK_FALSE(PrivateKey::parse(std::span{der}.first(0)));
    CHECK_FALSE(PrivateKey::parse(std::span{der}.first(der.size() - 1)));
    for (std::size_t at = part; at < der.size(); at += parts) {
        auto changed = der;
        changed[at] ^= std::byte{0x80};
        static_cast<void>(PrivateKey::parse(changed));
    }
    CHECK_FALSE(PrivateKey::parse(from_text("no key")));
    CHECK_FALSE(PrivateKey::parse(pem_of(issue({}, key_number(1)).certificate)));
}

TEST_CASE("a saved key is its owner's alone", "[crypto][key]")
{
    const Folder folder;
    const fs::path file = folder.path / "own.pem";
    const ::mode_t before = ::umask(0);
    storage::FolderStorage files{folder.path.string()};
    REQUIRE(key_number(1).save(files, "own.pem"));
    CHECK(mode_of(file) == 0600);
    // Also where a file that everybody may read was before.
    fs::permissions(file, fs::perms::all);
    REQUIRE(key_number(2).save(files, "own.pem"));
    CHECK(mode_of(file) == 0600);
    ::umask(before);
    CHECK(count_files(folder.path) == 1);
    const std::string text = read(file);
    CHECK(is_same(*PrivateKey::parse(std::as_bytes(std::span{text})), key_number(2)));
}

TEST_CASE("a key knows its certificate", "[crypto][key]")
{
    const Issued mine = issue({}, key_number(1));
    CHECK(mine.key.belongs_to(mine.certificate));
    CHECK_FALSE(key_number(2).belongs_to(mine.certificate));
    CHECK_FALSE(key_number(1, 3072).belongs_to(mine.certificate));
}

TEST_CASE("a self-signed certificate is what Part 6, 6.2.2 asks for", "[crypto][certificate]")
{
    const auto made = create_self_signed(key_number(1), subject());
    REQUIRE(made);
    CHECK(made->subject() == "CN=Busbar @ press 4, O=Works");
    CHECK(made->application_uri() == "urn:press-4:busbar");
    CHECK(made->host_names() ==
          std::vector<std::string>{"press-4", "press-4.example", "192.0.2.7",
                                   "2001:0db8:0000:0000:0000:0000:0000:0007"});
    CHECK(made->valid_from() == in_days(-1));
    CHECK(made->valid_to() == in_days(29));
    CHECK(key_number(1).belongs_to(*made));
    for (const auto& policy : crypto::security_policies()) {
        for (const char* host : {"press-4", "PRESS-4.example", "192.0.2.7", "2001:db8::7"}) {
            CHECK(check_certificate(*made, {&policy, now, "urn:press-4:busbar", host}));
        }
    }
    // Two of the same are two.
    CHECK_FALSE(*create_self_signed(key_number(1), subject()) == *made);
}

TEST_CASE("what cannot stand in a certificate is refused", "[crypto][certificate]")
{
    const auto refuses = [](auto change) {
        CertificateSubject wrong = subject();
        change(wrong);
        const auto made = create_self_signed(key_number(1), wrong);
        return !made && made.error() == status::Bad_InvalidArgument;
    };
    CHECK(refuses([](auto& s) { s.common_name.clear(); }));
    CHECK(refuses([](auto& s) { s.common_name = std::string(65, 'x'); }));
    CHECK(refuses([](auto& s) { s.application_uri.clear(); }));
    CHECK(refuses([](auto& s) { s.application_uri = "urn:a,DNS:evil"; }));
    CHECK(refuses([](auto& s) { s.application_uri = "urn:a\nDNS:evil"; }));
    CHECK(refuses([](auto& s) { s.dns_names = {"a,URI:urn:b"}; }));
    CHECK(refuses([](auto& s) { s.dns_names = {""}; }));
    CHECK(refuses([](auto& s) { s.ip_addresses = {"not an address"}; }));
    CHECK(refuses([](auto& s) { s.ip_addresses = {"256.1.1.1"}; }));
    CHECK(refuses([](auto& s) { s.ip_addresses = {""}; }));
    CHECK(refuses([](auto& s) { s.valid_from = {}; }));
    CHECK(refuses([](auto& s) { s.valid_days = 0; }));
    CHECK(refuses([](auto& s) { s.valid_days = 0xFFFF'FFFF; }));
}

} // namespace private_key_test
