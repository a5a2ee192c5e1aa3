#include "machine_simulation.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include "controller/logs/log_fixture.hpp"
#include "controller/publishing/program_parts.hpp"

namespace busbar::test {

using namespace controller;
using namespace std::chrono_literals;

namespace {

constexpr std::int16_t last_count = 32'000;

/// With a counter that is kept and others.
Program counting_program(std::size_t others)
{
    Program program;
    program.variables = controller::test::numbered(others);
    program.variables.insert(program.variables.begin(), controller::test::variable("Counter"));
    program.variables.front().is_retained = true;
    return program;
}

ServerSettings settings_at(std::uint32_t port)
{
    return {
        .is_used = true, .port = port, .execution_log = {true, 3, SavedRecords::records_of_file}};
}

} // namespace

MachineSimulation::MachineSimulation(std::uint64_t seed)
    : chance_{seed, 1}, memory_weather_{scheduler_, trace_, memory_, 1, Chance{seed, 2}},
      card_weather_{scheduler_, trace_, card_, 2, Chance{seed, 3}}, program_{counting_program(2)}
{
    MachineSettings settings{memory_, "server.json", "security.json", "transaction"};
    ports_ = {ServerSettings{}.port};
    REQUIRE(settings.transfer(settings_at(*ports_.begin()), MachineMode::Program));
}

bool MachineSimulation::is_running() const
{
    return machine_ && machine_->life.operating_status() == OperatingStatus::Running;
}

void MachineSimulation::run(std::chrono::minutes time)
{
    memory_weather_.start();
    card_weather_.start();
    switch_on();
    act_.set_after(1min);
    scheduler_.run_for(time);
}

void MachineSimulation::finish()
{
    act_.cancel();
    memory_weather_.stop();
    card_weather_.stop();
    card_in_.cancel();
    put_card_in();
    switch_off();
    memory_.restore_power(); // no fault waits any more
    card_.restore_power();
    scheduler_.run_for(10min);
    if (!is_running() || !machine_->is_open) {
        trace_.violation(3, "does not run on good media");
    } else if (machine_->execution_log->waiting() != 0 || !machine_->restored.problems.empty() ||
               machine_->event_log->plc_error()) {
        trace_.violation(3, "has not recovered on good media");
    }
    check_log();
    machine_.reset();
}

// The power.

void MachineSimulation::switch_on()
{
    const std::uint64_t number = ++machine_number_;
    machine_.emplace(memory_, card_, clock_, [this, number](Duration delay, auto what) {
        scheduler_.after(delay, [this, number, what = std::move(what)] {
            if (number == machine_number_) {
                what();
            }
        });
    });
    machine_->program = program_;
    machine_->power_on();
    has_started_ = false;
    tick_.set_after(1s);
}

void MachineSimulation::switch_off()
{
    if (!machine_) {
        return;
    }
    trace_.note(3, is_cut_ ? "the power goes" : "is switched off");
    program_ = machine_->program;
    tick_.cancel();
    off_.cancel();
    machine_.reset();
    ++machine_number_;
    records_.forget_unsaved();
    if (std::exchange(is_cut_, false)) {
        ++counts_.power_cuts;
        memory_.restore_power();
        card_.restore_power();
    }
    on_.set_after(chance_.between(1s, 1min));
}

/// In some seconds, and perhaps while one of the media is written.
void MachineSimulation::cut_power()
{
    is_cut_ = true;
    storage::MemoryStorage& medium = chance_.one_in(3) ? card_ : memory_;
    medium.cut_power_after(chance_.below(chance_.pick<std::size_t>({10, 300, 3'000})));
    off_.set_after(chance_.between(10ms, 10s));
}

// What people do.

void MachineSimulation::act()
{
    act_.set_after(chance_.between(5s, 4min));
    if (!machine_) {
        return;
    }
    const OperatingStatus status = machine_->life.operating_status();
    if (status == OperatingStatus::Shutdown || machine_->life.is_restart_due()) {
        return switch_off();
    }
    switch (chance_.below(12)) {
    case 0:
    case 1:
        return download();
    case 2:
        return restore();
    case 3:
        return back_up();
    case 4:
        return edit_online();
    case 5:
        return take_card_out();
    case 6:
    case 7:
        return cut_power();
    case 8:
        machine_->life.power_going();
        return switch_off();
    case 9:
        return clock_.jump(chance_.pick({chance_.between(-5s, 5s), chance_.between(-6h, 6h)}));
    case 10:
        if (chance_.one_in(5)) {
            return clear_log();
        }
        break;
    default:
        machine_->change_address("192.168.250." + std::to_string(1 + chance_.below(3)));
    }
}

void MachineSimulation::download()
{
    // None that a controller has which could not read its settings.
    const auto port = static_cast<std::uint32_t>(ServerSettings{}.port + 1 + chance_.below(1'000));
    machine_->download(counting_program(chance_.pick<std::size_t>({0, 1, 5, 60})),
                       settings_at(port));
    port_given(port, machine_->settings.server().port == port, counts_.downloads);
}

void MachineSimulation::restore()
{
    if (!backup_.empty()) {
        port_given(backup_port_, machine_->restore(backup_).has_value(), counts_.restores);
    }
}

void MachineSimulation::port_given(std::uint32_t port, bool is_done, Attempts& attempts)
{
    attempts.count(is_done);
    trace_.note(3, is_done ? "has a port" : "gets no port", port);
    if (is_done) {
        ports_ = {port};
    } else if (is_cut_) {
        ports_.insert(port);
    }
}

void MachineSimulation::back_up()
{
    if (!is_running()) {
        return;
    }
    if (auto backup = machine_->data.backup({"press 4", clock_.now()})) {
        backup_ = *std::move(backup);
        backup_port_ = machine_->settings.server().port;
    }
}

void MachineSimulation::edit_online()
{
    if (is_running()) {
        machine_->edit_online(controller::test::variable("Late" + std::to_string(++last_name_)));
    }
}

/// With the switch or without.
void MachineSimulation::take_card_out()
{
    if (card_in_.is_set()) {
        return;
    }
    if (chance_.one_in(2)) {
        machine_->release_card();
        machine_->card_is_in(false);
    }
    card_.set_away(true);
    card_in_.set_after(chance_.between(1s, 5min));
}

void MachineSimulation::put_card_in()
{
    card_.set_away(false);
    if (machine_) {
        machine_->card_is_in(true);
    }
}

void MachineSimulation::clear_log()
{
    static_cast<void>(machine_->execution_log->clear());
    records_.cleared();
}

// What the controller does each second.

void MachineSimulation::tick()
{
    tick_.set_after(1s);
    const OperatingStatus status = machine_->life.operating_status();
    if (is_running()) {
        scan();
    } else if (status == OperatingStatus::HaltError && chance_.one_in(60)) {
        ++counts_.failed_starts;
        return switch_off();
    }
    if (chance_.one_in(15)) {
        tell_record();
    }
    machine_->work();
    check_saved();
    if (chance_.one_in(120)) {
        check_log();
    }
}

void MachineSimulation::scan()
{
    const std::uint32_t port = machine_->settings.server().port;
    if (!ports_.contains(port)) {
        trace_.violation(3, "has port " + std::to_string(port));
    }
    ports_ = {port};
    // It is told when values cannot be read, and those of the program count then.
    const bool is_told = !machine_->restored.problems.empty();
    const std::int16_t counter = machine_->counter();
    if (!is_told && (counter < saved_counter_ || counter > last_counter_)) {
        trace_.violation(3, "counts " + std::to_string(counter) + " where " +
                                std::to_string(saved_counter_) + " is saved");
    }
    if (!chance_.one_in(30) || counter == last_count) {
        return;
    }
    const auto next = static_cast<std::int16_t>(counter + 1);
    const bool is_saved = machine_->scan(next).has_value();
    counts_.scans.count(is_saved);
    saved_counter_ = is_saved ? next : std::min(saved_counter_, next);
    last_counter_ = is_saved ? next : std::max(last_counter_, next);
}

void MachineSimulation::tell_record()
{
    const auto record =
        published(std::string{SavedRecords::name} + std::to_string(records_.tell()), 2, 1, 0);
    busbar::tell(*machine_->execution_log, record.record());
}

void MachineSimulation::check_saved()
{
    ExecutionLog& log = *machine_->execution_log;
    if (log.lost() != 0) {
        trace_.violation(2, "records are lost");
    }
    if (log.write_pending() && log.waiting() == 0) {
        records_.saved();
    }
    if (!machine_->event_log->write_pending()) {
        return;
    }
    auto events = machine_->event_log->events();
    if (!std::exchange(has_started_, true)) {
        events_.check(events);
    }
    events_.saved(std::move(events));
}

void MachineSimulation::check_log()
{
    const auto contents = read_execution_log(card_, ExecutionLogOptions{}.folder, {}, 1'000);
    if (contents) {
        ++counts_.readings;
        records_.check(*contents, card_weather_.full_spells());
    }
}

} // namespace busbar::test
