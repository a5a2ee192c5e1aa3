#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include <busbar/client/value_text.hpp>
#include <busbar/harness/bench.hpp>
#include <busbar/model/nodeset.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/ids.hpp>

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
    /// Sets what has changed since the last time, and raises what has happened.
    void tick()
    {
        const Duration time = bench_.world().now().time_since_epoch();
        for (const Running& one : running_) {
            Variant value = one.signal.at(time);
            if (value != source_.get(one.handle).value) {
                source_.set(one.handle, std::move(value));
            }
        }
        for (Watching& one : watching_) {
            const bool is_due = one.event.condition
                                    ? number_of(*one.event.condition).value_or(0) != 0
                                    : time >= one.next;
            if (is_due && (!one.event.condition || !one.was_due)) {
                raise(one.event.message, one.event.severity);
            }
            one.was_due = is_due;
            if (!one.event.condition && is_due) {
                one.next = time + one.event.period;
            }
        }
    }
    /// Carries out "set NAME VALUE", after which a signal rests, or "event MESSAGE SEVERITY"; false
    /// for other lines. Throws Failure for a line that is wrong.
    [[nodiscard]] bool obey(const std::string& line)
    {
        const std::vector<std::string> words = simulation_words(line);
        if (words.empty() || (words[0] != "set" && words[0] != "event")) {
            return false;
        }
        if (words.size() != 3) {
            throw Failure{Exit::Usage, words[0] == "set" ? "expected set NAME VALUE"
                                                         : "expected event MESSAGE SEVERITY"};
        }
        if (words[0] == "set") {
            set(words[1], words[2]);
            return true;
        }
        const auto event = read_simulation("X Byte 0\n" + line + " every 1s", "event");
        if (!event) {
            throw Failure{Exit::Usage, busbar::text(event.error())};
        }
        raise(event->events[0].message, event->events[0].severity);
        return true;
    }

private:
    struct Running {
        SimulatedSignal signal;
        std::uint64_t handle{0};
    };

    struct Watching {
        SimulatedEvent event;
        Duration next{0};
        bool was_due{false};
    };

    [[nodiscard]] std::optional<double> number_of(const Expression& expression,
                                                  const std::vector<SimulatedArgument>& inputs = {},
                                                  std::span<const Variant> values = {}) const
    {
        return expression.value([&](const std::string& name) -> std::optional<double> {
            for (std::size_t i = 0; i < std::min(inputs.size(), values.size()); ++i) {
                if (inputs[i].name == name) {
                    return number_in(values[i]);
                }
            }
            const auto found = handles_.find(name);
            return found == handles_.end() ? std::nullopt
                                           : number_in(source_.get(found->second).value);
        });
    }
    void set(const std::string& name, const std::string& text)
    {
        const auto found = handles_.find(name);
        if (found == handles_.end()) {
            throw Failure{Exit::Usage, "there is no variable \"" + safe(name) + "\""};
        }
        client::ValueType type;
        type.built_in = source_.get(found->second).value.type();
        auto value = client::parse_value(text, type);
        if (!value) {
            throw Failure{Exit::Usage, value.error().message};
        }
        std::erase_if(running_, [&](const Running& one) { return one.handle == found->second; });
        source_.set(found->second, *std::move(value));
    }
    void raise(const std::string& message, std::uint16_t severity)
    {
        server::Event event;
        event.source_name = "Simulation";
        event.message = LocalizedText{String{message}};
        event.severity = severity;
        static_cast<void>(bench_.server().raise_event(std::move(event)));
    }
    void add_method(const std::string& path, SimulatedMethod method)
    {
        model::NewMethod what;
        for (const SimulatedArgument& input : method.inputs) {
            what.input_arguments.push_back(argument_of(input));
        }
        for (const SimulatedAnswer& output : method.outputs) {
            what.output_arguments.push_back(argument_of(output.argument));
        }
        const std::string name = method.name;
        what.source = methods_.index();
        what.handle = methods_.add([this, kept = std::move(method)](server::MethodCall call) {
            carry_out(kept, std::move(call));
        });
        model::NewNode node;
        node.id = NodeId{1, String{name}};
        node.browse_name = QualifiedName{1, String{name}};
        node.parent = bench_.server().address_space().find(NodeId{0, id::ObjectsFolder});
        const auto added = bench_.server().address_space().add_method(node, what);
        if (!added) {
            throw Failure{added.error(), path + ": " + name};
        }
    }
    static Argument argument_of(const SimulatedArgument& argument)
    {
        Argument made;
        made.name = String{argument.name};
        made.data_type = NodeId{0, static_cast<std::uint32_t>(argument.type)};
        made.value_rank = -1;
        return made;
    }
    /// The settings see the values from before the call.
    void carry_out(const SimulatedMethod& method, server::MethodCall call)
    {
        Array<Variant> outputs;
        for (const SimulatedAnswer& answer : method.outputs) {
            Variant value = answer.input ? call.inputs()[*answer.input] : answer.value;
            if (answer.expression) {
                const auto number = number_of(*answer.expression, method.inputs, call.inputs());
                if (!number) {
                    call.fail(status::Bad_InvalidArgument);
                    return;
                }
                value = number_like(null_of(answer.argument.type), *number);
                if (value.is_null()) {
                    call.fail(status::Bad_InvalidArgument);
                    return;
                }
            }
            outputs.push_back(std::move(value));
        }
        std::vector<std::pair<std::uint64_t, Variant>> changed;
        for (const SimulatedMethod::Setting& setting : method.settings) {
            const std::uint64_t handle = handles_.at(setting.variable);
            const auto number = number_of(setting.expression, method.inputs, call.inputs());
            Variant value = number ? number_like(source_.get(handle).value, *number) : Variant{};
            if (value.is_null()) {
                call.fail(status::Bad_InvalidArgument);
                return;
            }
            changed.emplace_back(handle, std::move(value));
        }
        for (auto& [handle, value] : changed) {
            std::erase_if(running_, [&, id = handle](const Running& one) { //
                return one.handle == id;
            });
            source_.set(handle, std::move(value));
        }
        call.succeed(std::move(outputs));
    }

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
        auto machine = read_simulation(text, path);
        if (!machine) {
            throw Failure{Exit::Usage, busbar::text(machine.error())};
        }
        for (SimulatedVariable& variable : machine->variables) {
            const model::BoundValue bound = source_.variable(variable.signal.at({}));
            const auto added = bench_.add_variable(variable.name, bound,
                                                   variable.is_writable ? model::Access::ReadWrite
                                                                        : model::Access::Read);
            if (!added) {
                throw Failure{added.error(), path + ": " + variable.name};
            }
            handles_[variable.name] = bound.handle;
            if (variable.signal.kind != SimulatedSignal::Kind::Constant) {
                running_.push_back({std::move(variable.signal), bound.handle});
            }
        }
        for (SimulatedMethod& method : machine->methods) {
            add_method(path, std::move(method));
        }
        for (SimulatedEvent& event : machine->events) {
            const Duration first = event.period;
            watching_.push_back({std::move(event), first, false});
        }
    }

    harness::Bench bench_;
    server::MemorySource& source_{bench_.make_source<server::MemorySource>(bench_.world().clock())};
    server::MethodTable& methods_{bench_.make_source<server::MethodTable>()};
    std::vector<Running> running_;
    std::vector<Watching> watching_;
    std::map<std::string, std::uint64_t> handles_;
};

Exit simulate(Context& context, const SimulateArguments& arguments)
{
    LiveRun live{context, arguments.live};
    Simulation simulation{live.world(), live.url()};
    for (const std::string& file : arguments.files) {
        simulation.add(file);
    }
    context.err.line("busbar: a server without security is at " + live.url());
    return live.run([&] { simulation.tick(); },
                    [&](const std::string& line) { return simulation.obey(line); });
}

} // namespace

void add_simulate(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand(
        "simulate",
        "Runs a server with the variables, methods and events of files, for testing clients.");
    const auto arguments = std::make_shared<SimulateArguments>();
    command
        ->add_option("FILE", arguments->files,
                     "lines as \"Level Double ramp 0 100 60s\", or NodeSet2")
        ->required();
    add_live_options(*command, arguments->live);
    when_chosen(*command, run, [arguments](Context& context) {
        for (std::string& file : arguments->files) {
            unmark(file);
        }
        return simulate(context, *arguments);
    });
}

} // namespace busbar::tool
