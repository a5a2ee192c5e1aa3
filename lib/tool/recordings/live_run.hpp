#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <busbar/harness/fault.hpp>
#include <busbar/harness/recorded_messages.hpp>
#include <busbar/harness/recording.hpp>

#include "live_world.hpp"
#include "tool/connection/context.hpp"

namespace busbar::tool {

/// The options of commands that serve clients, and can record and disturb what is said.
struct LiveOptions {
    std::string listen{"127.0.0.1:0"};
    std::vector<std::string> faults;
    std::string faults_file;
    std::string record;
    double seconds{0};
    bool is_quiet{false};
    bool is_controlled{false};
};

void add_live_options(CLI::App& command, LiveOptions& options);

/// A world with a socket, whose messages are shown, recorded and disturbed.
class LiveRun {
public:
    /// Opens the socket, and reads the faults; throws Failure.
    LiveRun(Context& context, const LiveOptions& options);

    [[nodiscard]] harness::RealWorld& world() { return live_.world(); }
    /// The URL where clients connect.
    [[nodiscard]] const std::string& url() const { return url_; }
    /// Takes a line of standard input that is not a fault; false if it does not know it. A Failure
    /// that it throws is told.
    using Orders = std::function<bool(const std::string& line)>;
    /// Plays the faults and serves until it is over, calling `tick` several times a second. Writes
    /// the recording: an empty one first, so that a file that cannot be written fails early, and
    /// the whole one at the end, also of a run that throws. Partly if a fault has never acted.
    [[nodiscard]] Exit run(
        const std::function<void()>& tick = [] {}, const Orders& orders = nullptr);

private:
    void show_new_messages(std::size_t& next, harness::MessageReader& reader);
    void serve(const std::function<void()>& tick, const Orders& orders);
    /// Writes the recording, which only its owner may read: it has all that was sent.
    void save() const;

    Context& context_;
    LiveOptions options_;
    harness::FaultScript faults_;
    LiveWorld live_;
    std::shared_ptr<harness::Recorder> recorder_;
    std::string url_;
    bool is_full_{false};
};

} // namespace busbar::tool
