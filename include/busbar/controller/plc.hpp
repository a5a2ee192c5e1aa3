#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/plc_config.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/process_image.hpp>

namespace busbar::controller {

class InstructionDesk;
class ProgramImage;
class ProgramTypes;

namespace detail {
class PlcStep;
class PlcWatch;
} // namespace detail

/// Changes the values of a PLC's variables.
class BUSBAR_API PlcLogic {
public:
    PlcLogic() = default;
    PlcLogic(const PlcLogic&) = delete;
    PlcLogic& operator=(const PlcLogic&) = delete;
    virtual ~PlcLogic() = default;

    /// Called in each scan, after clients' writes were applied and before values are published, by
    /// the scanning thread: it must not wait. `elapsed` is the time since the previous scan.
    virtual void scan(DateTime now, Duration elapsed) = 0;
};

/// A PLC as a server shows it: variables in a process image, logic that changes them in each scan,
/// and events. The logic is either the small programs of the configuration, which simulate a PLC,
/// or that of a runtime.
///
/// It has no clock: the caller of scan() passes the time. scan(), halt() and the task's side of
/// image() belong to one thread at a time; they never wait, allocate or free. The rest is for any
/// thread.
class BUSBAR_API Plc {
public:
    /// Errors in `config` are reported with their place in it: "variables[2].type",
    /// "programs[0].target", "events[1].limit".
    [[nodiscard]] static Configured<std::unique_ptr<Plc>> create(const PlcConfig& config,
                                                                 server::ImageOptions options = {});
    /// Uses the variables of a program, which are those of `image`; the configuration must then
    /// have none. Programs and events may name parts of them: "Press.Speed", "Stations[2].Count".
    [[nodiscard]] static Configured<std::unique_ptr<Plc>>
    create(const PlcConfig& config, const ProgramTypes& types, const ProgramImage& image);
    Plc(const Plc&) = delete;
    Plc& operator=(const Plc&) = delete;
    ~Plc();

    /// Runs `logic` instead of the configuration's programs. Call it before the first scan; `logic`
    /// must outlive the last one.
    void use(PlcLogic& logic) { logic_ = &logic; }
    /// One cycle: applies clients' writes, runs the logic, detects events, publishes. `now` becomes
    /// the source timestamp; `elapsed` is the time since the previous scan.
    void scan(DateTime now, Duration elapsed);
    /// Runs the programs of the configuration once. For logic, within a scan.
    void run_programs(Duration elapsed);
    /// Stops the PLC until the next scan, see ProcessImage::halt.
    void halt() { image_->halt(); }

    /// The events of the last scan, as indices into events(). For the scanning thread; valid until
    /// the next scan.
    [[nodiscard]] std::span<const std::uint32_t> occurrences() const { return occurrences_; }
    /// Sets the targets of Increment programs to 0 at the next scan.
    void reset_counters() { is_reset_requested_ = true; }
    /// The programs' instructions, for the server's thread. If they are not served, they stay busy.
    [[nodiscard]] InstructionDesk& instructions() { return *instructions_; }
    /// Returns the number of variables that reset_counters() affects.
    [[nodiscard]] std::size_t counter_count() const;

    [[nodiscard]] const std::shared_ptr<server::ProcessImage>& image() const { return image_; }

    /// A variable as clients see it.
    struct Variable {
        std::string name;
        bool is_writable;
    };
    /// Indexed by handle.
    [[nodiscard]] const std::vector<Variable>& variables() const { return variables_; }
    /// The events of the configuration.
    [[nodiscard]] const std::vector<PlcEvent>& events() const { return events_; }
    /// Returns the variable of an event, or the variable that contains the event's value.
    [[nodiscard]] std::uint32_t event_handle(std::size_t event) const
    {
        return event_handles_[event];
    }
    /// Returns the handle of a variable.
    [[nodiscard]] std::optional<std::uint32_t> find(std::string_view name) const;

private:
    Plc();

    PlcLogic* logic_{nullptr};
    std::vector<Variable> variables_;
    /// The handles, sorted by name.
    std::vector<std::uint32_t> by_name_;
    std::unique_ptr<InstructionDesk> instructions_; // before the steps that use it
    /// The programs' own copy of restore_target_variable, for the scanning thread.
    bool restores_profile_{false};
    std::vector<detail::PlcStep> steps_;
    std::vector<PlcEvent> events_;
    std::vector<std::uint32_t> event_handles_;
    /// One for each event.
    std::vector<detail::PlcWatch> watches_;
    /// Reserved for all events.
    std::vector<std::uint32_t> occurrences_;
    std::shared_ptr<server::ProcessImage> image_;
    std::atomic<bool> is_reset_requested_{false};

    friend class PlcBuilder;
};

} // namespace busbar::controller
