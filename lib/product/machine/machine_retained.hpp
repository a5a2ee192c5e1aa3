#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>

#include <busbar/controller/backup.hpp>
#include <busbar/controller/retained_values.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/server/process_image.hpp>

#include "machine_program.hpp"

namespace busbar::product {

/// Keeps the values of RETAIN variables of the machine's present program. They survive restarts,
/// downloads and power cuts as of the last saved scan, with every later Write that was confirmed to
/// a client.
///
/// Thread-safe; functions that save wait for the storage. Programs are set on the server's thread.
class MachineRetained final : public server::ImageWriteLog {
public:
    /// Both must outlive this object. `interval` is the time between checks for changed values.
    MachineRetained(Storage& storage, LogSink& log, Duration interval)
        : storage_{storage}, log_{log}, interval_{interval}
    {
    }

    /// Gives `program`, whose task must not run, the saved values, and saves its values from now
    /// on. Its image is used until the next program comes, but not `program` itself.
    void keep(const MachineProgram& program);
    /// Adapts to an online edit: keeps added variables, too, drops deleted ones, and saves.
    void keep(const controller::ProgramAddition& added);
    /// Saves once more and then nothing until the next keep() of a program.
    void stop();
    /// Saves; success if there is nothing to save. Failures are reported once.
    [[nodiscard]] Stored<void> save();
    /// Does the same when it is due; true if everything is in order.
    [[nodiscard]] bool save_when_due(TimePoint now);

    [[nodiscard]] bool keeps(const server::ProcessImage& image,
                             std::uint32_t handle) const override;
    /// Bad_ResourceUnavailable if the writes cannot be kept.
    [[nodiscard]] StatusCode keep(const server::ProcessImage& image,
                                  std::span<const server::ImageWrite> writes) override;

private:
    [[nodiscard]] Stored<void> told(Stored<void> saved);

    Storage& storage_;
    LogSink& log_;
    Duration interval_;
    std::mutex mutex_; // guards the two below; only the server's thread changes the first
    std::optional<controller::RetainedValues> values_;
    bool is_told_{false}; // whether a failure to save was reported
};

/// Values of RETAIN variables in backups. They are stored in `state`. A restore, which changes
/// several files together or not at all, leaves them beside the other files, and take_up_values()
/// moves them to their place before the next program starts.
inline constexpr std::string_view restored_values_name = "retained.restored";

/// Returns the item for a MachineMemory of the other files; `state` must outlive it.
[[nodiscard]] controller::MemoryItem values_item(Storage& state);
/// Replaces the values in `state` by those that a restore or a clearing left in `files`. Succeeds
/// if there are none; after a problem the next call continues.
[[nodiscard]] Configured<void> take_up_values(Storage& files, Storage& state);

} // namespace busbar::product
