#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <busbar/administration/administration.hpp>
#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/plc_task.hpp>
#include <busbar/net/worker_thread.hpp>
#include <busbar/product/runtime.hpp>
#include <busbar/server/server.hpp>

#include "product/access/administered.hpp"
#include "product/access/admission.hpp"
#include "product/backend/field_devices.hpp"
#include "product/configuration/live_config.hpp"
#include "product/configuration/reading.hpp"
#include "product/machine/lookout.hpp"
#include "product/machine/machine.hpp"
#include "product/machine/machine_backup.hpp"
#include "product/machine/machine_files.hpp"
#include "product/machine/plant.hpp"
#include "product/machine/program_service.hpp"
#include "product/machine/status.hpp"
#include "product/model/mapped_model.hpp"
#include "product/store/received_program.hpp"
#include "product/store/taken_over.hpp"

namespace busbar::product {

/// The objects that outlive a Generation.
struct Surroundings {
    /// Without log, validator, users and roles, because the generation has its own.
    server::ServerEnvironment environment;
    LogSink& lines;
    /// Serves the generation.
    net::ServerLoop& loop;
    Runtime& runtime;
    controller::ThreadMaker& threads;
    /// Null for none.
    Machine* machine;
    /// Labels of a project of model mode; null without one.
    std::shared_ptr<backend::LabelBackend> labels;
    /// Priority that the system granted to the task of the labels' PLC.
    int label_priority;
    /// Port that the server listens on.
    std::uint16_t port;
    const PendingChanges& pending;
    /// True while an administrator has shut the server down, and the controller goes on.
    const bool& is_shut_down;
};

/// Requests of administrators to the controller. Called on the server's thread.
struct Requests {
    std::function<void()> stop;
    /// Stops the controller, which starts again with what is there then.
    std::function<void()> start_over;
    /// A machine, or the PLC behind a project, goes on without its server.
    std::function<void(const std::string& reason)> shut_down;
    std::function<void(const administration::RestartWish& wish)> restart;
    /// The certificate was replaced.
    std::function<void()> renewed;
    /// Access of users or protection of messages was changed (W588, 4-2-5).
    std::function<void()> security_changed;
    /// The machine's addresses have changed.
    std::function<void()> address_changed;
    /// An event of the simulated hardware; the client has not been answered yet.
    std::function<void(HardwareEvent)> hardware;
    /// The machine's memory was restored or cleared; the client has not been answered yet.
    std::function<void()> memory_replaced;
    /// Returns a check whether restart() would work, which takes long, for any thread.
    std::function<std::function<Configured<void>()>()> may_restart;
    /// The same of a project whose labels have been compared with the PLC.
    std::function<Configured<void>()> may_update;
    /// Whether another certificate may be made now: not while another generation is to serve, which
    /// may have other names for it.
    std::function<Configured<void>()> may_replace_own;
    /// Whether a server with this configuration could listen.
    std::function<Configured<void>(const ControllerConfig& next)> check_listeners;
    /// Settings were changed online.
    std::function<void()> settings_changed;
    /// Changes a machine's program; see ProgramService.
    std::function<Configured<ProgramVerdict>(const ProgramChange&)> change_program;
};

/// Everything that is made from one reading of the configuration: a server with its users and
/// certificates, and the PLC that it shows. Another generation can replace it while clients find
/// the same port open (net::ServerLoop::hand_over); then both exist for a while.
///
/// Used on the server's thread, except prepare().
class Generation {
public:
    /// Call prepare() and finish() before anything else. `configuration` is used in messages.
    /// Throws ConfigError.
    Generation(const Configuration& configuration, Reading reading, const Surroundings& around,
               const Requests& requests);
    Generation(const Generation&) = delete;
    Generation& operator=(const Generation&) = delete;

    /// Makes what takes long: the variables and the nodes of its PLC or its models, and the program
    /// that the runtime loads. On any thread, while another Generation may serve. Throws
    /// ConfigError.
    void prepare();
    /// Completes the generation so that it can be served, with a PLC that does not scan yet. Throws
    /// ConfigError.
    void finish();
    /// Prepares for destruction, which takes long, on any thread; call it after halt().
    void unload() { plant_.unload(); }

    [[nodiscard]] server::Server& server() { return server_; }
    [[nodiscard]] const ControllerConfig& config() const { return config_; }
    [[nodiscard]] crypto::CertificateValidator& clients() { return administered_.clients(); }
    [[nodiscard]] Plant& plant() { return plant_; }

    /// Starts the PLC's scans and serves labels.
    void start();
    /// Stops the PLC, so that another server may serve labels; start() continues.
    void halt();
    /// See Lookout; and looks into the folders of certificates.
    void look();
    /// Versions of the files with administrators' changes, and of the project in the store. A
    /// generation that was made from other versions does not match what is in force.
    [[nodiscard]] std::vector<std::optional<StorageEntry::Version>> kept_versions() const;
    /// The state that this was made from, with administrators' changes that are in force, but
    /// without the listeners.
    [[nodiscard]] TakenOver taken_over() const;
    /// Replaces the texts of the files in use.
    void use(SourceFiles sources) { settings_->use(std::move(sources)); }
    /// Changes the PLC's program, which may run, to that of `next`. Fails, with the file's name and
    /// nothing changed, if this requires another generation.
    [[nodiscard]] Configured<void> edit(const Reading& next,
                                        const std::optional<PreparedProgram>& prepared = {});
    /// Tells whether edit() would succeed; uses `prepared` if it has the result.
    [[nodiscard]] Configured<void> check_edit(const Reading& next,
                                              const std::optional<PreparedProgram>& prepared) const;
    /// The file of the project of model mode that is served; empty for none.
    [[nodiscard]] std::string project_document() const
    {
        return project_ != nullptr ? project_->document() : std::string{};
    }
    /// The base for changes of a machine's program.
    [[nodiscard]] ProgramBase program_base() const;
    /// True if no settings were changed online since `next` was read.
    [[nodiscard]] bool has_settings_of(const Reading& next) const
    {
        return settings_->list().changes() == next.settings->list().changes();
    }
    /// The program of a machine.
    [[nodiscard]] ProgramInForce program() const;
    /// Returns true if the configured file of that program contains another one, or cannot be read.
    /// The answer is remembered for twenty times as long as it takes to find it.
    [[nodiscard]] bool is_program_file_other();
    /// Stores the document of a ReceivedProgram, or removes it, for the next reading.
    [[nodiscard]] Configured<void> keep_program(const std::optional<std::string>& document)
    {
        return keep_received(settings_->files(), document);
    }
    /// Null for none.
    [[nodiscard]] std::shared_ptr<const KeptProject> project() const { return project_; }
    /// The files that are in use.
    [[nodiscard]] const SourceFiles& sources() const { return settings_->sources(); }
    /// Sets a machine's mode as an online change, which its switch was used for: the audit has an
    /// event of it, as no Write or Method has one. Fails if the change cannot be stored.
    [[nodiscard]] Configured<void> switch_mode(controller::MachineMode mode);
    /// Prints, for people, how to reach the server and what is left to do.
    void print_welcome();
    /// Prints, for people, statistics of the PLC.
    void print_statistics() const;
    /// Reads users, trust lists and settings again and applies what can be applied. Returns a text
    /// for the log; a ConfigError changes nothing.
    [[nodiscard]] std::string reload();

private:
    [[nodiscard]] server::Server make_server();
    /// Reports that settings or accounts of the security profile have changed.
    void security_changed();
    void tell_found_certificates();
    void attach(const Requests& requests);
    /// Sets a machine's mode as an online change. Fails if the change cannot be stored.
    [[nodiscard]] Configured<void> set_mode(controller::MachineMode mode);
    /// Checks whether information models can change as `next` says.
    [[nodiscard]] Configured<void> check_models(const ControllerConfig& next) const;
    /// The transfer of a machine's backups (W588, 8-2 and 8-3).
    [[nodiscard]] std::vector<administration::TemporaryFileTransfer>
    backups(const Requests& requests);
    /// The transfer of its program.
    [[nodiscard]] std::vector<administration::TemporaryFileTransfer>
    programs(const Requests& requests);
    /// Applies another configuration, as far as possible while the generation runs.
    void apply(const ControllerConfig& next);
    /// The same transfers, and that of the project of model mode (SH-082679, 9.13).
    [[nodiscard]] std::vector<administration::TemporaryFileTransfer>
    transfers(const Requests& requests);

    Configuration configuration_;
    Surroundings around_;
    std::function<void()> security_changed_;
    std::function<void(HardwareEvent)> hardware_;
    std::unique_ptr<Settings> settings_;
    ControllerConfig config_;
    Plant plant_;
    FieldDevices devices_;
    /// Called after each scan, on the thread that scans.
    std::function<void(DateTime time)> after_scan_;
    // Before the Administration, which they outlive.
    std::optional<MachineFiles> memory_files_;
    std::optional<MachineBackup> backup_;
    std::optional<ProgramService> program_service_;
    std::shared_ptr<KeptProject> project_;
    Administered administered_;
    Admission admission_;
    server::Server server_;
    net::WorkerThread worker_;
    /// A worker of its own, so that channels do not wait for passwords.
    net::WorkerThread channel_worker_;
    LiveConfig live_;
    Lookout lookout_;
    std::optional<MappedModel> mapped_;
    /// Empty if the PLC is that of the labels.
    std::optional<controller::PlcTask> task_;
    /// True if the runtime's own task scans instead.
    bool has_own_task_{false};
    struct OtherFile {
        std::chrono::steady_clock::time_point valid_until;
        bool is_other;
    };
    /// Remembered by is_program_file_other().
    std::optional<OtherFile> other_file_;
    /// True while switch_mode() runs.
    bool is_switching_mode_{false};
};

} // namespace busbar::product
