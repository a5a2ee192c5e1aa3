#include <catch2/catch.hpp>

#include <span>
#include <string>
#include <string_view>

#include <busbar/core/storage.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "identity.hpp"
#include "support/identity.hpp"
#include "support/temporary_folder.hpp"

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
    example::CertificateConfig config;
    config.folder = folder.path.string();
    const std::string uri = "urn:busbar:test:server";
    const auto load = [&] {
        return example::load_identity(config, "server", uri, {}, test::today)
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
