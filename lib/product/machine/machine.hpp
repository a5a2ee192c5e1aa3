#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/file_system.hpp>
#include <busbar/controller/execution_log.hpp>
#include <busbar/controller/life_cycle.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/controller/publishing.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/storage_folder.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "machine_events.hpp"
#include "machine_medium.hpp"
#include "machine_program.hpp"
#include "machine_retained.hpp"
#include "product/configuration/config.hpp"
#include "simulated_runtime.hpp"
#include "ticker.hpp"

namespace busbar::product {

/// The folder of the execution log as clients see it; remembers that they removed a file.
/// Thread-safe.
class LogFolder final : public StorageFolder {
public:
    using StorageFolder::StorageFolder;

    /// Sets the log that is told before one of its files is removed; must be called before the
    /// first client connects.
    void set_log(controller::ExecutionLog& log) { log_ = &log; }

    [[nodiscard]] Stored<void> remove(std::string_view name) override
    {
        if (log_ != nullptr) {
            // Records that cannot be saved now wait and become part of the next log.
            static_cast<void>(log_->prepare_removal());
        }
        auto removed = StorageFolder::remove(name);
        has_removed_ = true;
        return removed;
    }
    /// Tells whether a file was removed since the last call.
    [[nodiscard]] bool take_removal() { return has_removed_.exchange(false); }

private:
    controller::ExecutionLog* log_{nullptr};
    std::atomic<bool> has_removed_{false};
};

/// Models the life cycle and the logs of a server as the manual of a shipping controller describes
/// them (W588), with simulated hardware. Outlives servers, each of which publishes a
/// MachineProgram.
///
/// Used on the servers' thread, except the logs.
///
/// From a configuration it uses only the places of its files, and its program's size: see fits().
class Machine final : private controller::ServerOperator {
public:
    /// The reason for another server.
    enum class Cause : std::uint8_t { Restart, Download };

    /// A reconfiguration of a running server (W588, 4-2-5).
    using Change = void (controller::LifeCycle::*)();
    using Adding = FunctionRef<Configured<controller::ProgramAddition>()>;
    /// Makes the servers' thread call medium_is(). Called by another thread.
    using MediumFound = std::function<void(bool is_in)>;

    /// `config` must have a program; `card` is the runtime's medium or null. Throws ConfigError.
    /// The other arguments must outlive this object, and so must what `medium_found` uses.
    Machine(const ControllerConfig& config, const StorageMedium* card, const WallClock& clock,
            LogSink& lines, MediumFound medium_found);
    ~Machine() override;

    /// The log for all messages and records.
    [[nodiscard]] LogSink& log();
    [[nodiscard]] const controller::MachineEventLog& event_log() const { return *event_log_; }
    [[nodiscard]] const controller::LifeCycle& life() const { return *life_; }
    /// Reports to the event log that a configuration cannot be used; an empty text ends the report.
    void refuse_configuration(std::string_view why);
    /// Gives the program the saved values of RETAIN variables, and saves its own from now on; its
    /// task must not run yet. Logs values that cannot be restored.
    void keep(const MachineProgram& program);
    /// Saves what clients write into RETAIN variables. Outlives its servers.
    [[nodiscard]] server::ImageWriteLog& retained() { return *retained_; }
    /// Saves the values of the latest scan now. Throws ConfigError.
    void save_retained();
    /// Saves everything, because power may fail soon.
    void power_going() { life_->power_going(); }
    /// Reports that the medium of the execution log was taken out or put in.
    void medium_is(bool is_in) { life_->medium_changed(is_in); }
    /// Reports an event of the hardware. True if the server must halt: the state is Halt error or
    /// Shutdown until a restart.
    [[nodiscard]] bool happen(HardwareEvent event);
    /// Carries out requests of the program's instructions. True in the same case as happen().
    [[nodiscard]] bool serve(controller::InstructionDesk& desk);
    /// Reports that the server with this program is served from now on, at this URL, if the server
    /// is used. `program` must outlive this object, or shut_down(). If the server was being
    /// initialized until now, pending instructions at `desk` came too early (W588, A-2-4).
    void run(MachineProgram& program, const std::string& endpoint_url,
             controller::InstructionDesk& desk);
    /// Tells whether a machine for `config` would be the same as this one.
    [[nodiscard]] bool fits(const ControllerConfig& config) const;
    /// Reports that a server with this program, made from `config`, has replaced another. Does the
    /// same as run(), with the states in between (W588, 4-2-4).
    void replace(Cause cause, MachineProgram& program, const ControllerConfig& config,
                 controller::InstructionDesk& desk);
    /// Edits the running program online: `add` adds what is new, also to a server that is out.
    /// Fails if `add` fails, or if the memory was replaced.
    [[nodiscard]] Configured<void> edit(const MachineProgram& program, Adding add);
    /// Reports a reconfiguration: here the running server need not be stopped for it.
    void changed(Change change, const MachineProgram& program, const std::string& endpoint_url);
    /// Reports that the server cannot be served: the state is Halt error.
    void cannot_start(const std::string& why);
    /// Takes the server out until a restart; everything else continues: the state is Shutdown, and
    /// logs are saved (W588, 4-1-3).
    void shut_server_down(const std::string& reason);
    /// The reason why the server is out; empty if it is not.
    [[nodiscard]] std::string why_out() const;
    /// Ends the machine's server: the state is Shutdown, and logs are saved.
    void shut_down();

    /// The execution log, if there is one, as "ExecutionLog": users with the right to see it read
    /// its files, those with the right to clear it remove them (W588, 7-2-2 and 8-1), except the
    /// one that is being written. The event log as "EventLog", for the same readers.
    [[nodiscard]] std::vector<administration::FileSystem> file_systems();
    /// Tells whether the files have changed since the last call. Thread-safe; never blocks.
    [[nodiscard]] bool has_changed_files() { return has_changed_files_.exchange(false); }

    [[nodiscard]] controller::MachineMode mode() const { return life_->mode(); }
    void change_mode(controller::MachineMode mode) { life_->mode_changed(mode); }
    /// The files of the event log, which only the machine changes.
    [[nodiscard]] Storage& event_files() { return event_files_; }
    /// The storage of the values of RETAIN variables.
    [[nodiscard]] Storage& state() { return state_; }
    /// Runs `act` while the files of the event log and of RETAIN values are complete and do not
    /// change.
    void hold_files(FunctionRef<void()> act);
    /// Call it within hold_files(): the values of RETAIN variables are replaced at the next keep(),
    /// and nothing is saved until then.
    void values_replaced() { retained_->stop(); }
    /// Reports that the memory was restored or cleared: the server's state is Shutdown, and a
    /// restart is due (W588, 4-1-3). True in the same case as happen().
    [[nodiscard]] bool memory_replaced();

private:
    /// This lasts until run(): the program's first scan is a part of it.
    void initialize() override {}
    void prepare(std::uint32_t number, const controller::ServerSettings& settings) override;
    void reconfigure(std::uint32_t number, const controller::ServerSettings& settings,
                     const controller::StopNotice& notice) override;
    void run() override {}
    void suspend(const controller::StopNotice&) override {}
    void stop(const controller::StopNotice& notice) override;
    void add_variables() override;
    void medium_changed(bool is_in) override;
    void save_now() override;

    /// Records what the program publishes, what not, and what is left out of it.
    void tell_program(const MachineProgram& program);
    /// True if everything could be saved. Runs on the saver's thread.
    [[nodiscard]] bool save_pending();
    void look_for_log_files();
    [[nodiscard]] bool has_left_running(controller::OperatingStatus before) const;
    void look_for_medium();
    void tell_log_of_medium(bool is_in);
    void tell_medium_worn();
    /// The saver's thread: to the medium, if there is one.
    [[nodiscard]] bool save_records();

    MachineConfig config_; // the configuration it was made with
    /// Folder of certificates, where a restore leaves its files.
    std::string files_folder_;
    std::size_t max_variables_;
    controller::ServerSettings settings_;
    storage::FolderStorage state_;
    MachineMedium medium_;
    StorageFolder event_files_;
    MachineEvents events_;
    std::unique_ptr<controller::MachineEventLog> event_log_;
    std::unique_ptr<controller::ExecutionLog> execution_log_; // before it
    LogFolder log_folder_;
    MediumFound medium_found_;
    // Used by the saver's thread.
    std::vector<std::string> log_files_;
    bool was_medium_there_{false}; // since the start
    bool is_medium_there_{true};
    bool is_medium_used_{true};
    /// The state known to the life cycle; at the start a medium counts as present.
    std::atomic<bool> is_medium_in_{true};
    std::atomic<bool> has_changed_files_{false};
    std::optional<MachineRetained> retained_;
    std::unique_ptr<controller::LifeCycle> life_;
    std::uint32_t preparation_{0};
    /// True if a restart is due (W588, 8-2 and 8-3).
    bool is_memory_replaced_{false};
    /// Set during an online edit.
    const Adding* adding_{nullptr};
    std::optional<Configured<controller::ProgramAddition>> added_;
    std::mutex saving_; // held while the saver works
    std::optional<Ticker> saver_;
};

} // namespace busbar::product
