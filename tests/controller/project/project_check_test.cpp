#include <catch2/catch.hpp>

#include <string>
#include <utility>
#include <vector>

#include <busbar/controller/project.hpp>

#include "project_fixture.hpp"

namespace project_check_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

/// Values that are set in the project of a press, and what check() then says.
struct CheckCase {
    std::vector<std::pair<std::string, std::string>> values;
    std::string problem{}; // its beginning; empty: none
};

void run_checks(const std::vector<CheckCase>& cases, const std::string& preset = {})
{
    for (const CheckCase& each : cases) {
        Project project = test::press_project();
        project.preset = preset;
        for (const auto& [name, value] : each.values) {
            INFO(name << " = " << value);
            REQUIRE(set_project_value(project, name, value));
        }
        const auto checked = check(project);
        INFO(each.values.back().first << " = " << each.values.back().second);
        if (each.problem.empty()) {
            CHECK((checked ? "none" : text(checked.error())) == "none");
        } else {
            CHECK((checked ? "none" : text(checked.error())).substr(0, each.problem.size()) ==
                  each.problem);
        }
    }
}

} // namespace

TEST_CASE("9.8 Network: addresses, masks, ports and the gateway are checked", "[9.8]")
{
    run_checks({
        {{{"listener 1.address", "192.168.3.39"}}},
        {{{"listener 1.address", "192.168.3"}},
         "[listener 1] address: found \"192.168.3\", expected an IPv4 address"},
        {{{"listener 1.address", "192.168.3.256"}}, "[listener 1] address: found"},
        {{{"listener 1.address", "192.168.3.040"}}, "[listener 1] address: found"},
        {{{"listener 1.address", "192.168.3.40.1"}}, "[listener 1] address: found"},
        {{{"listener 1.address", ""}}, "[listener 1] address: found"},
        {{{"listener 1.mask", "255.0.255.0"}}, "[listener 1] mask: found \"255.0.255.0\""},
        {{{"listener 1.mask", "0.0.0.0"}}, "[listener 1] mask: found"},
        {{{"listener 1.port", "0"}}, "[listener 1] port: found \"0\", expected 1 to 65535"},
        {{{"listener 1.port", "65536"}}, "[listener 1] port: found"},
        {{{"listener 1.port", "65535"}}},
        {{{"network.gateway", ""}}},
        {{{"network.gateway", "10.1.200.1"}}},
        {{{"network.gateway", "10.2.0.1"}}, "[network] gateway: found \"10.2.0.1\""},
        {{{"network.gateway", "router"}}, "[network] gateway: found"},
        {{{"network.host_name", "press-4.works.example"}}},
        {{{"network.host_name", "press 4"}}, "[network] host_name: found \"press 4\""},
        {{{"listener 1.use", "administration"}}, "[listener]: found \"none for data\""},
        {{{"listener 1.use", "data"}}},
        {{{"listener 2", ""}, {"network.gateway", ""}, {"listener 1.address", ""}}},
    });
}

TEST_CASE("9.8 Network, note 1: two addresses in one network are refused", "[9.8]")
{
    const std::string wrong = "[listener 2] address: found ";
    run_checks({
        {{{"listener 2.address", "192.168.3.40"}}, wrong},
        {{{"listener 2.address", "192.168.3.41"}}, wrong},
        {{{"listener 2.address", "192.168.3.41"}, {"listener 2.mask", "255.255.255.0"}},
         wrong + "\"192.168.3.41\", expected another network than that of listener 1"},
        // The wider network has the other one in it.
        {{{"listener 2.address", "192.168.200.1"}, {"listener 2.mask", "255.255.0.0"}}, wrong},
        {{{"listener 2.address", "192.168.4.41"}, {"listener 2.mask", "255.255.255.0"}}},
    });
}

TEST_CASE("9.8 Network: end point URLs are those of the listeners for data", "[9.8]")
{
    ProjectNetwork network = test::press_project().network;
    using Urls = std::vector<std::string>;
    CHECK(endpoint_urls(network) == Urls{"opc.tcp://192.168.3.40:4840", "opc.tcp://PRESS4:4840"});
    network.listeners[0].port = 5'000;
    network.listeners[1].use = ListenerUse::Data;
    network.host_name.clear();
    CHECK(endpoint_urls(network) == Urls{"opc.tcp://192.168.3.40:5000", "opc.tcp://10.1.0.7:4841"});
    network.listeners.resize(1);
    network.listeners[0].address.clear();
    CHECK(endpoint_urls(network).empty());
}

TEST_CASE("9.9 Security: the mode goes with the policies", "[9.9]")
{
    run_checks({
        {{{"security.policies", "Aes256_Sha256_RsaPss, Basic256Sha256"}}},
        {{{"security.policies", "Basic256Sha257"}}, "[security] policies: found \"Basic256Sha257"},
        {{{"security.policies", "None"}}, "[security] policies: found \"None\""},
        {{{"security.policies", "Basic256Sha256, Basic256Sha256"}}, "[security] policies: found"},
        {{{"security.mode", "None"}}, "[security] mode: found \"None\", expected Sign or"},
        {{{"security.policies", ""}}, "[security] mode: found \"SignAndEncrypt\", expected None"},
        {{{"security.policies", ""}, {"security.mode", "None"}}},
        {{{"security.allow_passwords", "no"}}, "[security] allow_passwords: found \"no\""},
        {{{"security.allow_passwords", "no"}, {"security.allow_anonymous", "yes"}}},
    });
}

TEST_CASE("9.9 Security: all modes from the selected one on are allowed", "[9.9]")
{
    const auto texts = [](const std::vector<std::string>& policies, MessageSecurityMode mode) {
        ProjectSecurity security;
        security.policies = policies;
        security.mode = mode;
        std::vector<std::string> all;
        for (const MessageSecurity& each : allowed_security(security)) {
            all.push_back(text(each));
        }
        return all;
    };
    using Texts = std::vector<std::string>;
    CHECK(texts({"Basic256Sha256"}, MessageSecurityMode::SignAndEncrypt) ==
          Texts{"SignAndEncrypt - Basic256Sha256"});
    CHECK(texts({"Basic256Sha256"}, MessageSecurityMode::Sign) ==
          Texts{"Sign - Basic256Sha256", "SignAndEncrypt - Basic256Sha256"});
    const Texts all = texts({}, MessageSecurityMode::None);
    CHECK(all.size() == 7);
    CHECK(all.front() == "None");
    CHECK(std::count(all.begin(), all.end(), "Sign - Aes256_Sha256_RsaPss") == 1);
}

TEST_CASE("9.7 Users: names are told apart, and passwords are hashes", "[9.7]")
{
    run_checks({
        {{{"user 2.name", "engineer"}}, "[user 2] name: found \"engineer\", expected each name"},
        {{{"user 2.name", ""}}, "[user 2] name: "},
        {{{"user 1.password_hash", "Secret123"}}, "[user 1] password_hash: found no hash"},
    });
    // A password that stands where its hash should is not told to anybody.
    Project project = test::press_project();
    project.users[0].password_hash = "Secret123";
    CHECK(text(check(project).error()).find("Secret") == std::string::npos);
}

TEST_CASE("9.10 Certificate: the subject is checked", "[9.10]")
{
    run_checks({
        {{{"certificate.country", "D"}}, "[certificate] country: found \"D\", expected two"},
        {{{"certificate.country", "DEU"}}, "[certificate] country: found"},
        {{{"certificate.country", ""}}},
        {{{"certificate.unit", std::string(65, 'a')}}, "[certificate] unit: found"},
        {{{"certificate.organization", "Works Ulm, Hall 2"}}},
    });
}

TEST_CASE("9.11 Discovery: URL and interval are checked", "[9.11]")
{
    run_checks({
        {{{"discovery.url", ""}}},
        {{{"discovery.url", "http://lds"}}, "[discovery] url: found \"http://lds\""},
        {{{"discovery.interval_s", "9"}}, "[discovery] interval_s: found \"9\", expected 10 to"},
        {{{"discovery.interval_s", "601"}}, "[discovery] interval_s: found"},
    });
}

TEST_CASE("2.1 Limits: there is one preset", "[2.1]")
{
    run_checks({
        {{{"preset", "rd82"}}, "preset: found \"rd82\", expected rd81opc96 or nothing"},
    });
}

TEST_CASE("A-6 Characters: with the preset only, letters, digits and underscore", "[A-6]")
{
    const std::vector<std::vector<std::pair<std::string, std::string>>> free{
        {{"network.host_name", "press4"}},
        {{"network.host_name", "PRESS-4"}},
        {{"certificate.server_name", "Press 4"}},
        {{"certificate.organization", "Werk Ulm"}},
        {{"certificate.unit", "Hall-2"}},
        {{"certificate.locality", "Neu-Ulm"}},
        {{"certificate.state", "Baden-W"}},
        {{"certificate.country", "de"}},
        {{"discovery.url", "opc.tcp://lds_1:4840"}},
        {{"user 2.name", "hmi 2"}},
    };
    std::vector<CheckCase> refused;
    std::vector<CheckCase> taken;
    for (const auto& values : free) {
        const std::string& name = values[0].first;
        taken.push_back({values});
        const std::string place =
            "[" + name.substr(0, name.find('.')) + "] " + name.substr(name.find('.') + 1) + ": ";
        refused.push_back({values, place});
    }
    run_checks(taken);
    run_checks(refused, "rd81opc96");
    run_checks({{{{"network.host_name", "PRESS_4"}}},
                {{{"certificate.server_name", "Press_4a"}}},
                {{{"discovery.url", "opc.tcp://lds1.works:4840/x"}}}},
               "rd81opc96");
}

TEST_CASE("2.1 Information model files: ten of 20 MB together with the preset only", "[2.1]")
{
    Project project = test::press_project();
    project.models.assign(11, {"a.xml", "<a/>"});
    CHECK(check(project));
    project.preset = "rd81opc96";
    CHECK(text(check(project).error()) == "[model]: found \"11 files\", expected at most 10");
    project.models.assign(10, {"a.xml", std::string((2U << 20U), ' ')});
    CHECK(check(project));
    project.models[9].text += ' ';
    CHECK(text(check(project).error()).starts_with("[model]: found \"20971521 bytes\""));
    project.preset.clear();
    CHECK(check(project));
}

} // namespace project_check_test
