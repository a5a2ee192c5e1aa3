#include <catch2/catch.hpp>

#include <string>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>

#include "product/printing/describe.hpp"

namespace print_conformance_test {

using namespace busbar;

namespace {

constexpr DateTime today{134'000'000'000'000'000}; // in 2025

server::Conformance conformance(const std::string& text, bool has_time_sync = false)
{
    return product::conformance_of(product::parse_config(text, "plant.toml"), today, has_time_sync);
}

} // namespace

TEST_CASE("what a configuration claims is printed, and what it lacks")
{
    const server::Conformance secure = conformance("[users]\nanonymous = \"read\"");
    CHECK_FALSE(secure.find("SecurityPolicyNone")->is_claimed);
    CHECK(secure.find("SecurityPolicyBasic256Sha256")->is_claimed);
    const std::string text = product::describe_conformance(secure);
    CHECK(text.find("\nSecurityPolicyBasic256Sha256: claimed\n") != std::string::npos);
    CHECK(text.find("  Discovery Register: discovery\n") != std::string::npos);
    CHECK(text.find("\nMethodClient") == std::string::npos);
    const std::string json = product::conformance_json(secure);
    CHECK(json.starts_with(R"({"profiles":[{"name":)"));
    CHECK(json.find(R"({"unit":"Discovery Register","need":"discovery","works":false})") !=
          std::string::npos);
    CHECK(json.find(R"("name":"MethodClient",)") != std::string::npos);
}

TEST_CASE("a controller that is to be set up makes claims, too")
{
    CHECK(conformance("[users]\nsetup = true").find("SecurityPolicyBasic256Sha256")->is_claimed);
}

TEST_CASE("a host whose clock follows a time service supports time synchronization",
          "[unit:Time Sync - Support]")
{
    CHECK(conformance("[users]\nanonymous = \"read\"", true)
              .find("SecurityTimeSynchronization")
              ->is_claimed);
    CHECK_FALSE(conformance("[users]\nanonymous = \"read\"", false)
                    .find("SecurityTimeSynchronization")
                    ->is_claimed);
}

TEST_CASE("endpoints, users and what the controller connects to make claims")
{
    crypto::SystemRandom random;
    const server::Conformance all = conformance(R"(
[discovery]
url = "opc.tcp://lds:4840"
[reverse_connect]
urls = ["opc.tcp://scada:4841"]
[[endpoint]]
policy = "None"
[[endpoint]]
policy = "Basic256Sha256"
[[endpoint]]
policy = "Aes128_Sha256_RsaOaep"
[users]
anonymous = "read"
certificates = "write"
[[users.account]]
name = "engineer"
password = ")" + *crypto::hash_password("engineer-secret", random) +
                                                    R"("
)",
                                                true);
    for (const char* const profile :
         {"SecurityPolicyAes128Sha256RsaOaep", "SecurityPolicyNone", "UserTokenAnonymousServer",
          "UserTokenX509CertificateServer", "UserTokenUserNamePasswordServer",
          "ReverseConnectServer", "Embedded2017Server", "Standard2017Server", "Embedded2025Server",
          "Standard2025Server"}) {
        INFO(profile);
        CHECK(all.find(profile)->is_claimed);
    }
    // What is left of what came later: the elliptic curves of 2022.
    std::vector<std::string_view> lacks;
    for (const server::UnitLack& lack : all.find("Standard2022Server")->lacks) {
        lacks.push_back(lack.unit);
    }
    CHECK(lacks == std::vector<std::string_view>{"Security ECC Policy"});
}

} // namespace print_conformance_test
