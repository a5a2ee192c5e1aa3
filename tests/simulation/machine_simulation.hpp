#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "controller/day/virtual_machine.hpp"
#include "disk_weather.hpp"
#include "machine_checks.hpp"

namespace busbar::test {

/// A controller whose media fail and whose power goes while people work with it, in virtual time.
/// The same seed makes the same things happen.
class MachineSimulation {
public:
    explicit MachineSimulation(std::uint64_t seed);

    void run(std::chrono::minutes time);
    /// The media are good again, and the controller starts: all has to be as it was saved.
    void finish();

    struct Attempts {
        std::size_t done{0};
        std::size_t failed{0};

        void count(bool is_done) { ++(is_done ? done : failed); }
    };
    /// How often something happened.
    struct Counts {
        Attempts downloads;
        Attempts restores;
        Attempts scans; // whose values were to be saved
        std::size_t power_cuts{0};
        std::size_t failed_starts{0};
        std::size_t readings{0}; // of the execution log
    };
    [[nodiscard]] const Counts& counts() const { return counts_; }
    [[nodiscard]] const Trace& trace() const { return trace_; }

private:
    // The power.
    void switch_on();
    void switch_off();
    void cut_power();

    // What people do.
    void act();
    void download();
    void restore();
    void back_up();
    void edit_online();
    void take_card_out();
    void put_card_in();
    void clear_log();

    // What the controller does each second.
    void tick();
    void scan();
    void tell_record();
    void check_saved();
    void check_log();
    [[nodiscard]] bool is_running() const;
    /// The settings were to get this port.
    void port_given(std::uint32_t port, bool is_done, Attempts& attempts);

    Scheduler scheduler_;
    JumpingClock clock_{scheduler_};
    Trace trace_{scheduler_};
    Chance chance_;
    storage::MemoryStorage memory_;
    storage::MemoryStorage card_;
    DiskWeather memory_weather_;
    DiskWeather card_weather_;
    std::optional<VirtualMachine> machine_;
    /// What of an earlier one still waits in the scheduler is not done.
    std::uint64_t machine_number_{0};
    controller::Program program_;
    bool is_cut_{false}; // the power is about to go
    bool has_started_{false};
    std::uint64_t last_name_{0};
    std::vector<std::byte> backup_;
    std::uint32_t backup_port_{0};
    std::int16_t saved_counter_{0};
    std::int16_t last_counter_{0};
    /// That which is saved, and those that were on the way when the power went.
    std::set<std::uint32_t> ports_;
    SavedRecords records_{trace_};
    SavedEvents events_{trace_};
    Counts counts_;
    Alarm tick_{scheduler_, [this] { tick(); }};
    Alarm act_{scheduler_, [this] { act(); }};
    Alarm off_{scheduler_, [this] { switch_off(); }};
    Alarm on_{scheduler_, [this] { switch_on(); }};
    Alarm card_in_{scheduler_, [this] { put_card_in(); }};
};

} // namespace busbar::test
