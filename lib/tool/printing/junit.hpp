#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace busbar::tool {

/// One case of a JUnit report.
struct JunitCase {
    enum class Outcome : std::uint8_t { Passed, Failed, Skipped };
    std::string class_name;
    std::string name;
    Outcome outcome{Outcome::Passed};
    /// One line; empty for a case that passed.
    std::string message;
    /// May have several lines; empty unless the case failed.
    std::string details;
    std::optional<double> seconds;
};

struct JunitSuite {
    std::string name;
    std::vector<JunitCase> cases;
};

/// Returns the text for an element or an attribute of an XML document (XML 1.0, 2.2 and 2.4). Lines
/// stay lines; control characters and bytes that are not UTF-8 are written as safe() does it, since
/// a document must not have them.
[[nodiscard]] std::string xml_text(std::string_view text);

/// Returns a report in the form of JUnit, which build servers read.
[[nodiscard]] std::string junit_report(std::string_view name,
                                       const std::vector<JunitSuite>& suites);

} // namespace busbar::tool
