#include "startup_run.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/execution_log.hpp>
#include <busbar/controller/life_cycle.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/machine_nodes.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/server/server.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "process.hpp"

namespace busbar::bench {

using namespace controller;

namespace {

enum Phase : std::size_t { Declarations, Choosing, Making, Image, Nodes, Records };

constexpr const char* startup_url = "opc.tcp://192.168.250.1:4840";

template <typename Work>
auto timed(double& ms, Work&& work)
{
    const double begin = thread_time_ms();
    auto result = std::forward<Work>(work)();
    ms = thread_time_ms() - begin;
    return result;
}

class StartupClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override
    {
        return DateTime::from_unix_seconds(1'800'000'000);
    }
};

std::string declarations(std::size_t count)
{
    std::string text = "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n";
    for (std::size_t i = 0; i < count; ++i) {
        const std::string number = std::to_string(i);
        text += "    Station" + number + "_Value : INT; (* of station " + number + " *)\n";
    }
    return text + "END_VAR\n";
}

/// A machine that is switched on once.
class StartingMachine final : private ServerOperator {
public:
    StartingMachine(const std::string& text, std::size_t count, bool is_limited)
        : text_{&text}, limits_{is_limited ? nj501_publishing() : PublishingLimits{}}
    {
        point_.count = count;
        point_.is_limited = is_limited;
        ExecutionLogOptions options;
        options.max_waiting += count;
        options.max_files = 100;
        events_ = MachineEventLog::create(memory_, clock_, lines_).value();
        log_ = ExecutionLog::create(card_, clock_, *events_, options).value();
        life_.emplace(static_cast<ServerOperator&>(*this), clock_, *log_);
    }

    [[nodiscard]] Configured<StartupPoint> start()
    {
        const double begin = thread_time_ms();
        life_->power_on();
        point_.running_ms = thread_time_ms() - begin;
        if (life_->operating_status() != OperatingStatus::Running) {
            return Unexpected{problem_.value_or(Problem{.where = "start", .text = "failed"})};
        }
        if (const auto saved = timed(point_.saving_ms, [&] { return log_->write_pending(); });
            !saved || log_->lost() != 0) {
            return misconfigured("execution log", "records are lost");
        }
        point_.published = publication().published().size();
        return point_;
    }

private:
    void initialize() override
    {
        ServerSettings settings;
        settings.is_used = true;
        settings.execution_log.is_recorded = true;
        life_->initialized(settings);
    }
    void prepare(std::uint32_t number, const ServerSettings&) override
    {
        if (const auto made = make(); made) {
            life_->prepared(number, startup_url);
        } else {
            problem_ = made.error();
            life_->preparation_failed(number, PreparationFailure::Start, problem_->text);
        }
    }
    void reconfigure(std::uint32_t, const ServerSettings&, const StopNotice&) override {}
    void run() override {}
    void suspend(const StopNotice&) override {}
    void stop(const StopNotice&) override { life_->stopped(); }
    void add_variables() override {}
    void medium_changed(bool) override {}
    void save_now() override {}

    [[nodiscard]] Configured<void> make();
    [[nodiscard]] Configured<void> make_program();
    [[nodiscard]] Configured<void> make_server();
    [[nodiscard]] Configured<void> publish();
    [[nodiscard]] const Publication& publication() const { return program_->publication(); }
    [[nodiscard]] double& phase(Phase which) { return point_.phase_ms.at(which); }

    const std::string* text_;
    PublishingLimits limits_;
    StartupPoint point_;
    StartupClock clock_;
    crypto::SystemRandom random_;
    NullLog lines_;
    storage::MemoryStorage memory_;
    storage::MemoryStorage card_;
    std::unique_ptr<MachineEventLog> events_;
    std::unique_ptr<ExecutionLog> log_;
    std::optional<LifeCycle> life_;
    std::optional<Problem> problem_;
    std::unique_ptr<PublishedProgram> program_;
    std::optional<ProgramImage> image_;
    std::optional<server::ImageSource> source_; // outlives the server
    std::optional<server::Server> server_;
    std::uint16_t namespace_index_{0};
};

Configured<void> StartingMachine::make()
{
    return make_program().and_then([&] { return make_server(); }).and_then([&] {
        return publish();
    });
}

Configured<void> StartingMachine::make_program()
{
    auto read = timed(phase(Declarations), [&] { return read_declarations(*text_, "startup.st"); });
    if (!read) {
        return Unexpected{read.error()};
    }
    auto program =
        timed(phase(Choosing), [&] { return PublishedProgram::create(*std::move(read), limits_); });
    if (!program) {
        return Unexpected{program.error()};
    }
    program_ = *std::move(program);
    return {};
}

Configured<void> StartingMachine::make_server()
{
    const server::ServerEnvironment environment{
        .random = &random_, .wall_clock = &clock_, .log = log_.get()};
    server::ServerConfig config;
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    auto made = timed(phase(Making),
                      [&] { return server::Server::create(std::move(config), environment); });
    if (!made) {
        return Unexpected{std::move(made).error()};
    }
    server_.emplace(*std::move(made));
    server_->start(TimePoint{});
    const auto index = server_->address_space().add_namespace(MachineNodesOptions{}.namespace_uri);
    if (!index) {
        return misconfigured("namespace", "cannot be added", index.error());
    }
    namespace_index_ = *index;
    return {};
}

Configured<void> StartingMachine::publish()
{
    auto image = timed(phase(Image), [&] { return program_->make_image(namespace_index_, {}); });
    if (!image) {
        return Unexpected{image.error()};
    }
    image_ = *std::move(image);
    source_.emplace(image_->image());
    MachineNodesOptions options;
    options.source = server_->add_source(*source_);
    const auto nodes = timed(phase(Nodes), [&] {
        return MachineNodes::create(server_->address_space(), program_->program(), publication(),
                                    options);
    });
    if (!nodes) {
        return Unexpected{nodes.error()};
    }
    timed(phase(Records), [&] {
        tell(*log_, publication());
        return true;
    });
    return {};
}

Configured<StartupPoint> fastest(std::size_t count, bool is_limited, int rounds)
{
    const std::string text = declarations(count);
    std::optional<StartupPoint> best;
    for (int round = 0; round < rounds; ++round) {
        const auto machine = std::make_unique<StartingMachine>(text, count, is_limited);
        const auto point = machine->start();
        if (!point) {
            return point;
        }
        if (!best || point->running_ms < best->running_ms) {
            best = *point;
        }
    }
    return best ? Configured<StartupPoint>{*best} : misconfigured("rounds", "there is none");
}

} // namespace

Configured<std::vector<StartupPoint>> measure_startup(const StartupOptions& options)
{
    std::vector<StartupPoint> points;
    for (const auto* const counts : {&options.limited, &options.open}) {
        for (const std::size_t count : *counts) {
            if (count <= (points.empty() ? 0 : points.back().count)) {
                return misconfigured("startup", "the numbers of variables do not grow",
                                     status::Bad_InvalidArgument);
            }
            auto point = fastest(count, counts == &options.limited, options.rounds);
            if (!point) {
                return Unexpected{std::move(point).error()};
            }
            points.push_back(*point);
        }
    }
    return points;
}

} // namespace busbar::bench
