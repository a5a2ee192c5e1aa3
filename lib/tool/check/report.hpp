#pragma once

#include <string>
#include <vector>

#include "rule.hpp"
#include "tool/printing/output.hpp"

namespace busbar::tool::rules {

/// Prints the verdicts for people: by service, those that failed first.
void print(Output& out, const std::vector<Verdict>& verdicts);
/// The verdicts as JSON, in the order of the rules.
[[nodiscard]] std::string json_of(const std::vector<Verdict>& verdicts);
/// The same as a JUnit file, with a suite for each service.
[[nodiscard]] std::string junit_of(const std::vector<Verdict>& verdicts);

/// Lists rules, for people and as JSON.
void print(Output& out, const std::vector<const SpecRule*>& rules);
[[nodiscard]] std::string json_of(const std::vector<const SpecRule*>& rules);

[[nodiscard]] std::size_t count(const std::vector<Verdict>& verdicts, Verdict::Outcome outcome);

} // namespace busbar::tool::rules
