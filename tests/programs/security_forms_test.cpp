#include <catch2/catch.hpp>

#include <string>
#include <utility>
#include <vector>

#include <busbar/channel/channel_types.hpp>

#include "product/configuration/config.hpp"

namespace security_forms_test {

using namespace busbar;
using namespace busbar::product;

namespace {

std::string message_of(const std::string& text)
{
    try {
        static_cast<void>(parse_config(text, "test"));
    } catch (const ConfigError& error) {
        return error.what();
    }
    return "nothing";
}

/// "Sign Basic256Sha256", endpoint by endpoint.
std::vector<std::string> endpoints_of(const std::string& text)
{
    std::vector<std::string> names;
    for (const server::EndpointConfig& each : parse_config(text, "test").server.endpoints) {
        names.push_back(std::string{channel::name(each.security.mode)} + " " +
                        std::string{each.security.policy->name});
    }
    return names;
}

} // namespace

TEST_CASE("security is told in the ways of two products, too")
{
    using Names = std::vector<std::string>;
    struct Row {
        const char* text;
        Names endpoints;
    };
    const Row rows[] = {
        // The mode that is chosen and every stronger one.
        {"policies = [\"Aes256-Sha256-RsaPss\", \"Basic256Sha256\"]\nmode = \"Sign\"",
         {"Sign Aes256_Sha256_RsaPss", "SignAndEncrypt Aes256_Sha256_RsaPss", "Sign Basic256Sha256",
          "SignAndEncrypt Basic256Sha256"}},
        {"policies = [\"Aes128_Sha256_RsaOaep\"]", {"SignAndEncrypt Aes128_Sha256_RsaOaep"}},
        // None is on where no policy is chosen, and only there.
        {"policies = []",
         {"None None", "Sign Basic256Sha256", "SignAndEncrypt Basic256Sha256",
          "Sign Aes128_Sha256_RsaOaep", "SignAndEncrypt Aes128_Sha256_RsaOaep",
          "Sign Aes256_Sha256_RsaPss", "SignAndEncrypt Aes256_Sha256_RsaPss"}},
        {"allow = [\"SignAndEncrypt - Basic256Sha256\", \"None\"]",
         {"SignAndEncrypt Basic256Sha256", "None None"}},
    };
    for (const Row& row : rows) {
        INFO(row.text);
        CHECK(endpoints_of(std::string{"[security]\n"} + row.text) == row.endpoints);
    }
    const std::pair<const char*, const char*> mistakes[] = {
        {"[security]\n", "[security]: found neither policies nor allow"},
        {"[security]\nmode = \"Sign\"", "[security]: found neither policies nor allow"},
        {"[security]\npolicies = []\nmode = \"Sign\"", "test:3: mode: found 'Sign', expected None"},
        {"[security]\npolicies = [\"Basic256Sha256\"]\nmode = \"None\"",
         "test:3: mode: found 'None', expected Sign or"},
        {"[security]\npolicies = [\"None\"]", "test:2: policies: found"},
        {"[security]\npolicies = [\"Basic512\"]", "expected some of: "},
        {"[security]\nallow = []", "test:2: allow: found [], expected at least one"},
        {"[security]\nallow = [\"Sign\"]", "test:2: allow: found"},
        {"[security]\nallow = [\"Sign - None\"]", "test:2: allow: found"},
        {"[security]\nallow = [\"None - Basic256Sha256\"]", "test:2: allow: found"},
        {"[security]\nallow = [\"None\"]\nmode = \"None\"", "beside policies or mode"},
        {"[security]\nallow = [\"None\"]\n[[endpoint]]\npolicy = \"None\"",
         "test:1: security: found it beside [[endpoint]]"},
    };
    for (const auto& [text, said] : mistakes) {
        INFO(text);
        const std::string complaint = message_of(text);
        INFO(complaint);
        CHECK(complaint.find(said) != std::string::npos);
    }
}

} // namespace security_forms_test
