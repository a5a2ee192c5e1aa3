#include <memory>

#include <busbar/harness/bench.hpp>
#include <busbar/model/nodeset.hpp>
#include <busbar/server/memory_source.hpp>

#include "live_run.hpp"
#include "simulation.hpp"
#include "tool/commands/commands.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool {

namespace {

struct SimulateArguments {
    std::vector<std::string> files;
    LiveOptions live;
};

/// The server, and the values that pass.
class Simulation {
public:
    Simulation(harness::RealWorld& world, const std::string& url) : bench_{world, options(url)} {}

    /// A NodeSet2 file or a list of Variables, by its content; throws Failure.
    void add(const std::string& path)
    {
        const std::string text = read_file(path, model::NodeSetLimits{}.max_file_size);
        const std::size_t begin = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
        if (begin != std::string::npos && text[begin] == '<') {
            add_nodeset(path, text);
        } else {
            add_variables(path, text);
        }
    }
    /// Sets what has changed since the last time.
    void tick()
    {
        const Duration time = bench_.world().now().time_since_epoch();
        for (const Running& one : running_) {
            Variant value = one.signal.at(time);
            if (value != source_.get(one.handle).value) {
                source_.set(one.handle, std::move(value));
            }
        }
    }

private:
    struct Running {
        SimulatedSignal signal;
        std::uint64_t handle{0};
    };

    static harness::BenchOptions options(const std::string& url)
    {
        harness::BenchOptions options;
        options.server.endpoint_url = url;
        options.server.application_uri = "urn:busbar:simulation";
        return options;
    }
    void add_nodeset(const std::string& path, const std::string& text)
    {
        const model::NodeSetSource source{path, text};
        const auto loaded = model::load_nodesets(bench_.server().address_space(), {&source, 1});
        if (!loaded) {
            throw Failure{Exit::Usage, busbar::text(loaded.error().front())};
        }
    }
    void add_variables(const std::string& path, const std::string& text)
    {
        auto variables = read_simulation(text, path);
        if (!variables) {
            throw Failure{Exit::Usage, busbar::text(variables.error())};
        }
        for (SimulatedVariable& variable : *variables) {
            const model::BoundValue bound = source_.variable(variable.signal.at({}));
            const auto added = bench_.add_variable(variable.name, bound,
                                                   variable.is_writable ? model::Access::ReadWrite
                                                                        : model::Access::Read);
            if (!added) {
                throw Failure{added.error(), path + ": " + variable.name};
            }
            if (variable.signal.kind != SimulatedSignal::Kind::Constant) {
                running_.push_back({std::move(variable.signal), bound.handle});
            }
        }
    }

    harness::Bench bench_;
    server::MemorySource& source_{bench_.make_source<server::MemorySource>(bench_.world().clock())};
    std::vector<Running> running_;
};

Exit simulate(Context& context, const SimulateArguments& arguments)
{
    LiveRun live{context, arguments.live};
    Simulation simulation{live.world(), live.url()};
    for (const std::string& file : arguments.files) {
        simulation.add(file);
    }
    context.err.line("busbar: a server without security is at " + live.url());
    return live.run([&] { simulation.tick(); });
}

} // namespace

void add_simulate(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand(
        "simulate",
        "Is a server with the variables of files; shows, records and disturbs messages.");
    const auto arguments = std::make_shared<SimulateArguments>();
    command
        ->add_option("FILE", arguments->files,
                     "lines as \"Level Double ramp 0 100 60s\", or NodeSet2")
        ->required();
    add_live_options(*command, arguments->live);
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            for (std::string& file : arguments->files) {
                unmark(file);
            }
            return simulate(context, *arguments);
        };
    });
}

} // namespace busbar::tool
