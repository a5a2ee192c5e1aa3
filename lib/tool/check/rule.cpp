#include "rule.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>

#include "subject.hpp"
#include "tool/connection/failure.hpp"

namespace busbar::tool::rules {

namespace {

/// Services that no profile makes optional (Part 7, Core Server Facets).
constexpr std::array<std::string_view, 8> required_services = {
    "GetEndpoints",  "FindServers",     "OpenSecureChannel",
    "CreateSession", "ActivateSession", "CloseSession",
    "Read",          "Browse"};

bool is_of(const SpecRule& rule, std::string_view name)
{
    return rule.id == name || (rule.id.starts_with(name) && rule.id[name.size()] == '-');
}

bool is_among(const SpecRule& rule, const std::vector<std::string>& names)
{
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return is_of(rule, name); });
}

void check_names(const std::vector<const SpecRule*>& all, const std::vector<std::string>& names)
{
    for (const std::string& name : names) {
        if (std::any_of(all.begin(), all.end(),
                        [&](const SpecRule* rule) { return is_of(*rule, name); })) {
            continue;
        }
        std::vector<std::string> ids;
        for (const SpecRule* rule : all) {
            ids.emplace_back(rule->id);
        }
        const std::string meant = nearest(name, ids);
        throw Failure{Exit::Usage, name + ": there is no such rule",
                      meant.empty() ? "`busbar check --list` has their names"
                                    : "perhaps " + meant + " is meant"};
    }
}

Answer ask(const SpecRule& rule, Subject& subject)
{
    try {
        subject.begin();
        if (std::string lack = subject.lacks(rule.need); !lack.empty()) {
            return not_applicable(std::move(lack));
        }
        subject.begin();
        return rule.ask(subject);
    } catch (const Unreachable& unreachable) {
        return subject.note_unreachable()
                   ? wrong("no connection: " + text_of(unreachable.status))
                   : not_applicable("the server could not be reached any more");
    } catch (const Refused& refused) {
        return refused.status == status::Bad_ServiceUnsupported
                   ? not_applicable("the server does not have " + refused.what)
                   : wrong(refused.what + ": " + text_of(refused.status));
    } catch (const NoAnswer& none) {
        return wrong(none.text + (none.status.is_good() ? "" : ": " + text_of(none.status)));
    }
}

std::string found_text(const Answer& answer)
{
    return answer.kind == Answer::Kind::Status ? text_of(answer.status) : answer.text;
}

} // namespace

std::string text_of(StatusCode status)
{
    if (const std::string_view known = name(status); !known.empty()) {
        return std::string{known};
    }
    char number[16];
    std::snprintf(number, sizeof number, "0x%08X", static_cast<unsigned>(status.value()));
    return number;
}

bool Wanted::is_met_by(const Answer& answer) const
{
    if (answer.kind != Answer::Kind::Status) {
        return answer.kind == Answer::Kind::Right;
    }
    const auto* const end = statuses_.data() + count_;
    return std::find(statuses_.data(), end, answer.status.code()) != end;
}

std::string Wanted::text() const
{
    std::string text{text_};
    for (std::size_t i = 0; i < count_; ++i) {
        text += (i == 0 ? "" : i + 1 == count_ ? " or " : ", ") + text_of(statuses_[i]);
    }
    return text;
}

std::vector<const SpecRule*> all_rules()
{
    std::vector<const SpecRule*> all;
    for (const std::span<const SpecRule> group :
         {transport_rules(), discovery_rules(), session_rules(), read_rules(), value_rules(),
          browse_rules(), item_rules(), subscription_rules()}) {
        for (const SpecRule& rule : group) {
            all.push_back(&rule);
        }
    }
    return all;
}

std::vector<const SpecRule*> chosen_rules(const std::vector<std::string>& names,
                                          const std::vector<std::string>& skipped)
{
    std::vector<const SpecRule*> all = all_rules();
    check_names(all, names);
    check_names(all, skipped);
    std::erase_if(all, [&](const SpecRule* rule) {
        return (!names.empty() && !is_among(*rule, names)) || is_among(*rule, skipped);
    });
    return all;
}

Verdict judge(const SpecRule& rule, Subject& subject)
{
    const auto begin = Clock::now();
    Answer answer = ask(rule, subject);
    Verdict verdict{&rule, Verdict::Outcome::Failed, found_text(answer), 0};
    const bool is_required = std::find(required_services.begin(), required_services.end(),
                                       rule.service) != required_services.end();
    if (answer.kind == Answer::Kind::NotApplicable) {
        verdict.outcome = Verdict::Outcome::NotApplicable;
    } else if (rule.wanted.is_met_by(answer)) {
        verdict.outcome = Verdict::Outcome::Passed;
    } else if (answer.kind == Answer::Kind::Status && !is_required &&
               answer.status == status::Bad_ServiceUnsupported) {
        verdict.outcome = Verdict::Outcome::NotApplicable;
        verdict.found = "the server does not have the service";
    }
    verdict.seconds = std::chrono::duration<double>{Clock::now() - begin}.count();
    return verdict;
}

} // namespace busbar::tool::rules
