#pragma once

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

/// What outlives a Generation.
struct Surroundings {
    /// Without log, validator, users and roles, which are the generation's own.
    server::ServerEnvironment environment;
    LogSink& lines;
    Runtime& runtime;
    /// Null if there is none.
    Machine* machine;
    /// Of a project of model mode; null without one.
    std::shared_ptr<backend::LabelBackend> labels;
    /// What the system granted to the task of the labels' PLC.
    int label_priority;
    /// Where it listens.
    std::uint16_t port;
    const PendingChanges& pending;
};

/// What administrators have the controller do. Called on the server's thread.
struct Requests {
    std::function<void()> stop;
    /// As stop, and starts again with what is there then.
    std::function<void()> start_over;
    /// A machine goes on without its server.
    std::function<void(const std::string& reason)> shut_down;
    std::function<void(const administration::RestartWish& wish)> restart;
    /// The certificate is another one.
    std::function<void()> renewed;
    /// Who may come in, or how, is another one (W588, 4-2-5).
    std::function<void()> security_changed;
    /// The machine has other addresses.
    std::function<void()> address_changed;
    /// Its hardware is simulated. The client has no answer yet.
    std::function<void(HardwareEvent)> hardware;
    /// The machine's memory was restored or cleared; the client has no answer yet.
    std::function<void()> memory_replaced;
    /// Whether what restart() would take up works, and if not, why not.
    std::function<Configured<void>()> may_restart;
    /// The same of a project whose labels have been compared with the PLC.
    std::function<Configured<void>()> may_update;
    /// Whether a server with this configuration could listen.
    std::function<Configured<void>(const ControllerConfig& next)> check_listeners;
    /// Settings were changed online.
    std::function<void()> settings_changed;
    /// Carries out what becomes of a machine's program; see ProgramService.
    std::function<Configured<ProgramVerdict>(const ProgramChange&)> change_program;
};

/// Everything that is made of one reading of the configuration: a server with its users and
/// certificates, and the PLC that it shows. Another one may take its place while clients find the
/// same port open (net::ServerLoop::hand_over); for a while there are both then.
///
/// On the server's thread, but for prepare().
class Generation {
public:
    /// To be prepared and finished before anything else. `configuration` is for messages. Throws
    /// ConfigError.
    Generation(const Configuration& configuration, Reading reading, const Surroundings& around,
               const Requests& requests);
    Generation(const Generation&) = delete;
    Generation& operator=(const Generation&) = delete;

    /// Makes what takes long: the variables and the nodes of its PLC or its models, and the program
    /// that the runtime loads. On any thread, while another Generation may serve. Throws
    /// ConfigError.
    void prepare();
    /// Ready to be served, with a PLC that does not scan yet. Throws ConfigError.
    void finish();
    /// After halt(): it may be destroyed on any thread from now on, which takes long.
    void unload() { plant_.unload(); }

    [[nodiscard]] server::Server& server() { return server_; }
    [[nodiscard]] const ControllerConfig& config() const { return config_; }
    [[nodiscard]] crypto::CertificateValidator& clients() { return administered_.clients(); }
    [[nodiscard]] Plant& plant() { return plant_; }

    /// The PLC scans from now on, and labels are served.
    void start();
    /// The PLC stops, and another server may serve labels; start() has it go on.
    void halt();
    /// See Lookout; and looks into the folders of certificates.
    void look();
    /// Versions of the files in which administrators' changes are kept: what is made of others than
    /// these is not of what is in force.
    [[nodiscard]] std::vector<std::optional<StorageEntry::Version>> kept_versions() const;
    /// What it was made of, and what administrators have changed that is in force; without where it
    /// listens.
    [[nodiscard]] TakenOver taken_over() const;
    /// These files' texts are what it runs with from now on.
    void use(SourceFiles sources) { settings_->use(std::move(sources)); }
    /// Has the PLC's program, which may run, become that of `next`. The problem is that this takes
    /// another generation, with the file: nothing was changed.
    [[nodiscard]] Configured<void> edit(const Reading& next,
                                        const std::optional<PreparedProgram>& prepared = {});
    /// Whether edit() would; `prepared` may have it already.
    [[nodiscard]] Configured<void> check_edit(const Reading& next,
                                              const std::optional<PreparedProgram>& prepared) const;
    /// The file of the project of model mode that it serves; empty: none.
    [[nodiscard]] std::string project_document() const
    {
        return project_ != nullptr ? project_->document() : std::string{};
    }
    /// Of a machine: what its program is changed against.
    [[nodiscard]] ProgramBase program_base() const;
    /// Whether nobody has changed settings since `next` was read.
    [[nodiscard]] bool has_settings_of(const Reading& next) const
    {
        return settings_->list().changes() == next.settings->list().changes();
    }
    /// Of a machine.
    [[nodiscard]] ProgramInForce program() const;
    /// Keeps the document of a ReceivedProgram, or none, for the next reading.
    [[nodiscard]] Configured<void> keep_program(const std::optional<std::string>& document)
    {
        return keep_received(settings_->files(), document);
    }
    /// Null without one.
    [[nodiscard]] std::shared_ptr<const KeptProject> project() const { return project_; }
    /// Those that it runs with.
    [[nodiscard]] const SourceFiles& sources() const { return settings_->sources(); }
    /// As a setting that was changed online, of a machine. The problem is that it cannot be kept.
    [[nodiscard]] Configured<void> set_mode(controller::MachineMode mode);
    /// How to reach it and what is left to do, for people.
    void print_welcome() const;
    /// What the PLC did, for people.
    void print_statistics() const;
    /// Reads users, trust lists and settings again and puts in force what can be. What it found,
    /// for the log; a ConfigError changes nothing.
    [[nodiscard]] std::string reload();

private:
    [[nodiscard]] server::Server make_server();
    /// Settings or accounts of the security profile are others.
    void security_changed();
    void tell_found_certificates();
    void attach(const Requests& requests);
    /// Whether other information models than those that are served could be.
    [[nodiscard]] Configured<void> check_models(const ControllerConfig& next) const;
    /// A machine's backups (W588, 8-2 and 8-3).
    [[nodiscard]] std::vector<administration::TemporaryFileTransfer>
    backups(const Requests& requests);
    /// Its program.
    [[nodiscard]] std::vector<administration::TemporaryFileTransfer>
    programs(const Requests& requests);
    /// Puts in force what can be of another configuration while it runs.
    void apply(const ControllerConfig& next);
    /// Those, and the project of model mode (SH-082679, 9.13).
    [[nodiscard]] std::vector<administration::TemporaryFileTransfer>
    transfers(const Requests& requests);

    Configuration configuration_;
    Surroundings around_;
    std::function<void()> security_changed_;
    std::function<void(HardwareEvent)> hardware_;
    std::unique_ptr<Settings> settings_;
    ControllerConfig config_;
    Plant plant_;
    /// What is done after each scan, by the thread that scans.
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
    /// Its own, so that no channel waits for a password.
    net::WorkerThread channel_worker_;
    LiveConfig live_;
    Lookout lookout_;
    std::optional<MappedModel> mapped_;
    /// None if the PLC is that of the labels.
    std::optional<controller::PlcTask> task_;
    /// The runtime's own task scans instead.
    bool has_own_task_{false};
};

} // namespace busbar::product
