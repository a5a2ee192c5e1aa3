#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <busbar/harness/chance.hpp>

#include "programs/controller_administrator.hpp"
#include "programs/controller_site.hpp"
#include "programs/forked_controller.hpp"

namespace busbar::test {

/// What a controller should have.
struct Expectation {
    /// Changed online, as texts.
    std::map<std::string, std::string> online;
    /// Which of them are changed online is not known, as after a restore: what they are is in
    /// `online`.
    bool is_online_unknown{false};
    /// Passwords by names.
    std::map<std::string, std::string> users;
    std::set<std::string> trusted;
    /// Of drawn_roles.
    std::set<std::string> closed_roles;
    MachineText program;
    bool is_received{false};
    /// What the next start begins with instead: it was refused after it was stored, and media did
    /// not let it be taken back, as the status says.
    struct Stored {
        MachineText program;
        bool is_received{false};
    };
    std::optional<Stored> stored;
    /// Values of RETAIN variables; nothing: any.
    std::map<std::string, std::optional<std::int64_t>> retained;
    /// What the configuration's file says of settings.
    std::map<std::string, std::string> file;
    /// It listens on one of these ports.
    std::set<std::string> ports;
    /// Which of them may be a setting that was restored.
    bool is_port_unknown{false};

    /// Variables and thumbprints of which nothing is known before the next start: media failed, and
    /// what was refused is there, or follows once they work, by the contracts of
    /// server::ImageWriteLog and FileTransaction.
    std::set<std::string> doubtful;

    [[nodiscard]] std::string setting(const std::string& name) const;
    void take_program(const MachineText& next);
    friend bool operator==(const Expectation&, const Expectation&);
};

/// Administrators, people at the machine, media that fail and a power that goes, against one
/// controller. The same seed has the same steps, if not the same moments of kills: threads of the
/// controller write their files when they come to it.
class ControllerSimulation {
public:
    explicit ControllerSimulation(std::uint64_t seed);

    void run(std::size_t steps);

    struct Counts {
        std::size_t done{0};
        std::size_t refused{0};
        std::size_t unknown{0};
        std::size_t starts{0};
        std::size_t kills{0}; // in the middle of something
        std::size_t faults{0};
    };
    [[nodiscard]] const Counts& counts() const { return counts_; }
    /// What must not have happened; empty: nothing.
    [[nodiscard]] const std::vector<std::string>& violations() const { return violations_; }
    /// The steps, a line each, and what the controller said of them.
    [[nodiscard]] std::string story() const;

private:
    using Change = std::function<void(Expectation&)>;

    // The power.
    void power_cycle();
    void start();
    void start_on_failing_media();
    void arm();

    // What happens.
    void act();
    [[nodiscard]] std::map<std::string, std::string> draw_settings();
    void set_settings();
    void change_users();
    void change_roles();
    void change_trust();
    void send_program();
    void restore_program();
    /// What becomes of the expectation by a program that takes place after the answer.
    void follow_program(Outcome outcome, const std::string& what, const MachineText& next,
                        bool is_received);
    void write_value();
    void restart();
    void reload();
    void change_files();
    void move_listener();
    void listens_as_told_perhaps();
    void reset();
    /// How often it has said what came of a change.
    [[nodiscard]] std::size_t said() const;
    /// How often it has begun to serve.
    [[nodiscard]] std::size_t started() const;
    /// Of what takes place after its answer: until it is said, or sessions end.
    void wait_for_effect(std::size_t before);
    void damage();
    void back_up();
    void restore();
    void clear();
    void meet_again();

    /// What becomes of the expectation by what was asked for. Where that is refused while media
    /// fail, `doubtful` is.
    void follow(Outcome outcome, const std::string& what, const Change& change,
                const std::string& doubtful = {});
    /// It may have happened, or not.
    void perhaps(const Change& change);
    /// What is read at a start.
    void read_files(Expectation& all) const;
    /// Where it listens after a start.
    void listen(Expectation& all) const;
    [[nodiscard]] std::optional<ControllerReport> report_now();
    void check();
    /// All of it is what is expected from here on.
    void adopt(const ControllerReport& report);
    void learn(Expectation& expected, const ControllerReport& report) const;
    [[nodiscard]] std::string mismatch(const Expectation& expected, const ControllerReport& report);
    /// A list of roles that cannot be read opens no role that was closed.
    void check_closed(const Expectation& before, const ControllerReport& report);
    [[nodiscard]] std::string wrong_port(const Expectation& expected) const;
    void check_consistent(const ControllerReport& report);
    void check_explained(const std::map<std::string, ControllerReport::SettingReport>& settings);
    [[nodiscard]] std::string wrong_login(const Expectation& expected);

    void note(const std::string& what);
    void violation(const std::string& what);

    harness::Chance chance_;
    ControllerSite site_{chance_};
    std::vector<std::string> story_;
    std::vector<std::string> violations_;
    Counts counts_;
    std::unique_ptr<ForkedController> controller_;
    std::unique_ptr<ControllerAdministrator> chief_;
    /// One of them is right.
    std::vector<Expectation> expected_;
    /// What runs is also kept for the next start.
    bool is_kept_{false};
    /// It is to be killed, or media fail.
    bool is_armed_{false};
    bool is_failing_{false};
    /// Nobody has done anything since it started.
    bool is_fresh_{false};
    bool is_restart_due_{false};
    std::optional<std::string> backup_;
    std::vector<Expectation> backed_up_;
    std::map<std::string, std::optional<bool>> logins_;
    std::set<std::string> touched_;
};

} // namespace busbar::test
