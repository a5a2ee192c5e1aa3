#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include <busbar/server/config_check.hpp>

#include "product/configuration/config.hpp"
#include "product/configuration/presets.hpp"
#include "product/configuration/setting_keys.hpp"

namespace presets_test {

using namespace busbar;
using namespace busbar::product;

namespace {

/// Whether the JSON has the figure.
bool has(const std::string& json, const std::string& name, int figure)
{
    const std::string member = "\"" + name + "\":" + std::to_string(figure);
    return json.find(member + ",") != std::string::npos ||
           json.find(member + "}") != std::string::npos;
}

struct Figure {
    const char* name;
    int figure;
};

void check(const char* preset, const std::vector<Figure>& figures)
{
    const std::string json = preset_json(*find_preset(preset));
    for (const Figure& each : figures) {
        INFO(preset << " " << each.name << " in " << json);
        CHECK(has(json, each.name, each.figure));
    }
}

} // namespace

TEST_CASE("presets: the figures that the manuals publish")
{
    // Seed figures of NJ501 and NX102: 1-2-2 and 3-2-6.
    const std::vector<Figure> nj501{{"sessions", 5},
                                    {"subscriptions", 100},
                                    {"items", 2'000},
                                    {"users", 20},
                                    {"min_name_length", 4},
                                    {"max_name_length", 32},
                                    {"min_password_length", 8},
                                    {"max_password_length", 32},
                                    {"reserved_names", 6},
                                    {"trusted_certificates", 32},
                                    {"issuer_certificates", 32},
                                    {"rejected_certificates", 32}};
    check("nj501", nj501);
    check("nx102", nj501);
    // RD81OPC96: 2.1, 9.7 and Appendix 6.
    check("rd81opc96", {{"sessions", 15},
                        {"min_session_timeout_ms", 10'000},
                        {"max_session_timeout_ms", 180'000},
                        {"nodes_per_read", 25'000},
                        {"nodes_per_write", 3'000},
                        {"nodes_per_browse", 10'000},
                        {"nodes_per_translate_browse_paths", 10'000},
                        {"methods_per_call", 1},
                        {"message_size", 3 * 1'024 * 1'024},
                        {"string_length", 1'024},
                        {"byte_string_length", 10'240},
                        {"array_length", 25'001}, // see rd81opc96_limits
                        {"subscriptions", 150},
                        {"subscriptions_per_session", 10},
                        {"items", 15'000},
                        {"queue_size", 10},
                        {"min_publishing_interval_ms", 50},
                        {"min_keep_alive_ms", 5'000},
                        {"min_lifetime_ms", 10'000},
                        {"min_sampling_interval_ms", 200},
                        {"max_sampling_interval_ms", 60'000},
                        {"min_password_length", 6},
                        {"max_password_length", 32}});
    CHECK(find_preset("default") == nullptr);
}

TEST_CASE("presets: a configuration takes one, and its own keys win over it")
{
    const auto config = parse_config(R"(
[limits]
preset = "rd81opc96"
sessions = 7
[certificates]
limits = "default"
[users]
anonymous = "read"
)",
                                     "test.toml");
    CHECK(config.server.limits.max_sessions == 7);
    CHECK(config.server.limits.operations.max_nodes_per_write == 3'000);
    CHECK(config.server.limits.subscriptions.max_subscriptions == 150);
    CHECK(config.certificates.limits.max_certificates == crypto::StoreLimits{}.max_certificates);
    CHECK(config.users.password_rules.needs_letters_and_digit);
    const auto nj501 = parse_config("[limits]\npreset = \"nj501\"\n", "test.toml");
    CHECK(nj501.certificates.limits.max_certificates == 32);
    CHECK(nj501.users.password_rules.max_users == 20);
    // 1-2-2 has the PLCopen model, 6-2-2 plain DataTypes.
    const auto machine = [](const std::string& lines) {
        return parse_config("[limits]\npreset = \"nj501\"\n[machine]\n" + lines, "test.toml")
            .machine;
    };
    CHECK(machine("").has_plcopen);
    CHECK(machine("").types.elementary == controller::ElementaryTypes::BuiltIn);
    CHECK_FALSE(machine("plcopen_model = false\n").has_plcopen);
    CHECK(machine("").makes_medium);
    CHECK_FALSE(machine("make_medium = false\n").makes_medium);
    CHECK_THROWS_WITH(
        parse_config("[limits]\nmemory = \"64 MB\"\npreset = \"nj501\"\n", "test.toml"),
        Catch::Contains("test.toml:2: memory: found with the preset \"nj501\""));
    CHECK_THROWS_WITH(parse_config("[limits]\npreset = \"s7\"\n", "test.toml"),
                      Catch::Contains("test.toml:2") && Catch::Contains("nj501"));
}

TEST_CASE("presets: a product has the ports of its manual (3-2-2)", "[3-2-2]")
{
    const auto with = [](const std::string& preset, int port) {
        return "[server]\nport = " + std::to_string(port) + "\n[limits]\npreset = \"" + preset +
               "\"\n";
    };
    for (const char* const preset : {"nj501", "nx102"}) {
        CHECK(parse_config(with(preset, 1'025), "test.toml").port == 1'025);
        CHECK(parse_config(with(preset, 0), "test.toml").port == 0); // any that is free
        for (const int port : {80, 1'024}) {
            CHECK_THROWS_WITH(parse_config(with(preset, port), "test.toml"),
                              "test.toml:2: port: found " + std::to_string(port) +
                                  ", expected a number from 1025 to 65535");
        }
        // Online the range is the same.
        const auto settings = controller_settings(parse_table(with(preset, 4'840), "test.toml"));
        const auto port =
            std::ranges::find(settings, "server.port", &administration::Setting::name);
        CHECK(port->range->low == 1'025);
    }
    CHECK(parse_config(with("rd81opc96", 80), "test.toml").port == 80);
}

TEST_CASE("presets: what is wiser than the manual is said with the reason", "[3-2-2][3-2-6]")
{
    const std::string json = preset_json(*find_preset("nj501"));
    for (const char* const said :
         {"{\"setting\":\"machine.use\",\"manual\":\"false\",\"here\":\"true\",\"section\":\"3-2-"
          "2\"",
          "{\"setting\":\"users.anonymous\",\"manual\":\"\\\"write\\\"\",\"here\":\"\\\"no\\\"\"",
          "{\"setting\":\"endpoint\"", "\"section\":\"5-1-2\""}) {
        INFO(said << " in " << json);
        CHECK(json.find(said) != std::string::npos);
    }
    for (const Departure& each : find_preset("nj501")->departures) {
        CHECK_FALSE(each.reason.empty());
    }
}

} // namespace presets_test
