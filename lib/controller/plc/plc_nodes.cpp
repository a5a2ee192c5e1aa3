#include <busbar/controller/plc_nodes.hpp>

#include <busbar/controller/plc_methods.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::controller {

namespace {

constexpr std::uint8_t subscribe_to_events = 0x01; // EventNotifierType, Part 3, 8.59

Result<model::NodeIndex> add_variable(model::AddressSpace& address_space, model::NodeIndex folder,
                                      std::uint16_t namespace_index, const Plc& plc,
                                      std::uint32_t handle, const PlcNodesOptions& options)
{
    const Plc::Variable& variable = plc.variables()[handle];
    const server::ImagePlace& place = plc.image()->layout()[handle];
    model::NewNode node;
    node.id = NodeId{namespace_index, String::borrow(variable.name)};
    node.browse_name = QualifiedName{namespace_index, String::borrow(variable.name)};
    node.parent = folder;
    model::NewVariable attributes;
    // A built-in type's DataType has the type's own number (Part 6, 5.1.2).
    attributes.data_type = NodeId{0, static_cast<std::uint32_t>(place.type)};
    if (place.is_array()) {
        attributes.value_rank = static_cast<std::int32_t>(place.dimensions.size());
        attributes.array_dimensions = Array<std::uint32_t>{place.dimensions};
    }
    attributes.access_level = variable.is_writable ? model::Access::ReadWrite : model::Access::Read;
    attributes.minimum_sampling_interval = to_milliseconds(options.cycle);
    attributes.source = options.source;
    attributes.handle = handle;
    return address_space.add_variable(node, attributes);
}

constexpr std::uint32_t uint32_type = 7;

} // namespace

Result<model::NodeIndex> publish_variables(model::AddressSpace& address_space, const Plc& plc,
                                           const PlcNodesOptions& options)
{
    const auto namespace_index = address_space.add_namespace(options.namespace_uri);
    if (!namespace_index) {
        return fail(namespace_index.error());
    }
    model::NewNode node;
    node.id = NodeId{*namespace_index, String::borrow(options.folder)};
    node.browse_name = QualifiedName{*namespace_index, String::borrow(options.folder)};
    node.parent = address_space.find(id::ObjectsFolder);
    model::NewObject attributes;
    attributes.type_definition = NodeId{0, id::FolderType};
    attributes.event_notifier = subscribe_to_events;
    node.reference_type = NodeId{0, id::Organizes};
    const auto folder = address_space.add_object(node, attributes);
    address_space.reserve(plc.variables().size());
    for (std::uint32_t handle = 0; folder && handle < plc.variables().size(); ++handle) {
        const auto added =
            add_variable(address_space, *folder, *namespace_index, plc, handle, options);
        if (!added) {
            return fail(added.error());
        }
    }
    return folder;
}

Result<void> publish_methods(model::AddressSpace& address_space, model::NodeIndex folder, Plc& plc,
                             server::MethodTable& table, std::uint32_t source)
{
    model::NewNode node;
    const std::uint16_t namespace_index = address_space.node_id(folder).namespace_index();
    node.id = NodeId{namespace_index, "ResetCounters"};
    node.browse_name = QualifiedName{namespace_index, "ResetCounters"};
    node.parent = folder;
    model::NewMethod method;
    method.output_arguments = {{"count", NodeId{0, uint32_type}, -1, {}, {}}};
    method.source = source;
    method.handle = table.add([&plc](server::MethodCall call) {
        plc.reset_counters();
        call.succeed({Variant{static_cast<std::uint32_t>(plc.counter_count())}});
    });
    const auto added = address_space.add_method(node, method);
    return added ? Result<void>{} : fail(added.error());
}

} // namespace busbar::controller
