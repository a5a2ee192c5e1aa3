#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/mapped_nodes.hpp>
#include <busbar/controller/plc.hpp>
#include <busbar/controller/simulated_labels.hpp>
#include <busbar/harness/bench.hpp>
#include <busbar/model/data_types.hpp>

#include "mapped_fixture.hpp"

namespace busbar::test {

struct LabelWorldOptions {
    std::uint64_t seed{harness::World::seed_from_environment()};
    controller::SamplingMode sampling{controller::SamplingMode::Standard};
    controller::SimulatedLabelsOptions labels{};
    /// What the program does to its variables.
    controller::PlcConfig plc{};
};

/// A simulated PLC with labels, a server that has them as nodes, and a client behind a network: all
/// of it real but for the time.
class LabelWorld : public harness::Bench {
public:
    static constexpr std::chrono::milliseconds scan_cycle{20};

    explicit LabelWorld(controller::Program program, LabelWorldOptions options = {});
    LabelWorld(const std::string& types, const std::string& variables,
               LabelWorldOptions options = {})
        : LabelWorld{program_of(types, variables), std::move(options)}
    {
    }

    /// Global variables as their declarations, all published.
    [[nodiscard]] static controller::Program program_of(const std::string& types,
                                                        const std::string& variables);
    [[nodiscard]] static NodeId own(const std::string& name) { return NodeId{1, String{name}}; }

    /// A Variable that is mapped to one label.
    void add(const std::string& name, const NodeId& type, const std::string& label);
    void add(const std::string& name, const NodeId& type, controller::MappedPart value,
             std::uint32_t elements = 0, Variant initial = {});
    /// A Method of the Objects folder.
    void add(const std::string& name, const Array<Argument>& inputs,
             controller::MethodMapping mapping);
    [[nodiscard]] model::NewNode named(const std::string& name, const NodeId& parent);
    /// Maps what was added, starts the source, connects the client.
    void start();
    /// The PLC gets another program.
    void download(const std::string& types, const std::string& variables);
    /// A scan that takes long.
    void stop_scans() { scan_.cancel(); }
    void go_on_scanning() { scan_.set_after(scan_cycle); }
    void run_scans(int count) { run_for(count * scan_cycle); }

    [[nodiscard]] Array<DataValue> read_all(const std::vector<std::string>& names);
    [[nodiscard]] DataValue read(const std::string& name) { return read_all({name})[0]; }
    [[nodiscard]] Array<StatusCode>
    write(const std::vector<std::pair<std::string, Variant>>& values);
    [[nodiscard]] StatusCode write(const std::string& name, Variant value)
    {
        return write({{name, std::move(value)}})[0];
    }
    [[nodiscard]] CallMethodResult call(const std::string& method, Array<Variant> inputs);
    /// A Subscription of 200 ms with these Variables.
    void monitor(const std::vector<std::string>& names);
    /// The values of the next notification, in the order of the Variables.
    [[nodiscard]] std::vector<std::pair<std::uint32_t, DataValue>> next();

    /// A variable in the PLC's memory.
    template <typename T>
    [[nodiscard]] T& variable(std::string_view name)
    {
        const auto program = labels->program();
        return labels->memory().value<T>(program->handle_of(*program->variable(name)).value());
    }

    std::shared_ptr<controller::SimulatedLabels> labels;
    ErrorBook book;
    controller::MappedSource source;
    model::DataTypes data_types;
    controller::Mapping mapping;

private:
    void scan();
    [[nodiscard]] std::unique_ptr<controller::Plc> make_plc() const;

    LabelWorldOptions options_;
    std::unique_ptr<controller::Plc> plc_;
    std::unique_ptr<controller::Plc> next_plc_;
    harness::Alarm scan_;
};

/// Parts of a value.
[[nodiscard]] controller::MappedPart part_of(std::vector<controller::MappedPart> parts);
[[nodiscard]] controller::MappedPart element(std::uint32_t number, std::string label,
                                             std::vector<controller::MappedPart> parts = {});
[[nodiscard]] controller::MappedPart field(std::string name, std::string label);

} // namespace busbar::test
