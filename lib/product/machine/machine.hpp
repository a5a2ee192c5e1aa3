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

#include "hardware.hpp"
#include "machine_events.hpp"
#include "machine_medium.hpp"
#include "machine_program.hpp"
#include "machine_retained.hpp"
#include "product/configuration/config.hpp"
#include "ticker.hpp"

namespace busbar::product {

/// The folder of the execution log as clients see it; remembers that they removed a file of it. Any
/// thread.
class LogFolder final : public StorageFolder {
public:
    using StorageFolder::StorageFolder;

    /// The log whose files are here is told before one is removed. Before the first client.
    void set_log(controller::ExecutionLog& log) { log_ = &log; }

    [[nodiscard]] Stored<void> remove(std::string_view name) override
    {
        if (log_ != nullptr) {
            // What cannot be saved now waits, and is in the log that comes after.
            static_cast<void>(log_->prepare_removal());
        }
        auto removed = StorageFolder::remove(name);
        has_removed_ = true;
        return removed;
    }
    /// Whether a file went away since the last call.
    [[nodiscard]] bool take_removal() { return has_removed_.exchange(false); }

private:
    controller::ExecutionLog* log_{nullptr};
    std::atomic<bool> has_removed_{false};
};

/// What the manual of a shipping controller says of its server's life and logs (W588): here the
/// hardware is simulated. Outlives servers, each of which publishes a MachineProgram.
///
/// Everything on the servers' thread, but for the logs.
///
/// All it knows of a configuration is where it keeps what, and its program's size: see fits().
class Machine final : private controller::ServerOperator {
public:
    /// Why there is another server.
    enum class Cause : std::uint8_t { Restart, Download };

    /// What has a server that runs reconfigured (W588, 4-2-5).
    using Change = void (controller::LifeCycle::*)();
    using Adding = FunctionRef<Configured<controller::ProgramAddition>()>;
    /// Has the servers' thread call medium_is(). Called by another one.
    using MediumFound = std::function<void(bool is_in)>;

    /// `config` has a program, `card` is the runtime's medium or null. Throws ConfigError. The
    /// others must outlive it, and so must what `medium_found` uses.
    Machine(const ControllerConfig& config, const StorageMedium* card, const WallClock& clock,
            LogSink& lines, MediumFound medium_found);
    ~Machine() override;

    /// The log that everything goes through.
    [[nodiscard]] LogSink& log();
    [[nodiscard]] const controller::MachineEventLog& event_log() const { return *event_log_; }
    [[nodiscard]] const controller::LifeCycle& life() const { return *life_; }
    /// Tells the event log that a configuration cannot be used; empty: that it can.
    void refuse_configuration(std::string_view why);
    /// Gives the program the values of RETAIN variables that are kept, and keeps its own from now
    /// on; its task does not run yet. What cannot be restored goes to the log.
    void keep(const MachineProgram& program);
    /// Keeps what clients write into RETAIN variables. Outlives its servers.
    [[nodiscard]] server::ImageWriteLog& retained() { return *retained_; }
    /// Saves the values of the latest scan now. Throws ConfigError.
    void save_retained();
    /// Power may be gone soon: saves what there is.
    void power_going() { life_->power_going(); }
    /// The medium of the execution log was taken out or put in: its folder is gone or there again.
    void medium_is(bool is_in) { life_->medium_changed(is_in); }
    /// What the hardware would tell. True if the server has to halt: the state is Halt error or
    /// Shutdown until a restart.
    [[nodiscard]] bool happen(HardwareEvent event);
    /// Carries out what instructions of the program ask for. True as happen().
    [[nodiscard]] bool serve(controller::InstructionDesk& desk);
    /// The server with this program is served from now on, at this URL, if there is to be one.
    /// `program` must outlive it, or shut_down(). If the server was being initialized until now,
    /// instructions that are at `desk` came too early (W588, A-2-4).
    void run(MachineProgram& program, const std::string& endpoint_url,
             controller::InstructionDesk& desk);
    /// Whether this is still the machine that `config` would make.
    [[nodiscard]] bool fits(const ControllerConfig& config) const;
    /// A server with this program, which was made with `config`, has taken the place of another
    /// one; as run(), and the life goes through the states between (W588, 4-2-4).
    void replace(Cause cause, MachineProgram& program, const ControllerConfig& config,
                 controller::InstructionDesk& desk);
    /// The program that runs was edited online: `add` adds to it what is new, to the server, too,
    /// if that is out. The problem is that of `add`, or that the memory was replaced.
    [[nodiscard]] Configured<void> edit(const MachineProgram& program, Adding add);
    /// The server that runs goes on with that: here it needs not be stopped for it.
    void changed(Change change, const MachineProgram& program, const std::string& endpoint_url);
    /// It cannot be served: the state is Halt error.
    void cannot_start(const std::string& why);
    /// The server is out until a restart, and all else goes on: the state is Shutdown, and logs are
    /// saved (W588, 4-1-3).
    void shut_server_down(const std::string& reason);
    /// Why the server is out; empty: it is not.
    [[nodiscard]] std::string why_out() const;
    /// It is not served any more: the state is Shutdown, and logs are saved.
    void shut_down();

    /// The execution log, if there is one, as "ExecutionLog": whoever may see it reads its files,
    /// whoever may clear it removes them (W588, 7-2-2 and 8-1). The event log as "EventLog",
    /// for the same to read.
    [[nodiscard]] std::vector<administration::FileSystem> file_systems();
    /// Whether there are other files than at the last call. Any thread; waits for nothing.
    [[nodiscard]] bool has_changed_files() { return has_changed_files_.exchange(false); }

    [[nodiscard]] controller::MachineMode mode() const { return life_->mode(); }
    void change_mode(controller::MachineMode mode) { life_->mode_changed(mode); }
    /// The event log as it is kept, which only the machine changes.
    [[nodiscard]] Storage& event_files() { return event_files_; }
    /// Where the values of RETAIN variables are kept.
    [[nodiscard]] Storage& state() { return state_; }
    /// Runs `act` while the files of the event log and of RETAIN values have all that happened, and
    /// stay as they are.
    void hold_files(FunctionRef<void()> act);
    /// Within hold_files(): what is kept of RETAIN variables is replaced at the next keep(), and
    /// nothing is saved until then.
    void values_replaced() { retained_->stop(); }
    /// Its memory was restored or cleared: the server's state is Shutdown, and a restart is due
    /// (W588, 4-1-3). True as happen().
    [[nodiscard]] bool memory_replaced();

private:
    /// Until run(): the program's first scan is a part of it.
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

    /// All is well. The saver's thread.
    [[nodiscard]] bool save_pending();
    void look_for_log_files();
    [[nodiscard]] bool has_left_running(controller::OperatingStatus before) const;
    void look_for_medium();
    void tell_log_of_medium(bool is_in);
    void tell_medium_worn();
    /// The saver's thread: to the medium, if there is one.
    [[nodiscard]] bool save_records();

    MachineConfig config_; // that it was made with
    /// Of certificates, where a restore leaves what it has.
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
    // Of the saver's thread.
    std::vector<std::string> log_files_;
    bool was_medium_there_{false}; // since the start
    bool is_medium_there_{true};
    bool is_medium_used_{true};
    /// What the machine's life says; at the start a medium counts as in.
    std::atomic<bool> is_medium_in_{true};
    std::atomic<bool> has_changed_files_{false};
    std::optional<MachineRetained> retained_;
    std::unique_ptr<controller::LifeCycle> life_;
    std::uint32_t preparation_{0};
    /// A restart is due (W588, 8-2 and 8-3).
    bool is_memory_replaced_{false};
    /// Of an online edit, while that is made.
    const Adding* adding_{nullptr};
    std::optional<Configured<controller::ProgramAddition>> added_;
    std::mutex saving_; // while the saver works
    std::optional<Ticker> saver_;
};

} // namespace busbar::product
