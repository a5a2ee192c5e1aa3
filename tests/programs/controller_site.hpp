#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <busbar/core/variant.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/harness/chance.hpp>

#include "support/temporary_folder.hpp"

namespace busbar::test {

/// A program of the machine, which is told from others by its text.
struct MachineText {
    std::string text;
    /// Its variables, of which those that are RETAIN begin with "Kept" or are Total.
    std::set<std::string> variables;
};

[[nodiscard]] std::vector<std::string> variable_names();
[[nodiscard]] bool is_retained(const std::string& variable);

/// A setting that the simulation changes, and what it may be.
struct DrawnSetting {
    const char* name;
    /// Of a whole number; of a text both are 0.
    std::int64_t least;
    std::int64_t most;
};

inline constexpr std::array drawn_settings{
    DrawnSetting{"limits.sessions", 40, 60},
    DrawnSetting{"limits.pending_requests", 50, 90},
    DrawnSetting{"machine.execution_log_files", 3, 9},
    DrawnSetting{"plc.waiting_writes", 600, 900},
    DrawnSetting{"plc.scan_ms", 5, 20},
    DrawnSetting{"server.name", 0, 0},
};
inline constexpr const char* mode_setting = "machine.mode";
inline constexpr const char* in_run = "RUN";
inline constexpr const char* in_program = "PROGRAM";
[[nodiscard]] std::vector<std::string> setting_names();
/// As a client sets it: the mode or a drawn setting; null for an empty text.
[[nodiscard]] Variant variant_of(const std::string& setting, const std::string& text);

/// What lies at a machine: the folders of a controller and of its administrator, with the files
/// that people there change.
class ControllerSite {
public:
    static constexpr const char* password = "patience is all"; // of the user chief

    explicit ControllerSite(harness::Chance& chance, bool is_model = false);
    ControllerSite(const ControllerSite&) = delete;
    ControllerSite& operator=(const ControllerSite&) = delete;
    ~ControllerSite() { release(); }

    void write_configuration();
    void write_program();
    [[nodiscard]] MachineText new_program(bool is_other_type);
    void damage_configuration();
    void damage_program();
    /// Has the controller trust the administrator.
    void lay_certificate() const;
    /// The administrator meets a controller with another certificate.
    void forget_controller() const;
    /// Later controllers have the certificate of this one: keys take long to make.
    void keep_own_certificate() const;
    /// The files that the controller has written, by their names; without its own certificate, and
    /// without a program that was sent to it: one that is damaged keeps everything as it ran last
    /// until somebody sends another one.
    [[nodiscard]] std::vector<fs::path> kept_files() const;
    [[nodiscard]] fs::path log() const { return folder.path / "log"; }
    /// Of the two ports, the one that the file does not name.
    [[nodiscard]] std::string other_port() const;
    /// Takes the port, so that no controller can listen there, until release(). False if somebody
    /// has it.
    [[nodiscard]] bool occupy(const std::string& port);
    void release();
    /// The port that is taken; empty: none.
    [[nodiscard]] const std::string& occupied() const { return occupied_; }
    /// Another one each time.
    [[nodiscard]] int next_number() { return ++number_; }
    /// Certificates of clients that a controller may trust.
    [[nodiscard]] static const std::vector<crypto::Certificate>& strangers();

    TemporaryFolder folder;
    std::string file;
    std::vector<std::string> ports;
    /// What the configuration's file says.
    std::map<std::string, std::string> settings;
    bool is_file_good{true};
    MachineText program;
    bool is_program_good{true};

private:
    /// What [machine] has beside the program.
    [[nodiscard]] std::string machine_lines();

    harness::Chance& chance_;
    /// Of model mode: the program is that of the labels.
    bool is_model_;
    int number_{0};
    std::string occupied_;
    int occupier_{-1};
};

/// All of it; empty if it is not there.
[[nodiscard]] std::string read_all(const fs::path& path);

} // namespace busbar::test
