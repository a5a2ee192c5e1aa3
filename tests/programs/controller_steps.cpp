#include "programs/controller_simulation.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string_view>
#include <thread>
#include <utility>

namespace busbar::test {

// What administrators and people at the machine do.

namespace {

std::size_t count_of(const std::string& text, std::string_view part)
{
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) {
        ++count;
    }
    return count;
}
} // namespace

void ControllerSimulation::act()
{
    switch (chance_.below(26)) {
    case 0:
    case 1:
    case 2:
        return set_settings();
    case 3:
    case 4:
    case 5:
        return change_users();
    case 6:
        return change_trust();
    case 7:
    case 8:
    case 9:
        return send_program();
    case 10:
        return expected_.front().is_received || chance_.one_in(3) ? restore_program()
                                                                  : send_program();
    case 11:
    case 12:
        return write_value();
    case 13:
        return restart();
    case 14:
        return reload();
    case 15:
    case 16:
        return change_files();
    case 17:
        return damage();
    case 18:
        return !backup_ || chance_.one_in(3) ? back_up() : restore();
    case 19:
    case 20:
        return change_roles();
    case 21:
    case 22:
    case 23:
        return move_listener();
    case 24:
        return chance_.one_in(2) ? reset() : set_settings();
    default:
        return chance_.one_in(2) ? clear() : back_up();
    }
}

void ControllerSimulation::follow(Outcome outcome, const std::string& what, const Change& change,
                                  const std::string& doubtful)
{
    switch (outcome) {
    case Outcome::Done:
        ++counts_.done;
        note(what + ": done");
        std::ranges::for_each(expected_, change);
        break;
    case Outcome::Refused:
        ++counts_.refused;
        note(what + ": refused, " + chief_->why_not());
        if (is_failing_ && !doubtful.empty()) {
            for (Expectation& each : expected_) {
                each.doubtful.insert(doubtful);
            }
        }
        break;
    case Outcome::Unknown:
        ++counts_.unknown;
        note(what + ": no answer, " + chief_->why_not());
        perhaps(change);
        break;
    }
}

void ControllerSimulation::perhaps(const Change& change)
{
    const std::vector<Expectation> before = expected_;
    std::ranges::for_each(expected_, change);
    for (const Expectation& each : before) {
        if (std::ranges::find(expected_, each) == expected_.end()) {
            expected_.push_back(each);
        }
    }
}

/// Some of them, as texts; an empty one takes back what was changed.
std::map<std::string, std::string> ControllerSimulation::draw_settings()
{
    std::map<std::string, std::string> texts;
    if (chance_.one_in(3)) {
        texts[mode_setting] = chance_.one_in(2) ? in_run : in_program;
        return texts;
    }
    const std::size_t count = 1 + chance_.below(3);
    for (std::size_t i = 0; i < count; ++i) {
        const DrawnSetting& setting = drawn_settings[chance_.below(drawn_settings.size())];
        const auto room = static_cast<std::size_t>(setting.most - setting.least);
        texts[setting.name] =
            chance_.one_in(4) ? std::string{}
            : setting.most == 0
                ? "Press " + std::to_string(site_.next_number())
                : std::to_string(setting.least + static_cast<std::int64_t>(chance_.below(room)));
    }
    return texts;
}

void ControllerSimulation::set_settings()
{
    const auto texts = draw_settings();
    std::map<std::string, Variant> values;
    std::string what = "set";
    for (const auto& [name, text] : texts) {
        values[name] = variant_of(name, text);
        what += " " + name + "=" + text;
    }
    if (chance_.one_in(6)) {
        values["limits.sessions"] = Variant{std::int64_t{1'000'000}};
        what += ", and too many sessions";
        const Outcome outcome = chief_->set(values);
        if (outcome == Outcome::Done) {
            violation(what + " was done");
        }
        return follow(outcome, what, [](Expectation&) {});
    }
    follow(chief_->set(values), what, [&](Expectation& all) {
        for (const auto& [name, text] : texts) {
            all.online.erase(name);
            if (!text.empty()) {
                all.online[name] = text;
            }
        }
    });
}

void ControllerSimulation::change_users()
{
    const std::string name = "user" + std::to_string(1 + chance_.below(3));
    const std::string password = "Long-Password-" + std::to_string(site_.next_number());
    touched_.insert(name);
    const bool is_there = expected_.front().users.contains(name);
    switch (is_there || chance_.one_in(6) ? chance_.below(3) : 0) {
    case 0:
        return follow(chief_->add_user(name, password), "add " + name + " with " + password,
                      [&](Expectation& all) { all.users[name] = password; });
    case 1:
        return follow(chief_->change_password(name, password),
                      "change the password of " + name + " to " + password,
                      [&](Expectation& all) { all.users[name] = password; });
    default:
        return follow(chief_->remove_user(name), "remove " + name,
                      [&](Expectation& all) { all.users.erase(name); });
    }
}

void ControllerSimulation::change_roles()
{
    const std::string role = drawn_roles[chance_.below(drawn_roles.size())];
    const bool closes = !expected_.front().closed_roles.contains(role);
    follow(chief_->close_role(role, closes), (closes ? "close " : "open ") + role,
           [&](Expectation& all) {
               all.closed_roles.erase(role);
               if (closes) {
                   all.closed_roles.insert(role);
               }
           });
}

void ControllerSimulation::change_trust()
{
    const auto& strangers = ControllerSite::strangers();
    const crypto::Certificate& one = strangers[chance_.below(strangers.size())];
    const std::string thumbprint = one.thumbprint_text();
    if (!expected_.front().trusted.contains(thumbprint) || chance_.one_in(4)) {
        const auto der = one.der();
        return follow(
            chief_->trust({der.begin(), der.end()}), "trust " + thumbprint,
            [&](Expectation& all) { all.trusted.insert(thumbprint); }, thumbprint);
    }
    follow(
        chief_->distrust(thumbprint), "distrust " + thumbprint,
        [&](Expectation& all) { all.trusted.erase(thumbprint); }, thumbprint);
}

void ControllerSimulation::send_program()
{
    const std::string name = "sent" + std::to_string(site_.next_number()) + ".st";
    const std::string verb = chance_.one_in(2) ? "edit " : "download ";
    if (chance_.one_in(6)) {
        const Outcome outcome =
            chief_->program(verb + name, "VAR_GLOBAL\n    Speed : INTEGER;\nEND_VAR\n");
        if (outcome == Outcome::Done) {
            violation("a wrong program was taken");
        }
        return follow(outcome, verb + "a wrong program", [](Expectation&) {});
    }
    const MachineText next = site_.new_program(chance_.one_in(5));
    const std::size_t before = said();
    Outcome outcome = chief_->program(verb + name, next.text);
    if (outcome == Outcome::Done && verb == "download ") {
        wait_for_effect(before);
    }
    if (verb == "download ") {
        return follow_program(outcome, verb + name, next, true);
    }
    follow(outcome, verb + name, [&](Expectation& all) {
        all.is_received = true;
        all.take_program(next);
    });
}

void ControllerSimulation::restore_program()
{
    const std::size_t before = said();
    const Outcome outcome = chief_->program("restore", {});
    if (outcome == Outcome::Done) {
        wait_for_effect(before);
    }
    follow_program(outcome, "restore the program", site_.program, false);
}

/// It may be refused after the answer, as the status says, while media fail, and where another
/// port, of which the file has told, is taken since.
void ControllerSimulation::follow_program(Outcome outcome, const std::string& what,
                                          const MachineText& next, bool is_received)
{
    const bool is_sure = !is_failing_ && site_.occupied().empty();
    follow(outcome == Outcome::Done && !is_sure ? Outcome::Unknown : outcome, what,
           [&](Expectation& all) {
               all.is_received = is_received;
               all.take_program(next);
           });
    if (!is_failing_ || outcome == Outcome::Refused) {
        return;
    }
    for (Expectation& each : expected_) {
        if (each.program.text != next.text || each.is_received != is_received) {
            each.stored = Expectation::Stored{next, is_received};
        }
    }
}

void ControllerSimulation::write_value()
{
    std::vector<std::string> names;
    for (const std::string& name : expected_.front().program.variables) {
        if (is_retained(name)) {
            names.push_back(name);
        }
    }
    const std::string name = names[chance_.below(names.size())];
    const std::int32_t value = site_.next_number();
    follow(
        chief_->write(name, value), "write " + name + " " + std::to_string(value),
        [&](Expectation& all) {
            if (all.program.variables.contains(name)) {
                all.retained[name] = value;
            }
        },
        name);
}

void ControllerSimulation::restart()
{
    const std::size_t before = said();
    const Outcome outcome = chief_->restart();
    if (outcome == Outcome::Done) {
        wait_for_effect(before);
    }
    note(outcome == Outcome::Done ? "restart: done" : "restart: not done, " + chief_->why_not());
    chief_->disconnect();
    if (outcome != Outcome::Refused) {
        perhaps([this](Expectation& all) { read_files(all); });
        listens_as_told_perhaps();
    }
}

std::size_t ControllerSimulation::said() const
{
    const std::string log = read_all(site_.log());
    return count_of(log, "read again: ") + count_of(log, "nothing was changed") +
           count_of(log, "downloaded: ") + count_of(log, "edited online: ");
}

std::size_t ControllerSimulation::started() const
{
    return count_of(read_all(site_.log()), "the OPC UA server runs at ");
}

void ControllerSimulation::wait_for_effect(std::size_t before)
{
    while (said() == before && controller_->is_running() && chief_->report({}, {}).has_value()) {
    }
}

/// Waits until it has said what came of it.
void ControllerSimulation::reload()
{
    const std::size_t before = said();
    note("is to read again");
    controller_->hang_up();
    wait_for_effect(before);
    perhaps([this](Expectation& all) { read_files(all); });
    listens_as_told_perhaps();
}

/// With a restart, or a program that is downloaded later.
void ControllerSimulation::listens_as_told_perhaps()
{
    for (Expectation& each : expected_) {
        each.ports.insert(each.file.at("port"));
    }
}

/// The file names another port, which may be taken until the next time.
void ControllerSimulation::move_listener()
{
    if (!site_.occupied().empty()) {
        note("the port " + site_.occupied() + " is free again");
        site_.release();
        return listens_as_told_perhaps(); // where it looks every few seconds
    }
    const std::string other = site_.other_port();
    const bool is_known = std::ranges::none_of(expected_, &Expectation::is_port_unknown);
    // It has kept where it listens, and listens there or where the file says.
    bool is_taken = is_known && chance_.one_in(3) && !is_failing_ && site_.occupy(other);
    if (is_taken && !controller_->is_running()) {
        site_.release();
        is_taken = false;
    }
    site_.settings["port"] = other;
    site_.write_configuration();
    note("the file names the port " + other + (is_taken ? ", which is taken" : ""));
    switch (chance_.below(3)) {
    case 0:
        return reload();
    case 1:
        return restart();
    default:
        break;
    }
}

void ControllerSimulation::change_files()
{
    const std::size_t what = chance_.below(6);
    if (what < 2) {
        const DrawnSetting& setting = drawn_settings[chance_.below(drawn_settings.size())];
        site_.settings[setting.name] =
            setting.most == 0
                ? "File " + std::to_string(site_.next_number())
                : std::to_string(setting.least + static_cast<std::int64_t>(chance_.below(10)));
        site_.write_configuration();
        note("the file says " + std::string{setting.name} + "=" + site_.settings[setting.name]);
    } else if (what < 4) {
        site_.program = site_.new_program(chance_.one_in(4));
        site_.write_program();
        note("there is another program in the file");
    } else if (is_kept_ && what == 4) {
        site_.damage_configuration();
        note("the file is damaged");
    } else if (is_kept_) {
        site_.damage_program();
        note("the program's file is damaged");
    }
    if (chance_.one_in(2)) {
        reload();
    }
}

/// Of one of its own files, of which nobody knows then what is left. All else is as it was.
void ControllerSimulation::damage()
{
    if (!is_kept_ || is_armed_ || !site_.is_file_good || !site_.is_program_good ||
        !site_.occupied().empty()) {
        return;
    }
    chief_->disconnect();
    controller_->kill();
    const auto files = site_.kept_files();
    const fs::path& one = files[chance_.below(files.size())];
    std::string content = read_all(one);
    switch (chance_.below(4)) {
    case 0:
        content.clear();
        break;
    case 1:
        content.resize(content.size() / 2);
        break;
    case 2:
        content += "damage";
        break;
    default:
        if (!content.empty()) {
            content[chance_.below(content.size())] ^= 1;
        }
    }
    std::ofstream{one, std::ios::binary} << content;
    note("damaged: " + one.string());
    const Expectation before = expected_.front();
    start();
    if (!violations_.empty()) {
        return;
    }
    if (const auto report = report_now()) {
        check_closed(before, *report);
        adopt(*report);
    } else {
        violation("it does not answer: " + chief_->why_not());
    }
}

void ControllerSimulation::back_up()
{
    if (auto file = chief_->back_up()) {
        backup_ = std::move(file);
        backed_up_ = expected_;
        note("is backed up");
    } else {
        note("is not backed up: " + chief_->why_not());
    }
}

void ControllerSimulation::restore()
{
    if (!backup_ || !site_.is_file_good || !site_.is_program_good || !site_.occupied().empty()) {
        return;
    }
    const Outcome outcome = chief_->replace_memory("restore", *backup_);
    is_restart_due_ = outcome == Outcome::Done;
    std::vector<Expectation> before = expected_;
    follow(outcome, "restore the backup", [](Expectation&) {});
    if (outcome == Outcome::Refused) {
        return;
    }
    expected_ = backed_up_;
    for (Expectation& each : expected_) {
        const Expectation was = each;
        for (const std::string& name : setting_names()) {
            each.online[name] = was.setting(name);
        }
        each.is_online_unknown = true;
        each.is_port_unknown = true;
        each.is_received = true;
        for (const auto& [name, password] : each.users) {
            touched_.insert(name);
        }
    }
    if (outcome == Outcome::Unknown) {
        expected_.insert(expected_.end(), before.begin(), before.end());
    }
}

void ControllerSimulation::clear()
{
    if (!site_.is_file_good || !site_.is_program_good) {
        return; // what it ran with last may come back
    }
    const bool is_all = chance_.one_in(2);
    const std::string what = is_all ? "clear with security" : "clear";
    const Outcome outcome = chief_->replace_memory(what, {});
    is_restart_due_ = outcome == Outcome::Done;
    follow(outcome, what, [&](Expectation& all) {
        all.online.clear();
        all.is_port_unknown = false;
        all.is_received = false;
        all.take_program(site_.program);
        for (auto& [name, value] : all.retained) {
            value.reset();
        }
        if (is_all) {
            all.users.clear();
            all.trusted.clear();
            all.closed_roles.clear();
        }
    });
    if (is_all && outcome != Outcome::Refused) {
        chief_->disconnect();
        controller_->kill();
        meet_again();
    }
}

/// All that was changed online is forgotten, but for what is not configuration. It starts again by
/// itself, with another certificate; whatever its files are.
void ControllerSimulation::reset()
{
    if (!site_.is_file_good || !site_.is_program_good || !site_.occupied().empty()) {
        return; // what it ran with last may come back
    }
    const std::size_t starts = started();
    const Outcome outcome = chief_->reset();
    follow(outcome, "reset", [&](Expectation& all) {
        all.online.clear();
        all.is_port_unknown = false;
        all.is_received = false;
        all.take_program(site_.program);
        all.users.clear();
        all.trusted.clear();
        all.closed_roles.clear();
    });
    if (outcome == Outcome::Refused) {
        return;
    }
    chief_->disconnect();
    while (outcome == Outcome::Done && controller_->is_running() && started() == starts) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    is_restart_due_ = true;
    controller_->kill();
    meet_again();
}

/// People at the machine have it trust the administrator, and he meets a controller with another
/// certificate.
void ControllerSimulation::meet_again()
{
    controller_->calm(); // it finishes clearing
    if (controller_->start() != ForkedController::Start::Serves) {
        return violation("it does not start: " + controller_->why_not());
    }
    controller_->kill();
    site_.lay_certificate();
    site_.forget_controller();
}
} // namespace busbar::test
