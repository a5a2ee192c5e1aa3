#include "rule.hpp"

#include <algorithm>

#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/junit.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::rules {

namespace {

using Outcome = Verdict::Outcome;

constexpr std::array outcomes = {Outcome::Failed, Outcome::NotApplicable, Outcome::Passed};

std::string_view name_of(Outcome outcome)
{
    return outcome == Outcome::Passed   ? "passed"
           : outcome == Outcome::Failed ? "failed"
                                        : "not applicable";
}

/// The services, in the order of the rules.
std::vector<std::string_view> services_of(const std::vector<Verdict>& verdicts)
{
    std::vector<std::string_view> services;
    for (const Verdict& verdict : verdicts) {
        if (std::find(services.begin(), services.end(), verdict.rule->service) == services.end()) {
            services.push_back(verdict.rule->service);
        }
    }
    return services;
}

std::vector<Verdict> of_service(const std::vector<Verdict>& verdicts, std::string_view service)
{
    std::vector<Verdict> result;
    std::copy_if(verdicts.begin(), verdicts.end(), std::back_inserter(result),
                 [&](const Verdict& verdict) { return verdict.rule->service == service; });
    return result;
}

void print_finding(Output& out, const Verdict& verdict)
{
    const SpecRule& rule = *verdict.rule;
    out.line(out.styled(Style::Bad, "  failed  ") + std::string{rule.id} + ": " +
             std::string{rule.title});
    out.line("          request  " + std::string{rule.request});
    out.line("          wanted   " + rule.wanted.text());
    out.line("          found    " + safe(verdict.found));
    out.line("          see      " + std::string{rule.source});
}

std::string counts(const std::vector<Verdict>& verdicts)
{
    std::string text;
    for (const Outcome outcome : outcomes) {
        if (const std::size_t number = count(verdicts, outcome); number != 0) {
            text += (text.empty() ? "" : ", ") + std::to_string(number) + " " +
                    std::string{name_of(outcome)};
        }
    }
    return text;
}

void members(JsonLine& json, const SpecRule& rule)
{
    json.member("id", rule.id).member("service", rule.service).member("title", rule.title);
    json.member("request", rule.request).member("wanted", std::string_view{rule.wanted.text()});
    json.member("source", rule.source);
}

JunitCase case_of(const Verdict& verdict)
{
    const SpecRule& rule = *verdict.rule;
    JunitCase made;
    made.class_name = rule.service;
    made.name = rule.id;
    made.seconds = verdict.seconds;
    const std::string found = safe(verdict.found);
    if (verdict.outcome == Outcome::Failed) {
        made.outcome = JunitCase::Outcome::Failed;
        made.message =
            std::string{rule.title} + ": wanted " + rule.wanted.text() + ", found " + found;
        made.details = "request " + std::string{rule.request} + "; " + std::string{rule.source};
    } else if (verdict.outcome == Outcome::NotApplicable) {
        made.outcome = JunitCase::Outcome::Skipped;
        made.message = found;
    }
    return made;
}

} // namespace

std::size_t count(const std::vector<Verdict>& verdicts, Outcome outcome)
{
    return static_cast<std::size_t>(
        std::count_if(verdicts.begin(), verdicts.end(),
                      [&](const Verdict& verdict) { return verdict.outcome == outcome; }));
}

void print(Output& out, const std::vector<Verdict>& verdicts)
{
    for (const std::string_view service : services_of(verdicts)) {
        const std::vector<Verdict> group = of_service(verdicts, service);
        out.line(out.styled(Style::Bold, service) + ": " + counts(group));
        for (const Outcome outcome : {Outcome::Failed, Outcome::NotApplicable}) {
            for (const Verdict& verdict : group) {
                if (verdict.outcome != outcome) {
                    continue;
                }
                if (outcome == Outcome::Failed) {
                    print_finding(out, verdict);
                } else {
                    out.line("  " + out.styled(Style::Dim, "not applicable  ") +
                             std::string{verdict.rule->id} + ": " + safe(verdict.found));
                }
            }
        }
    }
    out.line(std::to_string(verdicts.size()) + " rules: " + counts(verdicts));
}

std::string json_of(const std::vector<Verdict>& verdicts)
{
    JsonLine json;
    json.open_object().key("rules").open_array();
    for (const Verdict& verdict : verdicts) {
        json.open_object();
        members(json, *verdict.rule);
        json.member("outcome", name_of(verdict.outcome));
        json.member("found", std::string_view{verdict.found});
        json.member("seconds", verdict.seconds).close_object();
    }
    json.close_array();
    for (const Outcome outcome : outcomes) {
        json.key(outcome == Outcome::NotApplicable ? "notApplicable" : name_of(outcome))
            .number(static_cast<std::int64_t>(count(verdicts, outcome)));
    }
    return json.close_object().document();
}

std::string junit_of(const std::vector<Verdict>& verdicts)
{
    std::vector<JunitSuite> suites;
    for (const std::string_view service : services_of(verdicts)) {
        JunitSuite& suite = suites.emplace_back();
        suite.name = service;
        for (const Verdict& verdict : of_service(verdicts, service)) {
            suite.cases.push_back(case_of(verdict));
        }
    }
    return junit_report("busbar check", suites);
}

void print(Output& out, const std::vector<const SpecRule*>& rules)
{
    Table table{{{"ID"}, {"SERVICE"}, {"RULE", 24}, {"WANTED", 16}, {"SOURCE"}}};
    for (const SpecRule* rule : rules) {
        table.add({{std::string{rule->id}},
                   {std::string{rule->service}},
                   {std::string{rule->title}},
                   {rule->wanted.text()},
                   {std::string{rule->source}}});
    }
    table.print(out);
}

std::string json_of(const std::vector<const SpecRule*>& rules)
{
    JsonLine json;
    json.open_array();
    for (const SpecRule* rule : rules) {
        json.open_object();
        members(json, *rule);
        json.close_object();
    }
    return json.close_array().document();
}

} // namespace busbar::tool::rules
