#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/status_code.hpp>
#include <busbar/core/status_codes.hpp>

#include "tool/printing/output.hpp"

/// Rules of the specification as data: each asks a server one thing and knows the right answer.

namespace busbar::tool::rules {

class Subject;

/// The answer of a server to a rule.
struct Answer {
    enum class Kind : std::uint8_t {
        Status,        // this status came
        Right,         // everything is as the rule wants it
        Wrong,         // it is not; `text` says what came
        NotApplicable, // it cannot be asked here; `text` says why
    };
    Kind kind{Kind::Right};
    StatusCode status{};
    std::string text{};
};

/// Its name, or its number if it has none.
[[nodiscard]] std::string text_of(StatusCode status);
[[nodiscard]] inline Answer came(StatusCode status)
{
    return {Answer::Kind::Status, status, {}};
}
[[nodiscard]] inline Answer right()
{
    return {};
}
[[nodiscard]] inline Answer wrong(std::string text)
{
    return {Answer::Kind::Wrong, {}, std::move(text)};
}
[[nodiscard]] inline Answer not_applicable(std::string why)
{
    return {Answer::Kind::NotApplicable, {}, std::move(why)};
}
/// Right if `is_right`, otherwise wrong with the text.
[[nodiscard]] inline Answer expect(bool is_right, std::string text)
{
    return is_right ? right() : wrong(std::move(text));
}

/// The answer that a rule wants: one of some statuses, or what a text says.
class Wanted {
public:
    constexpr Wanted(StatusCode status) : statuses_{status}, count_{1} {}
    constexpr Wanted(std::initializer_list<StatusCode> statuses)
    {
        for (const StatusCode status : statuses) {
            statuses_[count_++] = status;
        }
    }
    constexpr Wanted(const char* text) : text_{text} {}

    [[nodiscard]] bool is_met_by(const Answer& answer) const;
    /// "Bad_NothingToDo or Bad_TooManyOperations".
    [[nodiscard]] std::string text() const;

private:
    std::array<StatusCode, 5> statuses_{};
    std::size_t count_{0};
    std::string_view text_;
};

/// Any of some statuses.
template <typename... Status>
[[nodiscard]] constexpr Wanted one_of(Status... statuses)
{
    return {StatusCode{statuses}...};
}

/// The requirement of a rule beside a server; without it the rule is not applicable.
enum class RuleNeed : std::uint8_t {
    Session,
    /// A channel without security, such as one for discovery.
    OpenChannel,
    /// A session whose messages are signed.
    Security,
    /// A Variable that the user gave for writing.
    Writable,
};

/// One rule.
struct SpecRule {
    /// Begins with the group: "read-nothing-to-do".
    std::string_view id;
    std::string_view service;
    std::string_view title;
    std::string_view request;
    Wanted wanted;
    /// "Part 4, 5.11.2.3".
    std::string_view source;
    Answer (*ask)(Subject& subject);
    RuleNeed need{RuleNeed::Session};
};

/// A group of rules, one for each file of them.
[[nodiscard]] std::span<const SpecRule> transport_rules();
[[nodiscard]] std::span<const SpecRule> discovery_rules();
[[nodiscard]] std::span<const SpecRule> session_rules();
[[nodiscard]] std::span<const SpecRule> read_rules();
[[nodiscard]] std::span<const SpecRule> value_rules();
[[nodiscard]] std::span<const SpecRule> browse_rules();
[[nodiscard]] std::span<const SpecRule> item_rules();
[[nodiscard]] std::span<const SpecRule> subscription_rules();

/// All of them, by group.
[[nodiscard]] std::vector<const SpecRule*> all_rules();
/// Returns the rules with these ids and the groups of these names, all if there are none, without
/// those that are skipped. Throws Failure for a name that fits no rule.
[[nodiscard]] std::vector<const SpecRule*> chosen_rules(const std::vector<std::string>& names,
                                                        const std::vector<std::string>& skipped);

/// The result of a rule.
struct Verdict {
    enum class Outcome : std::uint8_t { Passed, Failed, NotApplicable };

    const SpecRule* rule{nullptr};
    Outcome outcome{Outcome::Passed};
    /// The answer, or the reason why the rule cannot be applied.
    std::string found{};
    double seconds{0};
};

/// Carries a rule out.
[[nodiscard]] Verdict judge(const SpecRule& rule, Subject& subject);

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
