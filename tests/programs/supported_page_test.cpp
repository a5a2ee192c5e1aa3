#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "product/printing/describe.hpp"

/// lib/CONFORMANCE.md, which is made of what the controller prints.
namespace supported_page_test {

using namespace busbar;

namespace {

const std::string page = BUSBAR_SOURCE_DIR "/lib/CONFORMANCE.md";

std::string block(const std::string& text)
{
    return "```text\n" + text + "```\n";
}

std::string made_page()
{
    const product::ControllerConfig built_in = product::parse_config("", "built-in");
    constexpr DateTime some_day{134'000'000'000'000'000}; // in 2025
    const server::Conformance claims = product::conformance_of(
        product::parse_config("[users]\nsetup = true\n", "built-in"), some_day, true);
    return "# Conformance, capacities and limits\n\n"
           "Made of what `busbar-controller` prints, and compared with it by a test. After a "
           "change:\n"
           "`BUSBAR_WRITE_PAGES=1 build/test/bin/config_test \"lib/CONFORMANCE.md*\"`.\n\n"
           "## Capacities\n\n"
           "`busbar-controller --print-capacities [FILE]`, here of the built-in configuration. "
           "What one client\ntakes is not there for others.\n\n" +
           product::describe_capacities(built_in) +
           "\n## Profiles and conformance units\n\n"
           "`busbar-controller --print-conformance [FILE]`, here of the built-in configuration on "
           "a machine whose\nclock follows a time service: each profile with what it lacks, then "
           "the units that are claimed.\n\n" +
           block(product::describe_conformance(claims)) +
           "\n## Limits\n\n"
           "`busbar-controller --print-limits [FILE]`, here of the built-in configuration: each "
           "limit, the memory\nthat clients can make the controller hold by it, and the key that "
           "sets it.\n\n" +
           block(product::describe_limits(built_in));
}

} // namespace

TEST_CASE("lib/CONFORMANCE.md has what the built-in configuration prints",
          "[unit:Documentation - Core Capacities]")
{
    const std::string expected = made_page();
    if (std::getenv("BUSBAR_WRITE_PAGES") != nullptr) {
        std::ofstream{page} << expected;
    }
    std::ifstream file{page};
    const std::string found{std::istreambuf_iterator<char>{file}, {}};
    // Sizes of memory are those of a machine with 64 bits.
    const std::size_t size = sizeof(void*) == 8 ? expected.size() : expected.find("\n## Limits");
    CHECK(found.substr(0, size) == expected.substr(0, size));
    CHECK(expected.find("\nSecurityPolicyBasic256Sha256: claimed\n") != std::string::npos);
}

} // namespace supported_page_test
