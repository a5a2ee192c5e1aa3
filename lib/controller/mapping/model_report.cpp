#include <busbar/controller/model_report.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

#include "report_rules.hpp"

namespace busbar::controller {

std::span<const ReportRule> report_rules()
{
    return detail::all_report_rules;
}

const ReportRule& rule_of(ModelCode code)
{
    const auto& rules = detail::all_report_rules;
    const auto* const found = std::lower_bound(
        rules.begin(), rules.end(), code,
        [](const ReportRule& rule, ModelCode wanted) { return rule.code < wanted; });
    // An unknown code has no rule; give the last one rather than read past the end.
    return found == rules.end() ? rules.back() : *found;
}

std::string text(const ModelReport& report)
{
    const ReportRule& rule = rule_of(report.code);
    std::string line = rule.result == ReportResult::Error ? "error" : "warning";
    line += " M" + std::to_string(static_cast<unsigned>(report.code)) + ' ';
    if (!report.where.empty()) {
        line += report.where + ": ";
    }
    line += rule.content;
    line += report.found.empty() ? ". " : ": " + report.found + ". ";
    line += rule.corrective_action;
    return line + '.';
}

void ModelReports::add(ModelReport report)
{
    const bool is_error = rule_of(report.code).result == ReportResult::Error;
    ++(is_error ? error_count_ : warning_count_);
    if (list_.size() < max_kept) {
        list_.push_back(std::move(report));
    }
}

void ModelReports::add(ModelReports&& others)
{
    error_count_ += others.error_count_;
    warning_count_ += others.warning_count_;
    const std::size_t room = max_kept - list_.size();
    const std::size_t count = std::min(room, others.list_.size());
    std::move(others.list_.begin(), others.list_.begin() + static_cast<std::ptrdiff_t>(count),
              std::back_inserter(list_));
}

} // namespace busbar::controller
