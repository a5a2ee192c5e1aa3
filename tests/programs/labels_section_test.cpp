#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>

#include "product/configuration/config.hpp"
#include "support/temporary_folder.hpp"

namespace labels_section_test {

using namespace busbar;
using product::ConfigError;
using product::ControllerConfig;

namespace {

struct Fixture {
    Fixture() { std::ofstream{path()} << "VAR_GLOBAL Handle : WORD; State : INT; END_VAR\n"; }

    [[nodiscard]] std::filesystem::path path() const { return folder.path / "line.st"; }
    /// With the labels' program.
    [[nodiscard]] ControllerConfig parse(const std::string& more) const
    {
        return product::parse_config("[labels]\nprogram = \"" + path().string() + "\"\n" + more,
                                     "plant.toml");
    }
    [[nodiscard]] std::string complaint(const std::string& more) const
    {
        try {
            static_cast<void>(parse(more));
        } catch (const ConfigError& error) {
            return error.what();
        }
        return "nothing";
    }

    test::TemporaryFolder folder;
};

} // namespace

TEST_CASE_METHOD(Fixture, "the PLC behind a project is configured")
{
    const auto config =
        parse("access_unit = 480\nwaiting = 8\nsampling = false\nsampled_points = 8192\n"
              "utc_offset_minutes = -90\nisolate_failures = true\ncall_limit_ms = "
              "60000\n[[plc.program]]\nkind = "
              "\"acknowledge\"\n"
              "target = \"Handle\"\nsets = \"State\"\nto = 6\n");
    REQUIRE(config.labels.program != nullptr);
    CHECK(config.labels.program->variables.size() == 2);
    CHECK(config.labels.options.access_unit == 480);
    CHECK(config.labels.options.max_waiting == 8);
    CHECK_FALSE(config.labels.options.can_sample);
    CHECK(config.labels.options.max_sampled_points == 8'192);
    CHECK(config.labels.utc_offset == -90);
    CHECK(config.labels.isolates_failures);
    CHECK(config.labels.call_limit == std::chrono::minutes{1});
    REQUIRE(config.plc.programs.size() == 1);
    CHECK(config.plc.programs[0].sets == "State");
    CHECK(config.plc.programs[0].to == 6);
    CHECK_FALSE(parse("").labels.utc_offset);
    CHECK_FALSE(parse("").labels.isolates_failures);
    CHECK(parse("").labels.call_limit == std::chrono::seconds{4});
}

TEST_CASE_METHOD(Fixture, "a mistake of the PLC behind a project has its place")
{
    const std::string program = "[[plc.program]]\nkind = \"acknowledge\"\ntarget = ";
    const std::pair<std::string, const char*> mistakes[] = {
        {"unit = 1", "plant.toml:3: found \"unit\""},
        {"waiting = 0", "plant.toml:3: waiting: found 0, expected"},
        {"call_limit_ms = 60001", "plant.toml:3: call_limit_ms: found 60001, expected"},
        {"utc_offset_minutes = 1441", "plant.toml:3: utc_offset_minutes"},
        {program + "\"Lamp\"", "plant.toml:5: target: found 'Lamp'"},
        {program + "\"Handle\"\nsets = \"Lamp\"", "plant.toml:6: sets: found 'Lamp'"},
        {"[[plc.variable]]\nname = \"Speed\"\ntype = \"Int16\"",
         "found a variable besides those of the program"},
        {"[[plc.event]]\nvariable = \"State\"\nmessage = \"x\"", "plant.toml:4: variable"},
        {"[machine]\nprogram = \"" + path().string() + "\"", "besides that of [machine]"},
    };
    for (const auto& [text, expected] : mistakes) {
        INFO(text);
        CHECK_THAT(complaint(text), Catch::Contains(expected));
    }
    std::ofstream{path()} << "VAR_GLOBAL Handle : WORD;\nState : INTEGER; END_VAR\n";
    CHECK_THAT(complaint("strict = true\n"), Catch::Contains("line.st:2:"));
    CHECK(complaint("") == "nothing");
    std::filesystem::remove(path());
    CHECK_THAT(complaint(""), Catch::Contains("plant.toml:2: program: found"));
}

} // namespace labels_section_test
