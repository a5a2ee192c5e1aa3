#include <catch2/catch.hpp>

#include <fstream>
#include <iterator>
#include <string>

#include "config.hpp"

using namespace busbar;
using example::Access;
using example::ConfigError;
using example::ControllerConfig;

namespace {

ControllerConfig parse(const std::string& text)
{
    return example::parse_config(text, "plant.toml");
}

/// What the operator reads of a configuration that is wrong.
std::string complaint(const std::string& text)
{
    try {
        static_cast<void>(parse(text));
    } catch (const ConfigError& error) {
        return error.what();
    }
    return "nothing";
}

std::string example_file(const std::string& name)
{
    std::ifstream file{std::string{BUSBAR_SOURCE_DIR} + "/examples/controller/" + name};
    return {std::istreambuf_iterator<char>{file}, {}};
}

} // namespace

TEST_CASE("the configuration that programs have built in refuses what is insecure")
{
    const ControllerConfig config = parse(example_file("controller.toml"));
    REQUIRE(config.server.endpoints.size() == 2);
    for (const server::EndpointConfig& endpoint : config.server.endpoints) {
        CHECK_FALSE(endpoint.security.policy->is_none());
        CHECK_FALSE(endpoint.allows_anonymous);
    }
    CHECK_FALSE(config.certificates.trusts_all_clients);
    CHECK_FALSE(config.users.anonymous);
    CHECK_FALSE(config.users.certified);
    CHECK(config.key_log.empty());
    CHECK(config.certificates.valid_days == 7'305); // 20 years
}

TEST_CASE("an empty file is as secure")
{
    const ControllerConfig config = parse("");
    CHECK(config.server.endpoints.size() == 2);
    CHECK_FALSE(config.users.anonymous);
    CHECK_FALSE(config.certificates.trusts_all_clients);
}

TEST_CASE("the demo is on this machine only")
{
    CHECK(parse(example_file("demo.toml")).address == "127.0.0.1");
}

TEST_CASE("certificates and users are configured")
{
    const ControllerConfig config = parse(R"(
[certificates]
folder = "pki"
key_bits = 3072
valid_days = 30
limits = "nj501"
suppress = ["find revocation list", "validity period"]
[[endpoint]]
policy = "Aes256_Sha256_RsaPss"
[users]
anonymous = "read"
certificates = "write"
)");
    CHECK(config.certificates.folder == "pki");
    CHECK(config.certificates.key_bits == 3072);
    CHECK(config.certificates.valid_days == 30);
    CHECK(config.certificates.limits.max_rejected == 32);
    CHECK(config.certificates.validation.suppress_find_revocation_list);
    CHECK(config.certificates.validation.suppress_validity_period);
    CHECK_FALSE(config.certificates.validation.suppress_host_name);
    CHECK(config.users.anonymous == Access::Read);
    CHECK(config.users.certified == Access::Write);
    REQUIRE(config.server.endpoints.size() == 1);
    CHECK(config.server.endpoints[0].allows_certificate);
    CHECK_FALSE(config.server.endpoints[0].allows_user_name);
    CHECK_FALSE(config.server.endpoints[0].allows_issued);
}

TEST_CASE("clients that the server connects to are configured")
{
    CHECK(parse("").reverse_urls.empty());
    const ControllerConfig config = parse(R"(
[reverse_connect]
urls = ["opc.tcp://scada:4841", "opc.tcp://[::1]:4842"]
)");
    CHECK(config.reverse_urls ==
          std::vector<std::string>{"opc.tcp://scada:4841", "opc.tcp://[::1]:4842"});
}

TEST_CASE("a discovery server is configured")
{
    for (const std::string& none :
         {std::string{}, example_file("controller.toml"), std::string{"[discovery]\nurl = \"\""}}) {
        const auto discovery = parse(none).discovery;
        CHECK(discovery.url.empty());
        CHECK(discovery.interval == std::chrono::minutes{5});
        CHECK_FALSE(discovery.allows_none);
    }
    const ControllerConfig config = parse(R"(
[discovery]
url = "opc.tcp://lds:4840/UADiscovery"
interval_s = 600
allow_none = true
)");
    CHECK(config.discovery.url == "opc.tcp://lds:4840/UADiscovery");
    CHECK(config.discovery.interval == std::chrono::minutes{10});
    CHECK(config.discovery.allows_none);
}

TEST_CASE("what is wrong is told with its place, and what was expected")
{
    struct Row {
        std::string text;
        std::string said;
    };
    const Row rows[] = {
        {"[server]\nprot = 4840", "plant.toml:2: found \"prot\", expected one of: name"},
        {"[server]\nport = 70000", "plant.toml:2: port: found 70000, expected a number from 0"},
        {"[server]\nport = \"x\"", "plant.toml:2: port: found "},
        {"[server\nport = 1", "plant.toml:1: "},
        {"[reverse_connect]\nurls = [\"scada:4841\"]", "plant.toml:2: urls: found "},
        {"[reverse_connect]\nurl = \"opc.tcp://scada\"", "found \"url\", expected one of: urls"},
        {"[discovery]\nurl = \"lds:4840\"", "plant.toml:2: url: found "},
        {"[discovery]\ninterval_s = 9", "interval_s: found 9, expected a number from 10"},
        {"[discovery]\ninterval_s = 601", "interval_s: found 601"},
        {"[certificates]\nkey_bits = 1024", "plant.toml:2: key_bits: found 1024"},
        {"[certificates]\nlimits = \"nj\"", "expected default, nj501, nx102 or rd81opc96"},
        {"[certificates]\nsuppress = [\"trust list check\"]", "expected some of: security policy"},
        {"[[endpoint]]\npolicy = \"Basic128\"",
         "plant.toml:2: policy: found 'Basic128', expected one of: None"},
        {"[[endpoint]]\npolicy = \"None\"\nmode = \"Sign\"", "expected None, the only mode"},
        {"[users]\nanonymous = \"all\"", "expected \"no\", \"read\" or \"write\""},
        {"[[users.account]]\nname = \"a\"\npassword = \"plain\"", "--hash-password"},
        {"[users.tokens]\nissuer = \"x\"\nkey_file = \"/nowhere\"", "a file that can be read"},
        {"[plc]\nscan_ms = 0", "plant.toml:2: scan_ms: found 0"},
        {"[[plc.variable]]\nname = \"A\"\ntype = \"Int\"", "expected a built-in type"},
    };
    for (const Row& row : rows) {
        INFO(row.text);
        const std::string said = complaint(row.text);
        INFO(said);
        CHECK(said.find(row.said) != std::string::npos);
    }
}

TEST_CASE("a password that is none is not shown in the error")
{
    CHECK(complaint("[[users.account]]\nname = \"a\"\npassword = \"hunter2\"").find("hunter2") ==
          std::string::npos);
}
