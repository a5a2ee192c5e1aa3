#include "simulated_runtime.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/types/enumerations.hpp>
#include <busbar/types/ids.hpp>

#include "product/access/part_rights.hpp"

namespace busbar::product {

namespace {

class SimulatedProgram final : public LoadedProgram {
public:
    explicit SimulatedProgram(controller::Plc& plc) : plc_{plc} {}

    void scan(DateTime, Duration elapsed) override { plc_.run_programs(elapsed); }

private:
    controller::Plc& plc_;
};

struct EventName {
    HardwareEvent event;
    std::string_view name;
};
constexpr std::array event_names{
    EventName{HardwareEvent::MajorFault, "major fault"},
    EventName{HardwareEvent::PartialFault, "partial fault"},
    EventName{HardwareEvent::PartialServerFault, "partial fault of the server"},
    EventName{HardwareEvent::MinorFault, "minor fault"},
    EventName{HardwareEvent::MinorServerFault, "minor fault of the server"},
    EventName{HardwareEvent::Watchdog, "watchdog"},
    EventName{HardwareEvent::MediumOut, "medium out"},
    EventName{HardwareEvent::MediumIn, "medium in"},
    EventName{HardwareEvent::MediumWorn, "medium worn"},
};

/// The medium's state for a name, set before the server is told of the event, if there is one.
struct MediumName {
    StorageMedium::State state;
    std::string_view name;
};
constexpr std::array medium_names{
    MediumName{StorageMedium::State::Usable, "medium in"},
    MediumName{StorageMedium::State::Away, "medium taken"},
    MediumName{StorageMedium::State::Full, "medium full"},
    MediumName{StorageMedium::State::Protected, "medium protected"},
};

model::NodeAccess access_of_hardware()
{
    constexpr auto may_see = static_cast<std::uint32_t>(PermissionType::Browse) |
                             static_cast<std::uint32_t>(PermissionType::Read);
    constexpr auto may_change = may_see | static_cast<std::uint32_t>(PermissionType::Call);
    const PartRight& right = right_of(AdministeredPart::Hardware);
    model::NodeAccess access;
    if (right.channel != administration::detail::over::any) {
        access.restrictions = right.channel;
    }
    const auto grant = [&](unsigned roles, std::uint32_t may) {
        for (NodeId& role : nodes_of(static_cast<administration::detail::Roles>(roles))) {
            access.role_permissions.push_back({std::move(role), static_cast<PermissionType>(may)});
        }
    };
    grant(right.change, may_change);
    grant(right.see & ~unsigned{right.change}, may_see);
    return access;
}

std::string expected_names(bool has_medium)
{
    std::string names;
    for (const EventName& each : event_names) {
        names += (names.empty() ? "expected " : ", ") + std::string{each.name};
    }
    for (const MediumName& each : medium_names) {
        const bool is_new = has_medium && each.state != StorageMedium::State::Usable;
        names += is_new ? ", " + std::string{each.name} : "";
    }
    return names;
}

void simulate(server::MethodCall call, StorageMedium* medium,
              const std::function<void(HardwareEvent)>& happened)
{
    const auto* const text = call.inputs()[0].get_if<String>();
    const std::string_view wanted = text != nullptr ? text->view() : std::string_view{};
    const auto* const event = std::ranges::find(event_names, wanted, &EventName::name);
    const auto* const state = std::ranges::find(medium_names, wanted, &MediumName::name);
    const bool is_of_medium = medium != nullptr && state != medium_names.end();
    if (is_of_medium) {
        medium->set(state->state);
    }
    if (event != event_names.end()) {
        happened(event->event);
    } else if (!is_of_medium) {
        return call.refuse({StatusCode{status::Bad_OutOfRange}}, expected_names(medium != nullptr));
    }
    call.succeed();
}

} // namespace

Configured<std::unique_ptr<LoadedProgram>> SimulatedRuntime::load(controller::Plc& plc,
                                                                  const controller::Program*)
{
    return std::make_unique<SimulatedProgram>(plc);
}

Result<void> publish_hardware(model::AddressSpace& space, model::NodeIndex folder,
                              server::MethodTable& table, std::uint32_t source,
                              StorageMedium* medium, std::function<void(HardwareEvent)> happened)
{
    const std::uint16_t index = space.node_id(folder).namespace_index();
    model::NewNode node;
    node.id = NodeId{index, "Machine/Hardware"};
    node.browse_name = QualifiedName{index, "Hardware"};
    node.parent = folder;
    const auto object = space.add_object(node);
    if (!object) {
        return fail(object.error());
    }
    node.id = NodeId{index, "Machine/Hardware/Simulate"};
    node.browse_name = QualifiedName{index, "Simulate"};
    node.parent = *object;
    model::NewMethod method;
    method.input_arguments = {{"Event", NodeId{0, id::String}, -1, {}, {}}};
    method.source = source;
    method.handle = table.add([medium, happened = std::move(happened)](server::MethodCall call) {
        simulate(std::move(call), medium, happened);
    });
    const auto added = space.add_method(node, method);
    if (!added) {
        return fail(added.error());
    }
    std::vector<model::NodeIndex> nodes{*object, *added};
    space.for_each_below(*added, [&](model::NodeIndex argument) {
        nodes.push_back(argument);
        return true;
    });
    for (const model::NodeIndex each : nodes) {
        space.set_node_access(each, access_of_hardware());
    }
    return {};
}

} // namespace busbar::product
