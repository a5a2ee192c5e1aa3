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
#include "product/access/current_validator.hpp"
#include "product/configuration/reading.hpp"
#include "product/machine/machine.hpp"
#include "product/machine/ticker.hpp"
#include "product/model/label_plant.hpp"
#include "product/store/taken_over.hpp"

namespace busbar::product {

/// A runtime knows its host as long as this lives.
class RuntimeUse {
public:
    RuntimeUse(Runtime& runtime, RuntimeHost& host) : runtime_{runtime} { runtime_.begin(host); }
    RuntimeUse(const RuntimeUse&) = delete;
    RuntimeUse& operator=(const RuntimeUse&) = delete;
    ~RuntimeUse() { runtime_.end(); }

private:
    Runtime& runtime_;
};

/// What of a configuration stays while servers come and go, beside the machine.
struct Standing {
    /// Whether clients are served at all.
    bool is_used;
    std::vector<std::string> reverse_urls;
    DiscoveryConfig discovery;
    /// Under which it is registered with a discovery server; empty without one.
    std::string application_uri;
    std::string key_log;

    friend bool operator==(const Standing&, const Standing&) = default;
};

[[nodiscard]] Standing standing_of(const ControllerConfig& config);

/// What a controller begins with.
struct Beginning {
    Reading reading;
    /// What it ran with last; nothing if it never ran.
    std::optional<TakenOver> last;
    /// Why it begins with a part of `last` instead of what is there now; empty: it does not.
    std::string refusal;
    /// What it begins without; empty: it has everything.
    std::string damage{};
};

/// A controller while it runs: its listeners, its machine with life and logs, and the Generation
/// that serves, of which another one takes the place at a restart and a download.
class RunningController final : private RuntimeHost {
public:
    /// Listens, and makes the first generation. Where it is told to listen it may not be able to:
    /// then it listens where it did last, or for administrators at this machine, and goes where it
    /// is told to once it can; but not one that never ran and has no machine's program. Throws
    /// ConfigError. `runtime` and `log` must outlive it.
    RunningController(Configuration configuration, Beginning beginning, Runtime& runtime,
                      LogSink& log, const ControllerOptions& options);
    RunningController(const RunningController&) = delete;
    RunningController& operator=(const RunningController&) = delete;

    /// Serves until it is stopped. True if it is to start again, with everything anew.
    [[nodiscard]] bool run();
    /// Has run() end. Any thread.
    void stop() { loop_.stop(); }
    /// As SIGHUP. Any thread.
    void reload() override;
    /// Calls `work` soon on the thread of run(), in nobody's callback; not if that returns before.
    /// Any thread.
    void post(std::function<void()> work) { loop_.post(std::move(work)); }

private:
    void happen(HardwareEvent event) override;
    void power_going() override;
    void switch_mode(controller::MachineMode mode) override;
    [[nodiscard]] std::optional<controller::PlcError> plc_error() const override;
    /// As `config` says, or elsewhere.
    void listen(const ControllerConfig& config, Listening::Listeners last);
    void serve_instructions();
    /// Clients see why it does not serve any more, and an administrator may have it start again.
    /// Suspended still tells what was done.
    void halt(const std::string& why, ServerState state = ServerState::Failed);
    /// A download brings back neither a server that is out until a restart nor a program that a
    /// fault has stopped (W588, 4-1-2).
    void stay_out();
    void refuse_beginning(const Beginning& beginning);
    /// If it listens elsewhere: goes where it is told to, if that can be opened by now.
    void listen_as_told();
    /// Some seconds after the machine's memory was replaced: what runs is not of it (W588,
    /// 8-3).
    void restart_replaced();
    void register_with_discovery_server(const ControllerConfig& config);
    [[nodiscard]] Surroundings surroundings();
    [[nodiscard]] Requests requests();
    void hang_up();
    /// Users, trust lists, settings and programs, and puts in force what can be.
    void read_again();
    void renewed();
    void follow(HardwareEvent event);
    /// The machine's life learns of it.
    void changed(Machine::Change change);
    /// Soon, and not at all if there is nothing to replace the server with: the log says why.
    void restart(const administration::RestartWish& wish);
    /// How another generation takes the place of the current one.
    struct Replacement {
        Machine::Cause cause;
        net::Handover handover;
        /// What is there to make it of, also if that was changed meanwhile. Throws ConfigError.
        std::function<Reading()> read;
        /// Called when it serves, or the controller ends to start again. May be null.
        std::function<void()> done{};
        /// Called when all is as it was, which the log says. May be null.
        std::function<void(const ConfigError&)> refused{};
        int attempts{0};
    };
    struct Successor;
    /// Calls `act` soon on the thread of run(), when no other generation is being made. Any thread.
    void when_free(std::function<void()> act);
    /// Makes another generation of `reading`, or of what is there; while it is made, this one
    /// serves. An old port is left once the new one listens. What stands may be other than it is:
    /// then the controller ends, and starts again. Only when_free().
    void replace(Replacement wish, std::optional<Reading> reading = {});
    /// See replace(). Throws ConfigError.
    void begin(Replacement wish, Reading reading);
    /// What takes long of a generation. Any thread, while no other one is made. Throws ConfigError.
    void prepare(Successor& next) const;
    /// False if the maker has too much to do.
    [[nodiscard]] bool make(const std::shared_ptr<Successor>& next);
    void made(const std::shared_ptr<Successor>& next);
    /// Lets it serve, has another one made, or refuses it.
    void take(Successor& next);
    /// Of one that nothing uses: to destroy it takes long.
    void discard(std::unique_ptr<Generation> gone);
    /// Nothing is made any more.
    void drop_next();
    /// Throws ConfigError.
    void succeed(Successor& next);
    static void done(const Replacement& wish);
    /// As try_to(); what is thrown is told to the one who wished for it, too.
    void try_for(const Replacement& wish, FunctionRef<void()> act);
    /// For a reading of all files anew, of which those that are as they were need not be taken
    /// apart again.
    [[nodiscard]] Substitutes as_known() const;
    /// Takes over another program, if there is one: what is only added by an online edit, whatever
    /// the mode, all else as a download. True for the latter, in which everything is read again.
    [[nodiscard]] bool download();
    void edited_online(const std::string& name);
    /// Whoever changed the file learns that it does not count.
    void tell_of_other_file();
    /// A change of the program that is asked for over OPC UA: all else is as it runs. A download
    /// takes place soon, and is kept before. The problem is why nothing was changed.
    [[nodiscard]] Configured<ProgramVerdict> change_program(const ProgramChange& change);
    /// What is there now with another program, or with that of the file. Throws ConfigError.
    [[nodiscard]] Reading reading_with(const ProgramChange& change) const;
    /// `before` is the document that was kept before, which counts again if it is refused: then the
    /// status says why.
    void download_soon(ProgramChange change, Reading reading, std::optional<std::string> before);
    /// A download may bring other settings of the server, which change in PROGRAM only (W588,
    /// 3-2-2), and takes the server out (4-1-4): the machine has to be in PROGRAM, or `next` puts
    /// it there. Whether the server is used takes a restart (3-2-3). `edit` is why it is no online
    /// edit; empty: it could be. Throws ConfigError.
    void check_download(const ControllerConfig& next, const std::string& edit) const;
    /// Takes over another program of labels, if there is one.
    void download_labels();
    [[nodiscard]] Configured<void> check_listeners(const ControllerConfig& next) const;
    /// Whether the project, null for none, can have its labels of the PLC, if it is another one
    /// than `last`, the file of the one before. Any thread, while no program of labels is taken
    /// over. Throws ConfigError if the program of its labels is none.
    [[nodiscard]] Configured<void> check_labels(const KeptProject* project,
                                                const ControllerConfig& next,
                                                const std::string& last) const;
    /// What restart() would take up: whether it could. The labels of its project may have been
    /// checked already, which takes long.
    [[nodiscard]] Configured<void> may_restart(bool are_labels_checked);
    /// As what it runs with.
    void keep();
    void take_over(std::unique_ptr<Generation> next, net::Handover handover);
    void save_retained();
    void start();
    /// At what changes without anybody telling. From any thread.
    void look_soon();
    void start_again(const net::Handover& handover);
    void release(const Generation& gone);
    /// `change` may throw a ConfigError, which goes to the log.
    void try_to(FunctionRef<void()> change);

    Configuration configuration_;
    Runtime& runtime_;
    LogSink& log_;
    bool takes_signals_;
    bool greets_;
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    net::ServerLoop loop_{log_};
#ifdef BUSBAR_KEY_LOG
    std::unique_ptr<net::KeyLogFile> key_log_;
#endif
    std::optional<Machine> machine_;
    /// With a project of model mode, if the runtime has no labels of its own.
    std::optional<LabelPlant> labels_;
    Listening listening_;
    /// How often it tries to listen until then; 0: no restart is due.
    int looks_until_restart_{0};
    std::optional<storage::FolderStorage> kept_folder_;
    std::optional<TakenOverFiles> kept_;
    CurrentValidator clients_;
    PendingChanges pending_;
    /// The current generation's, for the discovery server.
    std::optional<channel::ApplicationIdentity> identity_;
    Standing standing_;
    std::optional<RuntimeUse> runtime_use_;
    /// Those before the current one, which clients have not left yet.
    std::vector<std::unique_ptr<Generation>> leaving_;
    std::unique_ptr<Generation> current_;
    /// While the program has instructions.
    std::optional<Ticker> instructions_;
    /// What it did not begin with, and why.
    std::string refused_;
    bool has_terminal_;
    bool starts_again_{false};
    /// How often it got another certificate.
    int renewals_{0};
    /// The generation that is being made, and what waits for that; null: there is none.
    std::shared_ptr<Successor> next_;
    std::vector<std::function<void()>> waiting_;
    /// Makes generations, and destroys those that went. Null after run().
    std::optional<net::WorkerThread> maker_{std::in_place, 64, &log_};
};

} // namespace busbar::product
