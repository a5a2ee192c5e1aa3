#include <catch2/catch.hpp>

#include <array>
#include <string>

#include <busbar/controller/project.hpp>

#include "controller/life/checksum.hpp"
#include "project_fixture.hpp"

namespace project_file_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::string press_document()
{
    auto document = document_of(test::press_project());
    REQUIRE(document);
    return *document;
}

std::string replaced(std::string text, std::string_view from, std::string_view to)
{
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

/// With a checksum that is right, so that what is behind it is reached.
std::string sealed(const std::string& document)
{
    const std::size_t at = document.rfind("checksum = ");
    const std::string before = document.substr(0, at);
    return before + "checksum = " + controller::detail::checksum_text(before) + "\n";
}

std::string problem_of(const std::string& document, const ProjectLimits& limits = {})
{
    const auto project = read_project(document, "press.busbar", limits);
    return project ? "none" : text(project.error());
}

} // namespace

TEST_CASE("9.3 Project file: what was written is read again, and people can read it", "[9.3]")
{
    const std::string document = press_document();
    const auto project = read_project(document, "press.busbar");
    REQUIRE(project);
    CHECK(*project == test::press_project());
    CHECK(document_of(*project).value() == document);

    CHECK(document.starts_with("busbar project 1\npreset =\n\n[network]\n"
                               "gateway = 192.168.3.1\nhost_name = PRESS4\n"));
    CHECK(document.find("\n[listener]\nuse = administration\naddress = 10.1.0.7\n") !=
          std::string::npos);
    CHECK(document.find("\n<UANodeSet ") != std::string::npos);

    const auto defaults = document_of(Project{});
    REQUIRE(defaults);
    CHECK(read_project(*defaults, "new").value() == Project{});
}

TEST_CASE("9.3 Project file: a model is kept byte by byte, whatever is in it", "[9.3]")
{
    Project project;
    project.models = {{"a.xml", std::string("\0\xFF\xFE[end]\r\n\n[model]\n", 20)},
                      {"empty.xml", ""},
                      {"b.xml", "\n\n"}};
    const auto document = document_of(project);
    REQUIRE(document);
    const auto again = read_project(*document, "a");
    REQUIRE(again);
    CHECK(again->models == project.models);
}

TEST_CASE("9.3 Project file: any damage of one byte is found", "[9.3]")
{
    const std::string document = press_document();
    for (std::size_t i = 0; i < document.size(); ++i) {
        for (const int bit : {0, 5}) {
            std::string damaged = document;
            damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
            if (read_project(damaged, "damaged")) {
                FAIL("byte " << i << " of " << document.size() << " does not matter");
            }
        }
    }
}

TEST_CASE("9.3 Project file: a file that ends early is refused", "[9.3]")
{
    const std::string document = press_document();
    for (std::size_t size = 0; size < document.size(); ++size) {
        if (read_project(std::string_view{document}.substr(0, size), "cut")) {
            FAIL("the first " << size << " bytes of " << document.size() << " are taken");
        }
    }
    CHECK(problem_of(document + "\n").starts_with("press.busbar:"));
}

TEST_CASE("9.3 Project file: a file of another version is refused with its number", "[9.3]")
{
    const std::string document = press_document();
    CHECK(problem_of(sealed(replaced(document, "project 1", "project 2"))) ==
          "press.busbar:1: found version 2, expected version 1; the file is of a newer program");
    CHECK(problem_of(replaced(document, "project 1", "project 0")) ==
          "press.busbar:1: found version 0, expected version 1");
    CHECK(problem_of(replaced(document, "project 1", "project x")) ==
          "press.busbar:1: found version \"x\", expected a number");
    CHECK(problem_of("<UANodeSet/>\n") ==
          "press.busbar:1: found another file, expected \"busbar project 1\"");
}

TEST_CASE("9.3 Project file: problems have the line, what was found and what was expected", "[9.3]")
{
    struct Case {
        std::string_view from;
        std::string_view to;
        std::string_view problem;
    };
    constexpr std::array cases{
        Case{"host_name = PRESS4\n", "",
             ":4: [network] host_name: found nothing, expected a value"},
        Case{"host_name = ", "hostname = ", ":4: [network] host_name: found nothing, "},
        Case{"host_name = PRESS4", "host_name = PRESS4\nhost_name = A",
             ":7: [network] host_name: found it, expected only values that the section has"},
        Case{"host_name = PRESS4", "host_name: PRESS4",
             ":6: [network]: found \"host_name: PRESS4\", expected \"name = value\""},
        Case{"PRESS4", "PRESS\x01",
             ":6: [network] host_name: found \"PRESS\\x01\", expected UTF-8"},
        Case{"tool_logs_in = yes", "tool_logs_in = 1",
             ":11: [security] tool_logs_in: found \"1\", expected yes or no"},
        Case{"mode = SignAndEncrypt", "mode = Encrypt",
             ":10: [security] mode: found \"Encrypt\", expected one of: None, Sign, "
             "SignAndEncrypt"},
        Case{"interval_s = 60", "interval_s = -1",
             ":27: [discovery] interval_s: found \"-1\", expected a number"},
        Case{"[sampling]", "[samples]", ":29: [samples]: found it, expected a section that"},
        Case{"[sampling]", "[discovery]", ":29: [discovery]: found it again, expected it once"},
        Case{"[sampling]", "sampling", ":29: [discovery]: found \"sampling\", expected \"name ="},
        Case{"[sampling]", "[sampling", ":29: found \"[sampling\", expected \"[section]\""},
        Case{"size = ", "size = 9", "expected 9"}, // more than there is
        Case{"size = ", "size = 999999", "[model] size: found 999999"},
        Case{"<Models>", "<models>", "[model] checksum: found "},
        Case{"[end]\n", "[fin]\n", "[fin]: found it, expected a section that a project has"},
    };
    for (const Case& each : cases) {
        const std::string problem =
            problem_of(sealed(replaced(press_document(), each.from, each.to)));
        INFO(problem);
        CHECK(problem.starts_with("press.busbar:"));
        CHECK(problem.find(each.problem) != std::string::npos);
    }
    CHECK(
        problem_of(replaced(press_document(), "PRESS4", "PRESS5")).find("[end] checksum: found ") !=
        std::string::npos);
}

TEST_CASE("9.3 Project file: more than the limits allow is refused, when read and when written",
          "[9.3]")
{
    const std::string document = press_document();
    struct Case {
        ProjectLimits limits;
        std::string_view problem;
    };
    const std::array cases{
        Case{{.max_file_size = document.size() - 1}, "bytes, expected at most"},
        Case{{.max_model_size = 100}, "[model] size: found "},
        Case{{.max_models = 1}, "[model]: found one more, expected at most 1"},
        Case{{.max_users = 1}, "[user]: found one more, expected at most 1"},
        Case{{.max_listeners = 1}, "[listener]: found one more, expected at most 1"},
        Case{{.max_text = 5}, "bytes, expected at most 5"},
    };
    for (const Case& each : cases) {
        const std::string problem = problem_of(document, each.limits);
        INFO(problem);
        CHECK(problem.find(each.problem) != std::string::npos);
        CHECK_FALSE(document_of(test::press_project(), each.limits));
    }
    ProjectLimits exact;
    exact.max_file_size = document.size();
    exact.max_models = exact.max_users = exact.max_listeners = 2;
    CHECK(problem_of(document, exact) == "none");
}

TEST_CASE("9.3 Project file: values that no file can have are not written", "[9.3]")
{
    Project project = test::press_project();
    project.certificate.unit = "a\nb = c";
    const auto document = document_of(project);
    REQUIRE_FALSE(document);
    CHECK(text(document.error()) == "[certificate] unit: found control characters or bytes that "
                                    "are not UTF-8, expected text of one line");
    project = test::press_project();
    project.security.policies = {"Basic256Sha256, Basic256"};
    CHECK_FALSE(document_of(project));
    project = test::press_project();
    project.models[1].name = "\xFF";
    CHECK_FALSE(document_of(project));
}

TEST_CASE("9.3 Project: values are set one at a time by the names that they are listed with",
          "[9.3]")
{
    Project project;
    const Project press = test::press_project();
    for (const ProjectValue& value : values_of(press)) {
        INFO(value.name);
        CHECK(set_project_value(project, value.name, value.value));
    }
    project.models = press.models;
    CHECK(project == press);

    CHECK(set_project_value(project, "user 1", ""));
    CHECK(project.users.size() == 1);
    CHECK(project.users[0].name == "hmi");
    const Project before = project;
    for (const auto& [name, value] : {std::pair{"user 3.name", "x"},
                                      {"user 0.name", "x"},
                                      {"user 2", ""},
                                      {"user 1", "x"},
                                      {"network", ""},
                                      {"network.port", "1"},
                                      {"listener 1.port", "many"},
                                      {"listener 3.ports", "1"},
                                      {"network.host_name", "a\tb"}}) {
        INFO(name);
        CHECK_FALSE(set_project_value(project, name, value));
        CHECK(project == before);
    }
    const auto wrong = set_project_value(project, "sampling.mode", "fast");
    CHECK(text(wrong.error()) == "sampling.mode: found \"fast\", expected one of: standard, "
                                 "high-speed items, high-speed variables");
}

} // namespace project_file_test
