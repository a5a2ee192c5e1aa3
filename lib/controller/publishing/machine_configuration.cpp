#include "machine_configuration.hpp"

#include <unordered_map>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/model/instance.hpp>
#include <busbar/model/plcopen.hpp>

namespace busbar::controller::detail {

namespace {

/// Nodes by the folded names of the types and tasks that they represent.
using NodesByName = std::unordered_map<std::string, model::NodeIndex>;

Unexpected<Problem> configuration_problem(const char* list, std::size_t index,
                                          const std::string& name, std::string text,
                                          StatusCode code = status::Bad_ConfigurationError)
{
    return misconfigured(std::string{list} + "[" + std::to_string(index) + "] (" + printable(name) +
                             ")",
                         std::move(text), code);
}

class ConfigurationBuilder {
public:
    ConfigurationBuilder(model::AddressSpace& space, std::uint16_t namespace_index,
                         const Program& program)
        : space_{space}, namespace_index_{namespace_index}, program_{program}
    {
    }

    [[nodiscard]] QualifiedName name(const std::string& text) const
    {
        return {namespace_index_, String{text}};
    }
    [[nodiscard]] Result<model::NodeIndex> add_configuration(const MachineNodesOptions& options)
    {
        model::NewNode node;
        node.id = NodeId{namespace_index_, "PLCopen/Configuration"};
        node.browse_name = name(options.controller_name);
        model::InstanceOptions choice;
        choice.optional = {"GlobalVars"};
        const auto configuration = model::add_ctrl_configuration(space_, node, choice);
        if (!configuration) {
            return configuration;
        }
        const auto resource = model::add_ctrl_resource(
            space_, *configuration, name(options.resource_name), options.nameplate);
        resource_ = resource ? *resource : model::no_node;
        return resource ? configuration : resource;
    }
    [[nodiscard]] Configured<void> add_tasks()
    {
        for (std::size_t i = 0; i < program_.tasks.size(); ++i) {
            const ProgramTask& task = program_.tasks[i];
            model::CtrlTask properties;
            properties.priority = task.priority;
            if (!task.interval.empty()) {
                properties.interval = String{task.interval};
            }
            const auto added = model::add_ctrl_task(space_, resource_, name(task.name), properties);
            if (!added) {
                return configuration_problem("tasks", i, task.name, "cannot be made a node",
                                             added.error());
            }
            tasks_.emplace(fold_name(task.name), *added);
        }
        return {};
    }
    [[nodiscard]] Configured<void> add_programs()
    {
        for (std::size_t i = 0; i < program_.instances.size(); ++i) {
            const ProgramInstance& instance = program_.instances[i];
            const auto task = tasks_.find(fold_name(instance.task));
            if (!instance.task.empty() && task == tasks_.end()) {
                return configuration_problem("instances", i, instance.name,
                                             "is run by the task " + printable(instance.task) +
                                                 ", which is not declared");
            }
            const auto added =
                add_program(instance, instance.task.empty() ? model::no_node : task->second);
            if (!added) {
                return configuration_problem("instances", i, instance.name, "cannot be made a node",
                                             added.error());
            }
        }
        return {};
    }

private:
    [[nodiscard]] Result<model::NodeIndex> add_program(const ProgramInstance& instance,
                                                       model::NodeIndex task)
    {
        const auto [type, is_new] =
            types_.try_emplace(fold_name(instance.type_name), model::no_node);
        if (is_new) {
            const auto added = model::add_program_type(space_, name(instance.type_name));
            if (!added) {
                return added;
            }
            type->second = *added;
        }
        return model::add_program(space_, resource_, name(instance.name), type->second, task);
    }

    model::AddressSpace& space_;
    std::uint16_t namespace_index_;
    const Program& program_;
    model::NodeIndex resource_{model::no_node};
    NodesByName tasks_;
    NodesByName types_;
};

} // namespace

Configured<model::NodeIndex> add_machine_configuration(model::AddressSpace& space,
                                                       std::uint16_t namespace_index,
                                                       const Program& program,
                                                       const MachineNodesOptions& options)
{
    if (model::find_plcopen(space, model::plcopen_id::CtrlConfigurationType) == model::no_node) {
        return model::no_node;
    }
    ConfigurationBuilder builder{space, namespace_index, program};
    const auto configuration = builder.add_configuration(options);
    if (!configuration) {
        return misconfigured("controller_name", "cannot be made a configuration of PLCopen",
                             configuration.error());
    }
    if (auto tasks = builder.add_tasks(); !tasks) {
        return Unexpected<Problem>{std::move(tasks.error())};
    }
    if (auto programs = builder.add_programs(); !programs) {
        return Unexpected<Problem>{std::move(programs.error())};
    }
    return model::find_by_path(space, *configuration, "GlobalVars");
}

} // namespace busbar::controller::detail
