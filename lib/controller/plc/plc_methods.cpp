#include <busbar/controller/plc_methods.hpp>

namespace busbar::controller {

namespace {

constexpr std::uint32_t uint32_type = 7;

} // namespace

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
