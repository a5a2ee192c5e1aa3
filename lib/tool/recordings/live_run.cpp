#include "live_run.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include <poll.h>
#include <unistd.h>

#include "recording_file.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool {

namespace {

harness::FaultScript faults_of(const LiveOptions& options)
{
    harness::FaultScript script;
    if (!options.faults_file.empty()) {
        auto read = harness::read_faults(read_file(options.faults_file), options.faults_file);
        if (!read) {
            throw Failure{Exit::Usage, text(read.error())};
        }
        script = *std::move(read);
    }
    for (const std::string& one : options.faults) {
        auto fault = harness::parse_fault(one);
        if (!fault) {
            throw Failure{Exit::Usage, "--fault \"" + one + "\": " + fault.error().text};
        }
        script.push_back(*std::move(fault));
    }
    return script;
}

/// Plays faults as they come on standard input, one a line; a line that is none is told.
class Control {
public:
    explicit Control(const LiveRun::Orders& orders) : orders_{orders} {}

    /// Takes what is there, and never waits; adds what was played to `faults`.
    void look(Context& context, harness::Network& network, harness::FaultScript& faults)
    {
        read();
        for (std::size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n')) {
            play(context, network, rest_.substr(0, end), faults);
            rest_.erase(0, end + 1);
        }
        if (has_ended_ && !rest_.empty()) {
            play(context, network, std::exchange(rest_, {}), faults);
        }
        constexpr std::size_t max_line = 4'096;
        if (rest_.size() > max_line) {
            context.err.line(
                "busbar: found a line of more than 4096 bytes; input is not read any more");
            rest_.clear();
            has_ended_ = true;
        }
    }

private:
    void read()
    {
        pollfd input{STDIN_FILENO, POLLIN, 0};
        std::array<char, 4'096> bytes{};
        constexpr int most = 16; // the rest has its turn later
        for (int i = 0; i < most && !has_ended_ && ::poll(&input, 1, 0) > 0; ++i) {
            const auto size = ::read(STDIN_FILENO, bytes.data(), bytes.size());
            has_ended_ = size <= 0;
            rest_.append(bytes.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
        }
    }
    void play(Context& context, harness::Network& network, const std::string& line,
              harness::FaultScript& faults)
    {
        if (line.find_first_not_of(" \t\r") == std::string::npos) {
            return;
        }
        try {
            if (orders_ && orders_(line)) {
                context.err.line("busbar: done: " + safe(line));
                return;
            }
        } catch (const Failure& failure) {
            context.err.line("busbar: " + safe(line) + ": " + failure.what());
            return;
        }
        const auto fault = harness::parse_fault(line);
        if (!fault) {
            context.err.line("busbar: " + safe(line) + ": " + fault.error().text);
            return;
        }
        network.play(*fault);
        faults.push_back(*fault);
        context.err.line("busbar: played " + safe(harness::describe(*fault)));
    }

    const LiveRun::Orders& orders_;
    std::string rest_;
    bool has_ended_{false};
};

/// Tells which of the user's faults have never acted; those of the program itself may not.
Exit report(Context& context, harness::RealWorld& world, const harness::FaultScript& faults)
{
    std::istringstream pending{world.network().pending_faults()};
    Exit exit = Exit::Good;
    for (std::string line; std::getline(pending, line);) {
        const bool is_own = std::none_of(faults.begin(), faults.end(), [&](const auto& fault) {
            return harness::describe(fault) == line;
        });
        if (!is_own) {
            context.err.line("busbar: has never acted: " + safe(line));
            exit = Exit::Partly;
        }
    }
    return exit;
}

} // namespace

void add_live_options(CLI::App& command, LiveOptions& options)
{
    command.add_option("--listen", options.listen, "where clients connect (0: any port)")
        ->type_name("[ADDRESS:]PORT")
        ->capture_default_str();
    command.add_option("--fault", options.faults, "\"cut after PublishResponse 3\"; several")
        ->type_name("FAULT");
    command.add_option("--faults", options.faults_file, "a file of faults, one a line")
        ->type_name("FILE");
    command.add_option("--record", options.record, "for show, diff and replay")->type_name("FILE");
    command.add_flag("--control", options.is_controlled,
                     "plays faults from standard input, one a line");
    command.add_option("--for", options.seconds, "ends after so many seconds");
    command.add_flag("--quiet", options.is_quiet, "does not show messages");
}

LiveRun::LiveRun(Context& context, const LiveOptions& options)
    : context_{context}, options_{options}, faults_{faults_of(options)},
      recorder_{std::make_shared<harness::Recorder>(world().seed())}, url_{live_.open(
                                                                          options.listen)}
{
    world().network().set_observer(recorder_);
    world().network().forgive_pending_faults(); // they are told
}

void LiveRun::show_new_messages(std::size_t& next, harness::MessageReader& reader)
{
    const auto& entries = recorder_->recording().entries;
    for (; next < entries.size(); ++next) {
        for (const harness::RecordedMessage& message : reader.feed(entries[next])) {
            if (!options_.is_quiet) {
                print_message(context_, message);
            }
        }
    }
}

void LiveRun::save() const
{
    if (!options_.record.empty()) {
        write_secret_file(options_.record, harness::write_recording(recorder_->recording()));
    }
}

void LiveRun::serve(const std::function<void()>& tick, const Orders& orders)
{
    harness::MessageReader reader;
    Control control{orders};
    std::size_t next = 0;
    live_.run(options_.seconds, [&] {
        tick();
        if (options_.is_controlled) {
            control.look(context_, world().network(), faults_);
        }
        context_.err.write(world().log().text());
        world().log().clear();
        show_new_messages(next, reader);
        if (!recorder_->recording().is_complete && !std::exchange(is_full_, true)) {
            context_.err.line("busbar: the recording is full; later messages are neither shown nor "
                              "recorded");
        }
    });
}

Exit LiveRun::run(const std::function<void()>& tick, const Orders& orders)
{
    if (!is_stream(options_.record)) { // which would have all that is written to it
        save();                        // it is told now if that is impossible
    }
    world().network().play(faults_);
    try {
        serve(tick, orders);
    } catch (...) {
        save();
        throw;
    }
    save();
    return report(context_, world(), faults_);
}

} // namespace busbar::tool
