#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tiers.hpp"

namespace tiers_test {

using namespace busbar;
using tidy::make_file;

namespace {

const std::filesystem::path root{BUSBAR_SOURCE_DIR};

tidy::File read(const std::filesystem::path& path, const std::filesystem::path& from)
{
    std::ostringstream text;
    text << std::ifstream{path}.rdbuf();
    return make_file(std::filesystem::relative(path, from).generic_string(), text.str());
}

/// The files of a folder whose names end so, with paths from `from`.
std::vector<tidy::File> files_in(const std::filesystem::path& folder, const std::string& extension,
                                 const std::filesystem::path& from)
{
    std::vector<tidy::File> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator{folder}) {
        if (entry.path().extension() == extension) {
            files.push_back(read(entry.path(), from));
        }
    }
    return files;
}

std::string text_of(const tidy::Findings& findings)
{
    std::string text;
    for (const std::string& finding : findings) {
        text += finding + "\n";
    }
    return text;
}

} // namespace

TEST_CASE("every public header is in one tier, and the first tier is small", "[tidy]")
{
    const std::filesystem::path include = root / "include" / "busbar";
    auto headers = files_in(include, ".hpp", include);
    const auto in_c = files_in(include, ".h", include);
    headers.insert(headers.end(), in_c.begin(), in_c.end());
    const auto tiers = tidy::read_tiers(read(include / "README.md", root));
    REQUIRE(tiers.size() == 3);
    CHECK(text_of(tidy::check_tiers(tiers, headers)) == "");

    const tidy::Tier& first = tiers[0];
    CHECK(first.size() >= 6);
    CHECK(first.size() <= 12);
    CHECK(tidy::lines_of(first, headers) > 500);
    CHECK(tidy::lines_of(first, headers) <= 1'200);
    for (const std::string& entry : first) {
        CHECK(entry.ends_with(".hpp"));
    }
}

TEST_CASE("the first programs need the first tier only", "[tidy]")
{
    const auto tiers = tidy::read_tiers(read(root / "include" / "busbar" / "README.md", root));
    REQUIRE(tiers.size() == 3);
    tidy::Tier allowed = tiers[0];
    allowed.push_back("types/ids.hpp");
    std::vector<tidy::File> programs{
        read(root / "examples" / "first_server" / "main.cpp", root),
        read(root / "examples" / "data_source_test" / "tank_source.hpp", root),
        read(root / "tests" / "net" / "first_tier_test.cpp", root),
    };
    for (const tidy::File& program : programs) {
        REQUIRE_FALSE(program.lines.empty());
    }
    CHECK(text_of(tidy::check_first_programs(programs, allowed)) == "");

    programs = {read(root / "examples" / "data_source_test" / "tank_source_test.cpp", root)};
    allowed.push_back("harness/");
    CHECK(text_of(tidy::check_first_programs(programs, allowed)) == "");
}

TEST_CASE("tiers that do not fit their headers are found", "[tidy]")
{
    const auto tiers = tidy::read_tiers(
        make_file("README.md", "# x\n- `no/tier.hpp`: x\n## Tier 1: x\n\n- `a/x.hpp`: first\n"
                               "## Tier 2\n- `a/`: rest\n- `b/`: all\n## Others\n- `c/`\n"));
    REQUIRE(tiers.size() == 2);
    CHECK(tiers[0] == tidy::Tier{"a/x.hpp"});
    CHECK(tiers[1] == tidy::Tier{"a/", "b/"});
    const auto x = make_file("a/x.hpp", "1\n2\n3\n");
    const auto y = make_file("a/y.hpp", "1\n");
    const auto z = make_file("b/detail/z.hpp", "1\n");
    CHECK(tidy::check_tiers(tiers, {x, y, z}).empty());
    CHECK(tidy::lines_of(tiers[0], {x, y, z}) == 3);

    CHECK(text_of(tidy::check_tiers(tiers, {x, y})) ==
          "include/busbar/README.md: b/ stands for no header\n");
    CHECK(text_of(tidy::check_tiers(tiers, {x, y, z, make_file("c/w.hpp", "")})) ==
          "c/w.hpp: is in no tier\n");
    CHECK(text_of(tidy::check_tiers({{"a/x.hpp"}, {"a/x.hpp", "a/"}}, {x, y})) ==
          "include/busbar/README.md: a/x.hpp is there twice\n");
}

TEST_CASE("an include beyond the first tier is found", "[tidy]")
{
    const auto program = make_file("main.cpp", "#include <vector>\n#include <busbar/a/x.hpp>\n"
                                               "#include <busbar/a/y.hpp>\n");
    CHECK(text_of(tidy::check_first_programs({program}, {"a/x.hpp"})) ==
          "main.cpp: includes a/y.hpp\n");
    CHECK(tidy::check_first_programs({program}, {"a/"}).empty());
}

} // namespace tiers_test
