#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <busbar/net/application.hpp>
#include <busbar/net/server_loop.hpp>

#include "support/identity.hpp"
#include "support/temporary_folder.hpp"

namespace application_test {

using namespace busbar;
using busbar::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

Configured<std::unique_ptr<net::Application>> open(const fs::path& folder, LogSink& log)
{
    return net::Application::open({"urn:example:app", "App", folder.string()}, log);
}

} // namespace

TEST_CASE("an application has one certificate and its names for servers and clients", "[net]")
{
    const TemporaryFolder folder;
    test::LogBook log;
    std::vector<std::string> certificates;
    for (int i = 0; i < 2; ++i) { // made, and then found
        const auto application = open(folder.path, log);
        REQUIRE(application);
        net::Application& app = **application;
        const auto client = app.client_config("opc.tcp://plc:4840");
        CHECK(client.endpoint_url == "opc.tcp://plc:4840");
        CHECK(client.application_uri == "urn:example:app");
        CHECK(client.application_name == "App");
        const channel::ChannelEnvironment& around = app.client_environment();
        REQUIRE(around.identity != nullptr);
        const auto server = app.server_config("opc.tcp://localhost:4840");
        REQUIRE(server.identity);
        REQUIRE(server.identity->certificates.size() == 1);
        CHECK(server.application_uri == "urn:example:app");
        certificates.push_back(server.identity->certificates[0].thumbprint_text());
        CHECK(around.identity->certificates[0].thumbprint_text() == certificates.back());
        CHECK(around.log == &log);
        CHECK(around.wall_clock == &app.wall_clock());
        CHECK(around.random == &app.random());
        CHECK(app.certificates().list(crypto::StoreList::Trusted).empty()); // nobody, at first
    }
    CHECK(certificates[0] == certificates[1]);
}

TEST_CASE("an application says what is wrong with its folder", "[net]")
{
    const TemporaryFolder folder;
    test::LogBook log;
    SECTION("it cannot be made")
    {
        std::ofstream{folder.path / "file"} << "no folder\n";
        const auto application = open(folder.path / "file", log);
        REQUIRE_FALSE(application);
        CHECK(application.error().where ==
              "certificate folder \"" + (folder.path / "file").string() + "\"");
        CHECK(application.error().text.find("Make it writable for this user") != std::string::npos);
    }
    SECTION("what is in it is no certificate")
    {
        REQUIRE(open(folder.path, log));
        int spoiled = 0;
        for (const auto& entry : fs::recursive_directory_iterator{folder.path / "own"}) {
            if (entry.is_regular_file()) {
                std::ofstream{entry.path(), std::ios::trunc} << "spoiled";
                ++spoiled;
            }
        }
        CHECK(spoiled >= 2);
        const auto application = open(folder.path, log);
        REQUIRE_FALSE(application);
        CHECK(text(application.error()).find("own") != std::string::npos);
    }
}

} // namespace application_test
