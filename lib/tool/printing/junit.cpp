#include "junit.hpp"

#include <algorithm>
#include <cstdio>

#include "display_text.hpp"

namespace busbar::tool {

namespace {

using JunitOutcome = JunitCase::Outcome;

std::string escape_line(std::string_view line)
{
    std::string result;
    for (const char c : safe(line)) {
        switch (c) {
        case '&':
            result += "&amp;";
            break;
        case '<':
            result += "&lt;";
            break;
        case '>':
            result += "&gt;";
            break;
        case '"':
            result += "&quot;";
            break;
        default:
            result += c;
        }
    }
    return result;
}

std::string xml_attribute(std::string_view name, std::string_view value)
{
    // A line's end in an attribute is a blank for readers (XML 1.0, 3.3.3).
    std::string text = xml_text(value);
    std::replace(text.begin(), text.end(), '\n', ' ');
    return " " + std::string{name} + "=\"" + text + "\"";
}

std::string junit_counts(const std::vector<JunitCase>& cases)
{
    const auto count = [&](JunitOutcome outcome) {
        return std::to_string(std::count_if(cases.begin(), cases.end(), [&](const JunitCase& one) {
            return one.outcome == outcome;
        }));
    };
    return xml_attribute("tests", std::to_string(cases.size())) +
           xml_attribute("failures", count(JunitOutcome::Failed)) +
           xml_attribute("skipped", count(JunitOutcome::Skipped));
}

std::string junit_case(const JunitCase& one)
{
    std::string text = "    <testcase" + xml_attribute("classname", one.class_name) +
                       xml_attribute("name", one.name);
    if (one.seconds) {
        char seconds[32];
        std::snprintf(seconds, sizeof seconds, "%.3f", *one.seconds);
        text += xml_attribute("time", seconds);
    }
    switch (one.outcome) {
    case JunitOutcome::Failed:
        return text + ">\n      <failure" + xml_attribute("message", one.message) + ">" +
               xml_text(one.details) + "</failure>\n    </testcase>\n";
    case JunitOutcome::Skipped:
        return text + ">\n      <skipped" + xml_attribute("message", one.message) +
               "/>\n    </testcase>\n";
    case JunitOutcome::Passed:
        break;
    }
    return text + "/>\n";
}

} // namespace

std::string xml_text(std::string_view text)
{
    std::string result;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        result += escape_line(text.substr(0, end));
        if (end == std::string_view::npos) {
            break;
        }
        result += '\n';
        text.remove_prefix(end + 1);
    }
    return result;
}

std::string junit_report(std::string_view name, const std::vector<JunitSuite>& suites)
{
    std::vector<JunitCase> all;
    for (const JunitSuite& suite : suites) {
        all.insert(all.end(), suite.cases.begin(), suite.cases.end());
    }
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" +
                       xml_attribute("name", name) + junit_counts(all) + ">\n";
    for (const JunitSuite& suite : suites) {
        text +=
            "  <testsuite" + xml_attribute("name", suite.name) + junit_counts(suite.cases) + ">\n";
        for (const JunitCase& one : suite.cases) {
            text += junit_case(one);
        }
        text += "  </testsuite>\n";
    }
    return text + "</testsuites>\n";
}

} // namespace busbar::tool
