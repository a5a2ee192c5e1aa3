#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <busbar/harness/chance.hpp>

#include "programs/controller_administrator.hpp"
#include "programs/controller_site.hpp"
#include "programs/forked_controller.hpp"

namespace busbar::test {

/// A project's file, with a Variable "Number" of this value and one that is mapped to the label.
[[nodiscard]] std::string simulated_project(int number, const std::string& port,
                                            const std::string& label);
/// The namespace of its nodes.
inline constexpr const char* simulated_model = "urn:busbar:simulation";

/// An administrator who writes projects to a controller of model mode and has it serve them, media
/// that fail and a power that goes. The same seed has the same steps, if not the same moments of
/// kills.
class ModelSimulation {
public:
    explicit ModelSimulation(std::uint64_t seed);

    void run(std::size_t steps);

    struct Counts {
        std::size_t written{0};
        std::size_t updated{0};
        std::size_t refused{0};
        std::size_t unknown{0};
        std::size_t starts{0};
    };
    [[nodiscard]] const Counts& counts() const { return counts_; }
    /// What must not have happened; empty: nothing.
    [[nodiscard]] const std::vector<std::string>& violations() const { return violations_; }
    /// The steps, a line each, and what the controller said of them.
    [[nodiscard]] std::string story() const;

private:
    static constexpr int none = 0;
    static constexpr int damaged = -1;

    /// Projects by their numbers.
    struct Version {
        std::string document;
        std::string port;
        /// Its labels are in the PLC's program.
        bool is_usable;
    };
    /// What a controller should have.
    struct Projects {
        int stored{none};
        int served{none};
        /// What it ran with last, for the next start.
        int kept{none};
        /// Counts whatever its labels are.
        int accepted{none};

        friend bool operator==(const Projects&, const Projects&) = default;
    };
    using Change = std::function<void(Projects&)>;

    // The power.
    void arm();
    void power_cycle();
    void start();

    // What happens.
    void act();
    void write();
    void write_wrong();
    void update(bool despite_labels);
    void restart();
    void reload();
    void damage();

    [[nodiscard]] int new_version();
    /// Whether the project of the store may take the place of `last`.
    [[nodiscard]] bool counts(const Projects& all, int last) const;
    /// As for the changes of files it is told what it serves from now on.
    void take_up(Projects& all, int last) const;
    [[nodiscard]] std::string port_of(int number) const;
    void follow(Outcome outcome, const std::string& what, const Change& change);
    void perhaps(const Change& change);
    void forget_duplicates();
    void wait_for_effect();
    [[nodiscard]] std::string mismatch(const Projects& expected,
                                       const ControllerAdministrator::ProjectReport& report) const;
    void check();
    void note(const std::string& what);
    void violation(const std::string& what);

    harness::Chance chance_;
    ControllerSite site_{chance_, true};
    std::vector<std::string> story_;
    std::vector<std::string> violations_;
    Counts counts_;
    std::unique_ptr<ForkedController> controller_;
    std::unique_ptr<ControllerAdministrator> chief_;
    std::map<int, Version> versions_;
    /// One of them is right.
    std::vector<Projects> expected_;
    bool is_armed_{false};
    bool is_failing_{false};
    /// What runs is also kept for the next start.
    bool is_kept_{false};
};

} // namespace busbar::test
