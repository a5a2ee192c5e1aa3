#include <busbar/controller/plc_events.hpp>

#include <algorithm>

namespace busbar::controller {

namespace {

/// Adds a reference. It may exist already, for example if a variable has two events.
Result<void> connect(model::AddressSpace& address_space, model::NodeIndex from,
                     std::uint32_t reference_type, model::NodeIndex to)
{
    auto added = address_space.add_reference(from, NodeId{0, reference_type}, to);
    if (!added && added.error() == status::Bad_DuplicateReferenceNotAllowed) {
        return {};
    }
    return added;
}

} // namespace

Result<PlcEvents> PlcEvents::create(model::AddressSpace& address_space, model::NodeIndex folder,
                                    const Plc& plc, std::shared_ptr<server::EventQueue> queue)
{
    PlcEvents result{plc, std::move(queue)};
    if (auto made = connect(address_space, address_space.find(id::Server), id::HasNotifier, folder);
        !made) {
        return fail(made.error());
    }
    const std::uint16_t namespace_index = address_space.node_id(folder).namespace_index();
    for (std::size_t i = 0; i < plc.events().size(); ++i) {
        const PlcEvent& configured = plc.events()[i];
        server::Event event;
        event.source_node = NodeId{namespace_index, plc.variables()[plc.event_handle(i)].name};
        event.source_name = configured.variable;
        event.message = LocalizedText{configured.message};
        event.severity = configured.severity;
        const auto variable = address_space.find(event.source_node);
        if (auto made = connect(address_space, folder, id::HasEventSource, variable); !made) {
            return fail(made.error());
        }
        result.events_.push_back(std::make_shared<const server::Event>(std::move(event)));
    }
    return result;
}

void PlcEvents::raise(DateTime time) const
{
    for (const std::uint32_t index : plc_->occurrences()) {
        // The queue counts and reports events that it has no room for.
        static_cast<void>(queue_->raise(events_[index], time));
    }
}

} // namespace busbar::controller
