#include "programs/controller_simulation.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>

namespace busbar::test {

std::string Expectation::setting(const std::string& name) const
{
    const auto changed = online.find(name);
    return changed != online.end() ? changed->second : file.at(name);
}

void Expectation::take_program(const MachineText& next)
{
    program = next;
    stored.reset();
    std::erase_if(retained, [&](const auto& each) { return !next.variables.contains(each.first); });
    for (const std::string& name : next.variables) {
        if (is_retained(name)) {
            retained.emplace(name, std::nullopt);
        }
    }
}

bool operator==(const Expectation& a, const Expectation& b)
{
    const auto stored_text = [](const Expectation& all) {
        return all.stored ? std::optional{all.stored->program.text} : std::nullopt;
    };
    return stored_text(a) == stored_text(b) && a.online == b.online &&
           a.is_online_unknown == b.is_online_unknown && a.users == b.users &&
           a.trusted == b.trusted && a.closed_roles == b.closed_roles &&
           a.program.text == b.program.text && a.is_received == b.is_received &&
           a.retained == b.retained && a.file == b.file && a.ports == b.ports &&
           a.is_port_unknown == b.is_port_unknown && a.doubtful == b.doubtful;
}

ControllerSimulation::ControllerSimulation(std::uint64_t seed)
    : chance_{seed, 2}, controller_{std::make_unique<ForkedController>(
                            product::Configuration{.file = site_.file}, site_.log().string())}
{
    chief_ = std::make_unique<ControllerAdministrator>(
        site_.ports, (site_.folder.path / "client").string(), ControllerSite::password);
    Expectation first;
    read_files(first);
    expected_ = {first};
    start();
    check();
    site_.keep_own_certificate();
}

void ControllerSimulation::run(std::size_t steps)
{
    for (std::size_t i = 0; i < steps && violations_.empty(); ++i) {
        is_fresh_ = false;
        arm();
        act();
        if (!violations_.empty()) {
            break;
        }
        if (!controller_->is_running() || is_restart_due_ || chance_.one_in(2)) {
            power_cycle();
        }
        check();
    }
    if (violations_.empty()) {
        power_cycle();
        check();
    }
    chief_->disconnect();
}

std::string ControllerSimulation::story() const
{
    std::string all;
    for (const std::string& line : story_) {
        all += line + "\n";
    }
    return all + "the controller's log:\n" + read_all(site_.log());
}

void ControllerSimulation::note(const std::string& what)
{
    story_.push_back(what);
    std::ofstream{site_.log(), std::ios::app} << "# " << what << "\n";
    if (std::getenv("BUSBAR_SIMULATION_TRACE") != nullptr) {
        std::fprintf(stderr, "%s\n", what.c_str());
    }
}

void ControllerSimulation::violation(const std::string& what)
{
    note("VIOLATION: " + what);
    violations_.push_back(what);
}

// The power.

void ControllerSimulation::arm()
{
    if (is_armed_) {
        return;
    }
    const auto fault = controller_->draw_fault(chance_);
    if (!fault) {
        return;
    }
    note(fault->text);
    counts_.faults += fault->is_of_media ? 1 : 0;
    is_failing_ = fault->is_of_media;
    is_armed_ = true;
    is_kept_ = false;
}

void ControllerSimulation::power_cycle()
{
    if (!controller_->is_running()) {
        note("it was killed");
        ++counts_.kills;
    } else if (chance_.one_in(5)) {
        note("is switched off");
        chief_->disconnect();
        controller_->terminate();
    } else {
        note("the power goes");
    }
    controller_->kill();
    chief_->disconnect();
    controller_->calm();
    if (chance_.one_in(6)) {
        failing_disk::Orders& orders = controller_->orders();
        orders.killed_at = orders.calls + chance_.below(25);
        note("is to be killed in the call " + std::to_string(orders.killed_at - orders.calls) +
             " of its start");
        if (controller_->start() == ForkedController::Start::Killed) {
            ++counts_.kills;
        }
        controller_->kill();
        controller_->calm();
    }
    start();
    if (chance_.one_in(6) && violations_.empty()) {
        start_on_failing_media();
    }
}

/// It has started before, so that it starts whatever becomes of its media, and with all it had.
void ControllerSimulation::start_on_failing_media()
{
    check(); // which tells what there is
    chief_->disconnect();
    controller_->kill();
    failing_disk::Orders& orders = controller_->orders();
    orders.error = chance_.pick({ENOSPC, EIO, EROFS, EACCES});
    orders.fails_from = orders.calls + chance_.below(15);
    orders.fails_until = failing_disk::Orders::never;
    note("starts on media that fail with " + std::to_string(orders.error) + " from the call " +
         std::to_string(orders.fails_from - orders.calls));
    start();
    is_armed_ = true;
    is_failing_ = true;
    check();
}

void ControllerSimulation::start()
{
    ++counts_.starts;
    is_armed_ = false;
    is_failing_ = false;
    is_fresh_ = true;
    is_restart_due_ = false;
    is_kept_ = false;
    if (controller_->start() != ForkedController::Start::Serves) {
        return violation("it does not start: " + controller_->why_not());
    }
    const std::size_t count = expected_.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (const auto stored = std::exchange(expected_[i].stored, std::nullopt)) {
            expected_.push_back(expected_[i]);
            expected_.back().is_received = stored->is_received;
            expected_.back().take_program(stored->program);
        }
    }
    for (Expectation& each : expected_) {
        read_files(each);
        listen(each);
    }
}

/// On a port that is taken it cannot: it listens where it did last.
void ControllerSimulation::listen(Expectation& all) const
{
    const std::string& told = all.file.at("port");
    if (told == site_.occupied()) {
        all.ports.erase(told);
    } else {
        all.ports = {told};
    }
}

void ControllerSimulation::read_files(Expectation& all) const
{
    const bool is_good = site_.is_file_good && (all.is_received || site_.is_program_good);
    if (!is_good) {
        return; // what it ran with last counts
    }
    all.file = site_.settings;
    if (!all.is_received) {
        all.take_program(site_.program);
    }
}
} // namespace busbar::test
