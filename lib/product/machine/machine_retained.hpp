#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>

#include <busbar/controller/retained_values.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/server/process_image.hpp>

#include "machine_program.hpp"

namespace busbar::product {

/// The values of RETAIN variables, of whichever program a machine has: they come over restarts,
/// downloads and power cuts as the last scan had them that was saved, and with each later Write
/// that a client was told of.
///
/// Any thread, but all that saves waits for the storage; programs come on the server's thread.
class MachineRetained final : public server::ImageWriteLog {
public:
    /// Both must outlive it. `interval` is how often it is looked whether a value has changed.
    MachineRetained(Storage& storage, LogSink& log, Duration interval)
        : storage_{storage}, log_{log}, interval_{interval}
    {
    }

    /// `program`, whose task does not run, gets what is kept and is the one whose values are kept
    /// from now on. It is used until another one comes, but not itself.
    void keep(const MachineProgram& program);
    /// The program was edited online: keeps also what was added, drops what was deleted, and saves.
    void keep(const controller::ProgramAddition& added);
    /// Saves and keeps nothing until the next keep() of a program.
    void stop();
    /// Success if there is nothing to save. Failures are told once.
    [[nodiscard]] Stored<void> save();
    /// The same when it is time to; whether all is well.
    [[nodiscard]] bool save_when_due(TimePoint now);

    [[nodiscard]] bool keeps(const server::ProcessImage& image,
                             std::uint32_t handle) const override;
    /// Bad_ResourceUnavailable if they cannot be kept.
    [[nodiscard]] StatusCode keep(const server::ProcessImage& image,
                                  std::span<const server::ImageWrite> writes) override;

private:
    [[nodiscard]] Stored<void> told(Stored<void> saved);

    Storage& storage_;
    LogSink& log_;
    Duration interval_;
    std::mutex mutex_; // of the two below, of which only the server's thread changes the first
    std::optional<controller::RetainedValues> values_;
    bool is_told_{false}; // that they cannot be saved
};

} // namespace busbar::product
