#include "programs/controller_simulation.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include <busbar/core/problem.hpp>

#include "product/configuration/reading.hpp"

namespace busbar::test {

// Whether a controller is as it is expected to be.

namespace {

std::string list_of(const std::set<std::string>& names)
{
    std::string all;
    for (const std::string& name : names) {
        all += " " + name;
    }
    return all;
}
std::string first_line(const std::string& text)
{
    return text.substr(0, text.find('\n'));
}

std::string wrong_setting(const Expectation& expected, const ControllerReport& report)
{
    for (const auto& [name, setting] : report.settings) {
        const std::string wanted = expected.setting(name);
        if (setting.value != wanted) {
            return name + " is " + setting.value + " instead of " + wanted;
        }
        if (!expected.is_online_unknown && setting.is_changed != expected.online.contains(name)) {
            return name + (setting.is_changed ? " is changed online" : " is the file's");
        }
    }
    return report.mode == expected.setting(mode_setting) ? std::string{}
                                                         : "it is in " + report.mode;
}

std::string wrong_program(const Expectation& expected, const ControllerReport& report)
{
    if (report.program != expected.program.text) {
        return "the program is " + first_line(report.program) + " instead of " +
               first_line(expected.program.text);
    }
    if (!expected.is_online_unknown && report.is_received != expected.is_received) {
        return report.is_received ? "the program is a received one" : "the program is the file's";
    }
    std::set<std::string> there;
    for (const auto& [name, value] : report.values) {
        there.insert(name);
    }
    return there == expected.program.variables
               ? std::string{}
               : "there are" + list_of(there) + " instead of" + list_of(expected.program.variables);
}

std::string wrong_value(const Expectation& expected, const ControllerReport& report)
{
    for (const auto& [name, value] : expected.retained) {
        const auto& found = report.values.at(name);
        if (value && found && found != value && !expected.doubtful.contains(name)) {
            return name + " is " + std::to_string(*found) + " instead of " + std::to_string(*value);
        }
    }
    return {};
}

std::string wrong_access(const Expectation& expected, const ControllerReport& report)
{
    for (const crypto::Certificate& each : ControllerSite::strangers()) {
        const std::string thumbprint = each.thumbprint_text();
        const bool is_trusted = report.trusted.contains(thumbprint);
        if (is_trusted != expected.trusted.contains(thumbprint) &&
            !expected.doubtful.contains(thumbprint)) {
            return thumbprint + (is_trusted ? " is" : " is not") + " trusted";
        }
    }
    if (report.closed_roles != expected.closed_roles) {
        return "closed are" + list_of(report.closed_roles) + " instead of" +
               list_of(expected.closed_roles);
    }
    std::set<std::string> users;
    for (const auto& [name, password] : expected.users) {
        users.insert(name);
    }
    return users == report.users
               ? std::string{}
               : "its users are" + list_of(report.users) + " instead of" + list_of(users);
}

} // namespace

/// Sessions end when it takes up another program, or starts again.
std::optional<ControllerReport> ControllerSimulation::report_now()
{
    constexpr int most = 20;
    std::optional<ControllerReport> report;
    for (int i = 0; i < most && !report && controller_->is_running(); ++i) {
        report = chief_->report(setting_names(), variable_names());
    }
    return report;
}

void ControllerSimulation::check()
{
    if (!violations_.empty() || (is_armed_ && !controller_->is_running())) {
        return;
    }
    const auto report = report_now();
    if (!report) {
        if (!is_armed_) {
            violation("it does not answer: " + chief_->why_not());
        }
        return;
    }
    std::string why_not;
    std::vector<Expectation> right;
    logins_.clear();
    for (const Expectation& each : expected_) {
        const std::string wrong = mismatch(each, *report);
        if (wrong.empty()) {
            right.push_back(each);
        } else {
            why_not += "\n  " + wrong;
        }
    }
    if (right.empty()) {
        if (!is_armed_ || controller_->is_running()) {
            violation("it is otherwise than expected:" + why_not);
        }
        return;
    }
    const bool is_stored = std::ranges::any_of(report->pending_changes, [](const auto& each) {
        return each.find("it is stored all the same") != std::string::npos;
    });
    for (Expectation& each : right) {
        learn(each, *report);
        if (!is_stored) {
            each.stored.reset();
        }
    }
    expected_.clear();
    for (const Expectation& each : right) {
        if (std::ranges::find(expected_, each) == expected_.end()) {
            expected_.push_back(each);
        }
    }
    if (expected_.size() == 1) {
        touched_.clear();
    }
    is_kept_ = is_kept_ || !is_armed_;
    check_consistent(*report);
}

void ControllerSimulation::adopt(const ControllerReport& report)
{
    Expectation& all = expected_.front();
    expected_.resize(1);
    all.online.clear();
    for (const auto& [name, setting] : report.settings) {
        if (setting.is_changed) {
            all.online[name] = setting.value;
        }
    }
    std::erase_if(all.users, [&](const auto& each) { return !report.users.contains(each.first); });
    for (const std::string& name : report.users) {
        all.users.try_emplace(name); // damaged by one bit, it is another name
    }
    touched_.clear();
    all.trusted.clear();
    for (const crypto::Certificate& each : ControllerSite::strangers()) {
        if (report.trusted.contains(each.thumbprint_text())) {
            all.trusted.insert(each.thumbprint_text());
        }
    }
    all.closed_roles = report.closed_roles;
    all.ports = {chief_->port()};
    all.program = {report.program, {}};
    all.is_received = report.is_received;
    all.retained.clear();
    for (const auto& [name, value] : report.values) {
        all.program.variables.insert(name);
        if (is_retained(name)) {
            all.retained[name] = value;
        }
    }
    all.doubtful.clear();
    all.stored.reset();
}

void ControllerSimulation::learn(Expectation& expected, const ControllerReport& report) const
{
    if (std::exchange(expected.is_online_unknown, false)) {
        expected.is_received = report.is_received;
        for (const auto& [name, setting] : report.settings) {
            if (!setting.is_changed) {
                expected.online.erase(name);
            }
        }
    }
    if (is_failing_) {
        return; // what cannot be kept may be otherwise at the next start
    }
    for (auto& [name, value] : expected.retained) {
        // A value that nobody wrote is saved by and by: it is known after a start only.
        if (is_fresh_ && (!value || expected.doubtful.contains(name))) {
            value = report.values.at(name);
        }
    }
    for (const crypto::Certificate& each : ControllerSite::strangers()) {
        const std::string thumbprint = each.thumbprint_text();
        if (expected.doubtful.contains(thumbprint)) {
            expected.trusted.erase(thumbprint);
            if (report.trusted.contains(thumbprint)) {
                expected.trusted.insert(thumbprint);
            }
        }
    }
    if (is_fresh_) {
        expected.doubtful.clear();
    }
}

std::string ControllerSimulation::mismatch(const Expectation& expected,
                                           const ControllerReport& report)
{
    for (const auto wrong : {wrong_setting, wrong_program, wrong_value, wrong_access}) {
        if (std::string text = wrong(expected, report); !text.empty()) {
            return text;
        }
    }
    if (std::string text = wrong_port(expected); !text.empty()) {
        return text;
    }
    return wrong_login(expected);
}

std::string ControllerSimulation::wrong_port(const Expectation& expected) const
{
    return expected.is_port_unknown || expected.ports.contains(chief_->port())
               ? std::string{}
               : "it listens on " + chief_->port() + " instead of" + list_of(expected.ports);
}

std::string ControllerSimulation::wrong_login(const Expectation& expected)
{
    for (const auto& [name, password] : expected.users) {
        if (!touched_.contains(name)) {
            continue;
        }
        const auto [login, is_new] = logins_.try_emplace(name + " " + password);
        if (is_new) {
            login->second = chief_->can_log_in(name, password);
        }
        if (login->second == false) {
            return name + " does not get in with " + password;
        }
    }
    return {};
}

void ControllerSimulation::check_closed(const Expectation& before, const ControllerReport& report)
{
    const bool is_damaged = std::ranges::any_of(report.pending_changes, [](const auto& each) {
        return each.find("roles.json") != std::string::npos;
    });
    if (is_damaged && !std::ranges::includes(report.closed_roles, before.closed_roles)) {
        violation("closed are" + list_of(report.closed_roles) + " after" +
                  list_of(before.closed_roles));
    }
}

void ControllerSimulation::check_consistent(const ControllerReport& report)
{
    const auto& settings = report.settings;
    if (std::to_string(report.max_sessions) != settings.at("limits.sessions").value) {
        violation("it serves " + std::to_string(report.max_sessions) +
                  " sessions, and limits.sessions is " + settings.at("limits.sessions").value);
    }
    for (const auto& [name, setting] : settings) {
        const bool is_pending =
            std::ranges::any_of(report.pending_changes, [start = name + ":"](const auto& each) {
                return each.starts_with(start);
            });
        if (setting.waits != is_pending) {
            violation(name + (setting.waits ? " waits for a restart and is not pending"
                                            : " does not wait for a restart and is pending"));
        }
    }
    check_explained(settings);
}

/// At the machine people are told the same.
void ControllerSimulation::check_explained(
    const std::map<std::string, ControllerReport::SettingReport>& settings)
{
    const bool is_of_file = std::ranges::all_of(
        expected_, [this](const Expectation& each) { return each.file == site_.settings; });
    if (!site_.is_file_good || !is_of_file) {
        return;
    }
    try {
        const product::Provenance provenance = product::provenance_of({.file = site_.file});
        for (const auto& setting : provenance.settings()) {
            const auto shown = settings.find(setting.name);
            if (shown == settings.end()) {
                continue;
            }
            const std::string told = setting_text(provenance.sayings(setting).back().value);
            if (told != shown->second.value) {
                violation(setting.name + " is " + shown->second.value + ", and " + told +
                          " for who asks --explain");
            }
        }
    } catch (const std::exception& error) {
        // The program's file counts for who asks at the machine, and not for the controller.
        if (site_.is_program_good) {
            violation(std::string{"--explain says: "} + error.what());
        }
    }
}

} // namespace busbar::test
