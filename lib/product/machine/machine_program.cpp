#include "machine_program.hpp"

#include <utility>

#ifdef BUSBAR_HAS_PLCOPEN
#include <busbar/di/nodes.hpp>
#include <busbar/plcopen/nodes.hpp>
#endif

#include "product/configuration/sections.hpp"
#include "product/configuration/toml_reader.hpp"
#include "program_file.hpp"

namespace busbar::product {

namespace {

constexpr const char* machine_uri = "urn:busbar:machine";

/// Adds the nodes that MachineTypes and MachineNodes look for: with them the DeviceSet has a
/// configuration of PLCopen.
void add_plcopen([[maybe_unused]] model::AddressSpace& space)
{
#ifdef BUSBAR_HAS_PLCOPEN
    expect(space.add(di::nodes()), "the nodes of DI");
    expect(space.add(plcopen::nodes()), "the nodes of PLCopen");
#endif
}

} // namespace

const std::string& controller_name(const ControllerConfig& config)
{
    return config.machine.name.empty() ? config.server.application_name : config.machine.name;
}

MachineProgram::MachineProgram(const ControllerConfig& config)
    : config_{config}, program_{controller::PublishedProgram::create(config.machine.program,
                                                                     config.machine.publishing)}
{
}

std::unique_ptr<controller::Plc> MachineProgram::make_plc(server::Server& server,
                                                          MemoryOf memory_of)
{
    if (config_.machine.has_plcopen) {
        add_plcopen(server.address_space());
    }
    const std::uint16_t index =
        expect(server.address_space().add_namespace(machine_uri), "the machine's namespace");
    server::ImageOptions image = config_.image;
    image.cycle = config_.scan;
    image_ =
        expect(program_->make_image(index, {.image = image,
                                            .elementary = controller::MachineTypes::elementary_in(
                                                server.address_space(), config_.machine.types),
                                            .runtime_of = std::move(memory_of)}));
    return expect(controller::Plc::create(config_.plc, program_->types(), *image_));
}

controller::MachineNodesOptions MachineProgram::node_options(std::uint32_t source) const
{
    controller::MachineNodesOptions options;
    options.namespace_uri = machine_uri;
    options.controller_name = controller_name(config_);
    options.types = config_.machine.types;
    options.source = source;
    options.cycle = config_.scan;
    options.has_events = true;
    return options;
}

model::NodeIndex MachineProgram::publish(server::Server& server, std::uint32_t source,
                                         const controller::MachineEventLog& log)
{
    model::AddressSpace& space = server.address_space();
    nodes_ = expect(controller::MachineNodes::create(
        space, program_->program(), program_->publication(), node_options(source)));
    show_mode(server, config_.machine.mode);
    expect(view_.attach(server, *nodes_, log), "the machine's events");
    return space.resolve(nodes_->folder());
}

void MachineProgram::show_mode(server::Server& server, controller::MachineMode mode) const
{
    nodes_->set_mode(server.address_space(), mode == controller::MachineMode::Run
                                                 ? controller::OperatingMode::Run
                                                 : controller::OperatingMode::Program);
}

void MachineProgram::tell_left_out(LogSink& log) const
{
    product::tell_left_out(log, program_->editions().back()->program(),
                           config_.machine.program_name);
}

Configured<controller::ProgramAddition>
MachineProgram::edit(controller::PublishedProgram::Edition edited, server::Server& server)
{
    auto added = program_->edit(std::move(edited), nodes_->namespace_index(), *image_);
    if (!added) {
        return added;
    }
    nodes_->remove_variables(server.address_space(), added->removed);
    if (auto shown = nodes_->add_variables(server.address_space(), program_->publication(),
                                           program_->handles());
        !shown) {
        return Unexpected{std::move(shown).error()};
    }
    return added;
}

} // namespace busbar::product
