#include <algorithm>
#include <memory>

#include "commands.hpp"
#include "tool/check/rule.hpp"
#include "tool/check/subject.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool {

namespace {

using rules::SpecRule;
using rules::Verdict;

struct CheckArguments {
    std::vector<std::string> url;
    std::vector<std::string> rules;
    std::vector<std::string> skipped;
    std::string writable;
    std::string junit;
    double rule_timeout{5};
    bool lists{false};
};

Exit list_rules(Context& context, const std::vector<const SpecRule*>& chosen)
{
    if (context.options.is_json) {
        context.out.line(rules::json_of(chosen));
    } else {
        rules::print(context.out, chosen);
    }
    return Exit::Good;
}

std::vector<Verdict> judge_all(Context& context, const CheckArguments& arguments,
                               const std::vector<const SpecRule*>& chosen)
{
    Connection connection{context};
    std::optional<NodeId> writable;
    if (!arguments.writable.empty()) {
        writable = find_node(connection, arguments.writable);
    }
    rules::Subject subject{
        connection,
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>{arguments.rule_timeout}),
        writable};
    std::vector<Verdict> verdicts;
    for (const SpecRule* rule : chosen) {
        verdicts.push_back(judge(*rule, subject));
    }
    return verdicts;
}

Exit check_server(Context& context, const CheckArguments& arguments)
{
    const std::vector<const SpecRule*> chosen =
        rules::chosen_rules(arguments.rules, arguments.skipped);
    if (arguments.lists) {
        return list_rules(context, chosen);
    }
    const std::vector<Verdict> verdicts = judge_all(context, arguments, chosen);
    if (!arguments.junit.empty()) {
        write_file(arguments.junit, rules::junit_of(verdicts));
    }
    if (context.options.is_json) {
        context.out.line(rules::json_of(verdicts));
    } else {
        rules::print(context.out, verdicts);
    }
    return rules::count(verdicts, Verdict::Outcome::Failed) == 0 ? Exit::Good : Exit::Failed;
}

} // namespace

void add_check(CLI::App& app, Run& run)
{
    auto* command =
        app.add_subcommand("check", "Checks a server against rules of the specification.");
    const auto arguments = std::make_shared<CheckArguments>();
    command->add_option("URL", arguments->url, "server");
    command->add_option("--rule", arguments->rules, "only these rules, or groups such as read")
        ->type_name("ID,...")
        ->delimiter(',')
        ->expected(1)
        ->take_all();
    command->add_option("--skip", arguments->skipped, "not these rules, or groups")
        ->type_name("ID,...")
        ->delimiter(',')
        ->expected(1)
        ->take_all();
    command
        ->add_option("--allow-write", arguments->writable,
                     "a Variable that may be written; its value is restored")
        ->type_name("NODE");
    command->add_option("--junit", arguments->junit, "also write the results as JUnit does")
        ->type_name("FILE");
    command->add_option("--rule-timeout", arguments->rule_timeout, "for each rule")
        ->check(CLI::Range(0.1, 3'600.0))
        ->type_name("SECONDS")
        ->capture_default_str();
    command->add_flag("--list", arguments->lists, "only list the rules, without a server");
    command->footer("A rule that cannot be asked here is not applicable, which is neither a pass\n"
                    "nor a finding. Exit codes: 0 no finding, 1 findings; others as always.");
    when_chosen(*command, run, [arguments](Context& context) {
        take_only_url(arguments->url, context.options);
        return check_server(context, *arguments);
    });
}

} // namespace busbar::tool
