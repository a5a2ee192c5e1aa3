#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <sys/types.h>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/result.hpp>

namespace busbar::bench {

/// The roles of administration. An OwnController has an account of the same name with each of them,
/// and the password good_password.
inline constexpr std::array<std::string_view, 5> administration_roles{
    "SecurityAdmin", "ConfigureAdmin", "Engineer", "Supervisor", "Operator"};

/// What the controller is like.
struct OwnControllerOptions {
    /// The busbar-controller to run, such as one that was built with a sanitizer. Empty: the code
    /// of this program, whose pieces of work are measured then.
    std::string program{};
    /// Passwords cost as little as a configuration allows, and no failure has anybody wait.
    bool has_quick_logins{false};
    /// Its clients may connect even after ResetToServerDefaults.
    bool trusts_all_clients{false};
    /// Published DINT beside those that the program has anyway.
    std::size_t variables{0};
    /// In model mode, with so many INT labels instead and a folder for a project, but none in it.
    bool is_model{false};
};

/// A controller of this project in a process and a folder of its own, which has a program,
/// accounts, trusted certificates, files, logs and settings that can be changed. The machine is in
/// PROGRAM.
class OwnController {
public:
    static constexpr std::string_view program_file = "bench.st";

    /// Before this process has threads. Returns when it answers. Bad_CommunicationError if it does
    /// not, or ends; its output stays in the folder then.
    [[nodiscard]] static Result<std::unique_ptr<OwnController>>
    start(const OwnControllerOptions& options);
    OwnController(const OwnController&) = delete;
    OwnController& operator=(const OwnController&) = delete;
    /// Ends the process.
    ~OwnController();

    [[nodiscard]] const std::string& url() const { return url_; }
    [[nodiscard]] pid_t process() const { return process_; }
    [[nodiscard]] const std::string& folder() const { return folder_; }
    /// The client that it trusts.
    [[nodiscard]] const channel::ApplicationIdentity& client() const { return client_; }
    /// See take_longest_piece_ms of HostileOptions; 0 with a program of its own.
    [[nodiscard]] double take_longest_piece_ms();
    /// Writes the program's file, or another one in the folder. Number 0 is what it starts with;
    /// others have other variables.
    [[nodiscard]] bool write_program(std::size_t number,
                                     std::string_view file = program_file) const;
    /// Writes a project into the folder whose Variables are the labels, with this name for the
    /// server's certificate.
    [[nodiscard]] bool write_project(std::string_view file, const std::string& name) const;
    /// Has it read its files again, SIGHUP.
    void reload() const;
    [[nodiscard]] bool is_running();
    /// Ends it by SIGTERM, and waits. Its exit code, or that of the signal and 128.
    [[nodiscard]] int stop();
    /// What it has printed.
    [[nodiscard]] std::string output() const;
    /// Keeps the folder when this ends.
    void keep_folder() { keeps_folder_ = true; }

private:
    struct Shared;

    OwnController(std::string folder, channel::ApplicationIdentity client, Shared* shared,
                  OwnControllerOptions options);
    [[nodiscard]] bool write_files(std::uint16_t port) const;
    [[nodiscard]] bool begin();
    [[nodiscard]] bool await();

    std::string folder_;
    channel::ApplicationIdentity client_;
    /// With the process.
    Shared* shared_;
    std::string url_;
    OwnControllerOptions options_;
    pid_t process_{0};
    std::optional<int> exit_code_;
    bool keeps_folder_{false};
};

} // namespace busbar::bench
