#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <busbar/core/function_ref.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>
#include <busbar/net/worker_thread.hpp>
#include <busbar/product/controller.hpp>
#include <busbar/storage/folder_storage.hpp>
#include <busbar/types/enumerations.hpp>
#ifdef BUSBAR_KEY_LOG
#include <busbar/net/key_log_file.hpp>
#endif

#include "generation.hpp"
#include "listening.hpp"
#include "product/configuration/reading.hpp"
#include "product/machine/machine.hpp"
#include "product/machine/ticker.hpp"
#include "product/model/field_labels.hpp"
#include "product/model/label_plant.hpp"
#include "product/store/taken_over.hpp"

namespace busbar::product {

/// Gives the runtime its host while this object exists.
class RuntimeUse {
public:
    RuntimeUse(Runtime& runtime, RuntimeHost& host) : runtime_{runtime} { runtime_.begin(host); }
    RuntimeUse(const RuntimeUse&) = delete;
    RuntimeUse& operator=(const RuntimeUse&) = delete;
    ~RuntimeUse() { runtime_.end(); }

private:
    Runtime& runtime_;
};

/// Forwards to the present validator, for objects whose validator cannot be replaced.
class CurrentValidator final : public crypto::CertificateValidator {
public:
    /// Sets the validator; must be called before the first validate(). `validator` must outlive
    /// this object or the next call.
    void use(crypto::CertificateValidator& validator) { validator_ = &validator; }

    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override
    {
        return validator_->validate(chain, context);
    }

private:
    crypto::CertificateValidator* validator_{nullptr};
};

/// Parts of a configuration that stay, besides the machine, when servers are replaced.
struct Standing {
    /// True if clients are served at all.
    bool is_used;
    std::vector<std::string> reverse_urls;
    DiscoveryConfig discovery;
    /// ApplicationUri at the discovery server; empty without one.
    std::string application_uri;
    std::string key_log;
    /// The PLC on the network that has the labels; empty for none.
    std::string field_labels;
    /// The remote password of that PLC, whose file may change while its path stays. Never logged.
    std::string field_password;

    friend bool operator==(const Standing&, const Standing&) = default;
};

[[nodiscard]] Standing standing_of(const ControllerConfig& config);
/// Returns whether the process has a terminal.
[[nodiscard]] bool has_terminal();

/// The starting point of a controller.
struct Beginning {
    Reading reading;
    /// The last good state; empty if the controller never ran.
    std::optional<TakenOver> last;
    /// The reason why a part of `last` replaces the present files; empty if none does.
    std::string refusal;
    /// The parts that are missing at the start; empty if nothing is.
    std::string damage{};
};

/// A running controller: its listeners, its machine with life cycle and logs, and the Generation
/// that serves, which is replaced at a restart and a download.
class RunningController final : private RuntimeHost {
public:
    /// Listens and creates the first generation. If the proper listeners cannot be opened, it uses
    /// the last ones, or listens for administrators at this machine, until they can; a controller
    /// that never ran and has no machine's program fails instead. Throws ConfigError. `runtime`,
    /// `log`, and `threads`, which makes those of PLCs, must outlive this object.
    RunningController(Configuration configuration, Beginning beginning, Runtime& runtime,
                      LogSink& log, const ControllerOptions& options,
                      controller::ThreadMaker& threads);
    RunningController(const RunningController&) = delete;
    RunningController& operator=(const RunningController&) = delete;

    /// Serves until it is stopped. True if the controller must start again from the beginning.
    [[nodiscard]] bool run();
    /// Makes run() return. Thread-safe.
    void stop() { loop_.stop(); }
    /// Does the same as SIGHUP. Thread-safe.
    void reload() override;
    /// Calls `work` soon on the thread of run(), outside of callbacks, unless run() returns first.
    /// Thread-safe.
    void post(std::function<void()> work) { loop_.post(std::move(work)); }

private:
    void happen(HardwareEvent event) override;
    void power_going() override;
    void switch_mode(controller::MachineMode mode) override;
    [[nodiscard]] std::optional<controller::PlcError> plc_error() const override;
    /// Opens the listeners of `config`, or substitutes.
    void listen(const ControllerConfig& config, Listening::Listeners last);
    void serve_instructions();
    /// Stops serving; clients see the reason, and an administrator may start the server again. In
    /// the state Suspended the server still answers what was done.
    void halt(const std::string& why, ServerState state = ServerState::Failed);
    /// Keeps the state: a download brings back neither a server that is out until a restart nor a
    /// program that a fault has stopped (W588, 4-1-2).
    void stay_out();
    void refuse_beginning(const Beginning& beginning);
    /// Replaces substitutes by the proper listeners, if these can be opened by now.
    void listen_as_told();
    /// Restarts a few seconds after the machine's memory was replaced, because what runs does not
    /// match it (W588, 8-3).
    void restart_replaced();
    void register_with_discovery_server(const ControllerConfig& config);
    [[nodiscard]] Surroundings surroundings();
    [[nodiscard]] Requests requests();
    void hang_up();
    /// Reads users, trust lists, settings and programs again soon, and applies what can be applied;
    /// a worker reads the machine's program first.
    void read_again_soon();
    void read_again(const std::optional<PreparedProgram>& program);
    /// Takes over another program of labels on the worker, if there is one, before all else.
    void read_again_with_labels(const SourceFiles::Prepared& labels);
    /// Throws ConfigError.
    void read_files_again();
    /// Notes that what could not be used at the start can be used by now.
    void end_refusal();
    /// Calls `act`, which may throw a ConfigError, for SIGHUP.
    void try_to_read(FunctionRef<void()> act);
    void renewed();
    void follow(HardwareEvent event);
    /// Reports the change to the machine's life cycle.
    void changed(Machine::Change change);
    /// Restarts soon; only logs the reason if nothing can replace the server.
    void restart(const administration::RestartWish& wish);
    void restart_with_last(const administration::RestartWish& wish, std::string why);
    /// True while the server serves administrators only, who can have it restarted.
    [[nodiscard]] bool is_out() const;
    /// Describes a replacement of the current generation.
    struct Replacement {
        Machine::Cause cause;
        net::Handover handover;
        /// Reads the configuration for it, including changes made in the meantime. Throws
        /// ConfigError.
        std::function<Reading()> read;
        /// Called when the new generation serves, or the controller ends to start again. May be
        /// null.
        std::function<void()> done{};
        /// Called when nothing has changed, for a reason that is logged. May be null.
        std::function<void(const ConfigError&)> refused{};
        int attempts{0};
        /// See ProgramChange.
        bool leaves_out{false};
        /// True if read() returns reading_of_last(): the files may have something else.
        bool is_of_last{false};
    };
    struct Successor;
    /// Calls `act` soon on the thread of run(), when no generation is being created. Thread-safe.
    void when_free(std::function<void()> act);
    /// Likewise for what replaces the current generation; see check_no_replacement().
    void replace_soon(std::function<void()> act);
    /// Checks that the current generation is not about to be replaced by one that may differ in
    /// `what`.
    [[nodiscard]] Configured<void> check_no_replacement(const char* what) const;
    /// Replaces the current generation by one from `reading`, or from the present files. The
    /// current one serves until then; an old port is closed once the new one is open. If more than
    /// a generation has to change, the controller ends and starts again. Call it only from
    /// when_free().
    void replace(Replacement wish, std::optional<Reading> reading = {});
    /// Throws ConfigError if the program of `next` leaves out more than the one that runs.
    void check_left_out(const ControllerConfig& next) const;
    /// See replace(). Throws ConfigError.
    void begin(Replacement wish, Reading reading);
    /// Does what takes long of a generation. Any thread, while no other one is made. Throws
    /// ConfigError.
    void prepare(Successor& next) const;
    /// False if the maker has too much to do.
    [[nodiscard]] bool make(const std::shared_ptr<Successor>& next);
    void made(const std::shared_ptr<Successor>& next);
    /// Lets it serve, has another one made, or refuses it.
    void take(Successor& next);
    /// Does what has waited for the worker.
    void resume();
    /// Lets the worker destroy a generation that nothing uses, which takes long.
    void discard(std::unique_ptr<Generation> gone);
    /// Nothing is made any more.
    void drop_next();
    /// Throws ConfigError.
    void succeed(Successor& next);
    static void done(const Replacement& wish);
    /// Like try_to(), and reports an exception to the requester, too.
    void try_for(const Replacement& wish, FunctionRef<void()> act);
    /// Substitutes for reading all files again, so that unchanged ones need not be parsed again.
    [[nodiscard]] Substitutes as_known() const;
    /// Takes over another program, if there is one: by an online edit, in any mode, if that is
    /// enough, and by a download otherwise. True for a download, which reads everything again.
    [[nodiscard]] bool download(const std::optional<PreparedProgram>& program);
    void edited_online(const std::string& name);
    /// Tells a user who changed the file that it is not used.
    void tell_of_other_file();
    /// Changes the program by request over OPC UA; everything else stays. A download happens soon,
    /// and is stored before. The problem is the reason why nothing was changed.
    [[nodiscard]] Configured<ProgramVerdict> change_program(const ProgramChange& change);
    /// Reads the configuration with another program, or with that of the file. Throws ConfigError.
    [[nodiscard]] Reading reading_with(const ProgramChange& change) const;
    /// Downloads later. If that is refused, the document `before` is restored and the status tells
    /// why.
    void download_soon(ProgramChange change, Reading reading, std::optional<std::string> before);
    /// Checks a download, which may bring other settings of the server that change in PROGRAM only
    /// (W588, 3-2-2), and takes the server out (4-1-4): the machine must be in PROGRAM, or `next`
    /// puts it there. Turning the server on or off requires a restart (3-2-3). `edit` is the reason
    /// against an online edit; empty if that would be possible. Throws ConfigError.
    void check_download(const ControllerConfig& next, const std::string& edit) const;
    /// Lets the worker change the program of labels to that of `next`, then calls `then`, with the
    /// reason if that is impossible, on the thread of run(). No generation is created meanwhile.
    void download_labels(ControllerConfig next, std::function<void(const Problem* why_not)> then);
    /// Calls `work` on the worker, or at once if that has too much to do.
    void work_aside(const std::function<void()>& work);
    [[nodiscard]] Configured<void> check_listeners(const ControllerConfig& next) const;
    /// The labels for a project of model mode; null if there are none.
    [[nodiscard]] std::shared_ptr<backend::LabelBackend> labels() const;
    /// Returns a check, for any thread, that the project, null for none, can have its labels of the
    /// PLC, if it is another one than `last`, the file of the one before.
    [[nodiscard]] std::function<Configured<void>()>
    labels_check(std::shared_ptr<const KeptProject> project, const ControllerConfig& next,
                 std::string last) const;
    /// Reads what is served now. Throws ConfigError.
    [[nodiscard]] Reading reading_of_last();
    /// Reads what restart() would take up; its labels are not checked. Throws ConfigError.
    [[nodiscard]] Reading reading_for_restart();
    /// Returns a check of what restart() would take up, for any thread.
    [[nodiscard]] std::function<Configured<void>()> restart_check();
    /// Stores what is running as the last good state.
    void keep();
    /// Likewise, at the next turn of the thread of run().
    void keep_soon();
    /// Stores what the medium did not accept before, and what is to be kept soon.
    void store_again();
    /// A program that was stored and then refused.
    struct RefusedProgram {
        std::string why;
        /// The document to store instead; nothing if there was none.
        std::optional<std::string> before;
        /// True if the requester was told otherwise before, so that the status must tell.
        bool was_accepted{false};
        /// The reason that the status gave before; it is given again unless `why` replaces it.
        std::string reason_before{};
    };
    /// Returns the reason that the status gives once the document of before a refused program, if
    /// there is one, is stored.
    [[nodiscard]] std::string download_reason() const;
    /// Stores the document of before a refused program, if there is one. The pending change tells
    /// if that fails.
    [[nodiscard]] Configured<void> put_back();
    void refuse_program(RefusedProgram refused);
    void take_over(std::unique_ptr<Generation> next, net::Handover handover);
    void save_retained();
    void start();
    /// Checks soon for changes that nothing reports. Thread-safe.
    void look_soon();
    void start_again(const net::Handover& handover);
    void release(const Generation& gone);
    /// Calls `change`, which may throw a ConfigError; that is logged.
    void try_to(FunctionRef<void()> change);

    Configuration configuration_;
    Runtime& runtime_;
    LogSink& log_;
    controller::ThreadMaker& threads_;
    bool takes_signals_;
    bool greets_;
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    net::ServerLoop loop_{log_};
#ifdef BUSBAR_KEY_LOG
    std::unique_ptr<net::KeyLogFile> key_log_;
#endif
    std::optional<Machine> machine_;
    /// Set for a project of model mode, if the runtime has no labels of its own.
    std::optional<LabelPlant> labels_;
    /// Set instead if a PLC on the network has the labels.
    std::optional<FieldLabels> field_labels_;
    Listening listening_;
    /// Number of checks until a pending restart; 0 if none is due.
    int looks_until_restart_{0};
    std::optional<storage::FolderStorage> kept_folder_;
    std::optional<TakenOverFiles> kept_;
    bool is_keeping_due_{false};
    /// The reason why the running state is not stored; empty if it is.
    std::string why_not_kept_;
    /// Set until the document of before is stored.
    std::optional<RefusedProgram> refused_program_;
    CurrentValidator clients_;
    PendingChanges pending_;
    /// Identity of the current generation, for the discovery server.
    std::optional<channel::ApplicationIdentity> identity_;
    Standing standing_;
    std::optional<RuntimeUse> runtime_use_;
    /// Previous generations that clients have not left yet.
    std::vector<std::unique_ptr<Generation>> leaving_;
    std::unique_ptr<Generation> current_;
    /// Set while the program has instructions.
    std::optional<Ticker> instructions_;
    /// The part that was refused at the start, with the reason.
    std::string refused_;
    bool has_terminal_;
    bool starts_again_{false};
    /// True from a shutdown of the server, after which the controller goes on, to a restart.
    bool is_shut_down_{false};
    /// Number of new certificates so far.
    int renewals_{0};
    /// The generation that is being created, and the tasks that wait for it; null for none.
    std::shared_ptr<Successor> next_;
    std::vector<std::function<void()>> waiting_;
    /// True while the worker changes the program of labels.
    bool takes_labels_{false};
    /// Number of replacements that were asked for and have not begun.
    int replacements_due_{0};
    /// Creates generations and destroys old ones. Empty after run().
    std::optional<net::WorkerThread> maker_{std::in_place, 64, &log_};
};

} // namespace busbar::product
