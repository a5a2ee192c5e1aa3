#pragma once

#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/controller/execution_log_reader.hpp>
#include <busbar/controller/machine_event.hpp>

#include "trace.hpp"

namespace busbar::test {

/// What a controller said that it has saved has to be there whenever its logs are read. A record of
/// the simulation's own has a number in its name; the rest is what else happened.
class SavedRecords {
public:
    static constexpr std::size_t records_of_file = 100; // as the controller's log has them
    /// How the names of the simulation's own records begin.
    static constexpr std::string_view name{"Told"};

    explicit SavedRecords(Trace& trace) : trace_{&trace} {}

    /// The number of the next record.
    [[nodiscard]] std::uint64_t tell() { return ++told_; }
    /// All that were told are saved.
    void saved();
    /// Those that were not saved yet may be lost.
    void forget_unsaved() { first_unsaved_ = told_ + 1; }
    /// The log is removed, or some of it.
    void cleared() { saved_.clear(); }

    /// `damaged_lines` may be no records.
    void check(const controller::ExecutionLogContents& contents, std::size_t damaged_lines);

private:
    Trace* trace_;
    std::uint64_t told_{0};
    std::uint64_t first_unsaved_{1};
    /// As far as they were not in files that had to go.
    std::set<std::uint64_t> saved_;
};

/// The same of the events of a controller.
class SavedEvents {
public:
    explicit SavedEvents(Trace& trace) : trace_{&trace} {}

    void saved(std::vector<controller::MachineEvent> events) { events_ = std::move(events); }
    /// After a restart, when the log is loaded.
    void check(const std::vector<controller::MachineEvent>& events);

private:
    Trace* trace_;
    std::vector<controller::MachineEvent> events_;
};

} // namespace busbar::test
