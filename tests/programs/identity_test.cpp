#include <catch2/catch.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/storage.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/access/identity.hpp"
#include "product/configuration/addresses.hpp"
#include "product/configuration/config.hpp"
#include "support/identity.hpp"
#include "support/temporary_folder.hpp"

namespace identity_test {

using namespace busbar;

namespace {

void put(Storage& files, const char* name, std::span<const std::byte> bytes)
{
    REQUIRE(files.replace(name, bytes, FileAccess::Owner));
}

} // namespace

TEST_CASE("identity: a change of certificate that was decided when the power went is in force")
{
    const test::TemporaryFolder folder;
    product::CertificateConfig config;
    config.folder = folder.path.string();
    const std::string uri = "urn:busbar:test:server";
    const auto load = [&] {
        test::LogBook log;
        return product::load_identity(config, "server", uri, {}, test::today, log)
            .certificates.front()
            .thumbprint_text();
    };
    const std::string before = load();
    const channel::ApplicationIdentity& next = test::server_identity();
    storage::FolderStorage files{config.folder};
    REQUIRE(files.make_folder("transaction", FileAccess::Owner));
    put(files, "transaction/0.new", next.key.to_pem()->span());
    put(files, "transaction/1.new", next.certificates.front().der());
    constexpr std::string_view journal =
        R"([{"name":"own/private/pending.pem","staged":"transaction/0.new"},)"
        R"({"name":"own/certs/own.der","staged":"transaction/1.new"}])";
    CHECK(load() == before); // not decided, and forgotten
    put(files, "transaction/0.new", next.key.to_pem()->span());
    put(files, "transaction/1.new", next.certificates.front().der());
    put(files, "transaction/journal.json", std::as_bytes(std::span{journal}));
    CHECK(load() == next.certificates.front().thumbprint_text());
    CHECK_FALSE(files.entry("transaction/journal.json"));
}

TEST_CASE("identity: a preset's certificate has the subject of its product (3-2-4, 5-1-1)")
{
    const test::TemporaryFolder folder;
    const auto made = [&](const std::string& text) {
        const auto config = product::parse_config(
            "certificates.folder = \"" + folder.path.string() + "\"\n" + text, "file");
        return product::regenerate_certificate(config.certificates, "Press", "urn:press",
                                               {"press-4", "127.0.0.1", "192.168.250.1"},
                                               test::today);
    };
    const auto nj501 = made("[limits]\npreset = \"nj501\"\n");
    CHECK(nj501.subject() ==
          "CN=NxOpcUaServer@192.168.250.1, O=Omron Corporation, L=Kyoto, ST=Kyoto, C=JP");
    CHECK(to_string(nj501.valid_to()) == "2046-01-01T00:00:00Z"); // twenty years
    CHECK(nj501.host_names() == std::vector<std::string>{"press-4", "127.0.0.1", "192.168.250.1"});
    const std::string others = "certificates.common_name = \"A {address}\"\n"
                               "certificates.locality = \"Linz\"\ncertificates.state = \"\"\n"
                               "certificates.country = \"AT\"\n";
    CHECK(made(others + "[limits]\npreset = \"nx102\"\n").subject() ==
          "CN=A 192.168.250.1, O=Omron Corporation, L=Linz, C=AT");
    CHECK(made("").subject() == "CN=Press, O=Busbar");
    CHECK_THROWS_WITH(made("certificates.country = \"Japan\"\n"),
                      Catch::Contains("country: found 'Japan', expected at most 2 bytes"));
    CHECK_THROWS_WITH(made("certificates.country = \"J\"\n"),
                      Catch::Contains("country: found 'J', expected two letters"));
}

TEST_CASE("identity: the address of hosts is one that other machines may use")
{
    using product::address_of;
    CHECK(address_of({"press", "127.0.0.1", "::1", "2001:db8::7", "192.0.2.1"}) == "2001:db8::7");
    CHECK(address_of({"press", "127.0.0.1"}) == "127.0.0.1");
    CHECK(address_of({"press", "press.example"}) == "press");
    CHECK(address_of({}).empty());
}

} // namespace identity_test
