#include <catch2/catch.hpp>

#include <string>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>

#include "print_conformance.hpp"

using namespace busbar;

namespace {

constexpr DateTime today{134'000'000'000'000'000}; // in 2025

server::Conformance conformance(const std::string& text)
{
    return example::conformance_of(example::parse_config(text, "plant.toml"), today);
}

} // namespace

TEST_CASE("what a configuration claims is printed, and what it lacks")
{
    const server::Conformance secure = conformance("[users]\nanonymous = \"read\"");
    CHECK_FALSE(secure.find("SecurityPolicyNone")->is_claimed);
    CHECK(secure.find("SecurityPolicyBasic256Sha256")->is_claimed);
    const std::string text = example::describe_conformance(secure);
    CHECK(text.find("\nSecurityPolicyBasic256Sha256: claimed\n") != std::string::npos);
    CHECK(text.find("  Discovery Register: discovery\n") != std::string::npos);
    CHECK(text.find("\nMethodClient") == std::string::npos);
    const std::string json = example::conformance_json(secure);
    CHECK(json.starts_with(R"({"profiles":[{"name":)"));
    CHECK(json.find(R"({"unit":"Discovery Register","need":"discovery"})") != std::string::npos);
    CHECK(json.find(R"("name":"MethodClient",)") != std::string::npos);
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
)");
    for (const char* const profile :
         {"SecurityPolicyAes128Sha256RsaOaep", "SecurityPolicyNone", "UserTokenAnonymousServer",
          "UserTokenX509CertificateServer", "UserTokenUserNamePasswordServer",
          "ReverseConnectServer", "Embedded2017Server", "Standard2017Server"}) {
        INFO(profile);
        CHECK(all.find(profile)->is_claimed);
    }
}
