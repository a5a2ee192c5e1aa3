#include <busbar/core/problem.hpp>

#include <busbar/core/refusal.hpp>
#include <busbar/core/text.hpp>

namespace busbar {

std::string text(const Problem& problem)
{
    std::string line = problem.where;
    if (!line.empty() && !problem.text.empty()) {
        line += ": ";
    }
    line += problem.text;
    if (problem.status != status::Bad_ConfigurationError) {
        line += line.empty() ? "(" : " (";
        line += name(problem.status);
        line += ')';
    }
    return line;
}

Problem problem_of(const Refusal& refusal)
{
    std::string found = refusal.found;
    if (!refusal.thumbprint.empty()) {
        found += " (" + refusal.subject + ", " + refusal.thumbprint + ")";
    }
    if (!refusal.rule.empty()) {
        found += ", ";
        found += refusal.rule;
    }
    if (!refusal.remedy.empty()) {
        found += ". " + refusal.remedy;
    }
    return {refusal.status, std::string{refusal.check}, std::move(found)};
}

} // namespace busbar
