#pragma once

#include <mutex>
#include <optional>

#include <busbar/controller/retained_values.hpp>
#include <busbar/core/log.hpp>

#include "machine_program.hpp"

namespace busbar::product {

/// The values of RETAIN variables, of whichever program a machine has: they come over restarts,
/// downloads and power cuts as the last scan had them that was saved.
///
/// Any thread, but all that saves waits for the storage.
class MachineRetained {
public:
    /// Both must outlive it. `interval` is how often it is looked whether a value has changed.
    MachineRetained(Storage& storage, LogSink& log, Duration interval)
        : storage_{storage}, log_{log}, interval_{interval}
    {
    }

    /// `program`, whose task does not run, gets what is kept and is the one whose values are kept
    /// from now on. It is used until another one comes, but not itself.
    void keep(const MachineProgram& program);
    /// The program was edited online: keeps also what was added.
    void keep(const controller::ProgramAddition& added);
    /// Success if there is nothing to save. Failures are told once.
    [[nodiscard]] Stored<void> save();
    /// The same when it is time to; whether all is well.
    [[nodiscard]] bool save_when_due(TimePoint now);

private:
    [[nodiscard]] Stored<void> told(Stored<void> saved);

    Storage& storage_;
    LogSink& log_;
    Duration interval_;
    std::mutex mutex_; // of the two below
    std::optional<controller::RetainedValues> values_;
    bool is_told_{false}; // that they cannot be saved
};

} // namespace busbar::product
