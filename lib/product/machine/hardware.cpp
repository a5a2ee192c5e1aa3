#include "hardware.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/types/enumerations.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::product {

namespace {

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
};

model::NodeAccess for_those_who_may_stop()
{
    constexpr auto may = static_cast<std::uint32_t>(PermissionType::Browse) |
                         static_cast<std::uint32_t>(PermissionType::Read) |
                         static_cast<std::uint32_t>(PermissionType::Call);
    model::NodeAccess access;
    for (const std::uint32_t role : {id::WellKnownRole_Engineer, id::WellKnownRole_ConfigureAdmin,
                                     id::WellKnownRole_SecurityAdmin}) {
        RolePermissionType permission;
        permission.role_id = NodeId{0, role};
        permission.permissions = static_cast<PermissionType>(may);
        access.role_permissions.push_back(std::move(permission));
    }
    return access;
}

void simulate(server::MethodCall call, const std::function<void(HardwareEvent)>& happened)
{
    const auto* const text = call.inputs()[0].get_if<String>();
    const std::string_view wanted = text != nullptr ? text->view() : std::string_view{};
    const auto* const found =
        std::find_if(event_names.begin(), event_names.end(),
                     [&](const EventName& each) { return each.name == wanted; });
    if (found == event_names.end()) {
        std::string names;
        for (const EventName& each : event_names) {
            names += (names.empty() ? "expected " : ", ") + std::string{each.name};
        }
        return call.refuse({StatusCode{status::Bad_OutOfRange}}, std::move(names));
    }
    happened(found->event);
    call.succeed();
}

} // namespace

Result<void> publish_hardware(model::AddressSpace& space, model::NodeIndex folder,
                              server::MethodTable& table, std::uint32_t source,
                              std::function<void(HardwareEvent)> happened)
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
    method.handle = table.add([happened = std::move(happened)](server::MethodCall call) {
        simulate(std::move(call), happened);
    });
    const auto added = space.add_method(node, method);
    if (!added) {
        return fail(added.error());
    }
    space.set_node_access(*object, for_those_who_may_stop());
    space.set_node_access(*added, for_those_who_may_stop());
    return {};
}

} // namespace busbar::product
