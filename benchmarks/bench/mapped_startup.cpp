#include "mapped_startup.hpp"

#include <optional>
#include <utility>

#include <busbar/controller/mapped_nodes.hpp>
#include <busbar/controller/project_models.hpp>
#include <busbar/model/nodeset.hpp>

#include "mapped_plant.hpp"
#include "process.hpp"

namespace busbar::bench {

using namespace controller;

namespace {

/// Counts only while it runs.
template <typename Work>
auto add_time(double& ms, Work&& work)
{
    const double begin = thread_time_ms();
    auto result = std::forward<Work>(work)();
    ms += thread_time_ms() - begin;
    return result;
}

class ErrorCount final : public MappedObserver {
public:
    void label_update(LabelUpdate) override {}
    void error(const MappedError&) override { ++count; }

    std::size_t count{0};
};

/// What a server needs, and one of no security: keys are not made at start.
struct ServerParts {
    NullLog log;
    net::SystemWallClock wall_clock;
    crypto::SystemRandom random;
    std::optional<server::Server> server;

    [[nodiscard]] Configured<void> make()
    {
        server::ServerConfig config;
        config.endpoints = {{}};
        config.endpoints[0].allows_anonymous = true;
        config.endpoints[0].allows_user_name = false;
        auto made = server::Server::create(
            std::move(config), {.random = &random, .wall_clock = &wall_clock, .log = &log});
        if (!made) {
            return Unexpected{std::move(made).error()};
        }
        server.emplace(*std::move(made));
        return {};
    }
};

/// A server module that is switched on once.
class StartingModule {
public:
    StartingModule(const Program& program, SamplingMode mode)
        : labels_{SimulatedLabels::create(program).value()}
    {
        MappedOptions options;
        options.sampling = mode;
        options.limits = MappedLimits::rd81opc96();
        source_.emplace(labels_, options, &errors_);
    }

    /// Milliseconds.
    [[nodiscard]] Configured<double> start(const std::string& document, std::size_t mapped)
    {
        double ms = 0;
        const auto found = add_time(ms, [&] { return serve(document); });
        if (!found) {
            return Unexpected{found.error()};
        }
        // Labels are resolved in the first scan, sampling begins in the second.
        for (int i = 0; i < 3 || source_->is_updating(); ++i) {
            labels_->end_of_scan(parts_.wall_clock.now());
            add_time(ms, [&] {
                parts_.server->handle_completions(TimePoint{});
                return true;
            });
        }
        const auto wanted = mapped == 0 ? TargetStatus::Unknown : TargetStatus::Communicating;
        return *found == mapped && errors_.count == 0 && source_->target_status() == wanted
                   ? Configured<double>{ms}
                   : misconfigured("startup", "Variables are not served");
    }

private:
    /// The number of Variables that are mapped.
    [[nodiscard]] Configured<std::size_t> serve(const std::string& document)
    {
        const auto project = read_project(document, "bench.busbar");
        if (!project) {
            return Unexpected{project.error()};
        }
        const auto models = check(*project).and_then([&] { return load_models(*project); });
        if (!models) {
            return Unexpected{models.error()};
        }
        if (auto made = parts_.make(); !made) {
            return Unexpected{std::move(made).error()};
        }
        server::Server& server = *parts_.server;
        static_cast<void>(server.add_source(*source_));
        source_->set_space(&server.address_space());
        const auto mapping = models->load_into(server.address_space());
        if (!mapping) {
            return misconfigured("model", text(mapping.error().list().front()));
        }
        const auto mapped = map_nodes(server.address_space(), types_, *mapping, *source_);
        server.start(TimePoint{});
        source_->start();
        return mapped.variables;
    }

    ErrorCount errors_;
    binary::DynamicTypes types_;
    std::shared_ptr<SimulatedLabels> labels_;
    std::optional<MappedSource> source_; // outlives the server
    ServerParts parts_;
};

Configured<double> start_plain(const std::vector<ProjectModel>& files)
{
    std::vector<model::NodeSetSource> sources;
    for (const ProjectModel& each : files) {
        sources.push_back({each.name, each.text});
    }
    double ms = 0;
    const auto made = add_time(ms, [&]() -> Configured<void> {
        ServerParts parts;
        if (auto server = parts.make(); !server) {
            return server;
        }
        const auto loaded = model::load_nodesets(parts.server->address_space(), sources,
                                                 model::limits_for_large_models());
        parts.server->start(TimePoint{});
        return loaded ? Configured<void>{} : Unexpected{loaded.error().front()};
    });
    return made.transform([&] { return ms; });
}

} // namespace

Configured<MappedStartup> measure_mapped_startup(const MappedModel& model, SamplingMode mode,
                                                 int rounds)
{
    Project project;
    project.preset = "rd81opc96";
    project.security.allows_anonymous = true;
    project.models = model_files(model);
    const auto document = document_of(project);
    const auto program = program_of_labels(model.variable_count());
    if (!document || !program) {
        return Unexpected{document ? program.error() : document.error()};
    }
    MappedStartup mean;
    for (int i = 0; i < rounds; ++i) {
        const auto mapped = StartingModule{*program, mode}.start(
            *document, model.is_mapped ? model.variable_count() : 0);
        const auto plain = mapped ? start_plain(project.models) : mapped;
        if (!plain) {
            return Unexpected{plain.error()};
        }
        mean.mapped_ms += *mapped / rounds;
        mean.plain_ms += *plain / rounds;
    }
    return mean;
}

} // namespace busbar::bench
