#include <busbar/controller/machine_event_raiser.hpp>

#include <string>
#include <utility>

#include <busbar/types/ids.hpp>

namespace busbar::controller {

Result<void> MachineEventRaiser::attach(model::AddressSpace& address_space, model::NodeIndex folder,
                                        std::shared_ptr<server::EventQueue> queue)
{
    const NodeId system_event{0, id::SystemEventType};
    auto added = address_space.add_reference(address_space.find(id::Server),
                                             NodeId{0, id::HasNotifier}, folder);
    if (!added && added.error() != status::Bad_DuplicateReferenceNotAllowed) {
        return added;
    }
    const std::lock_guard lock{mutex_};
    event_type_ = address_space.find(system_event) != model::no_node ? system_event
                                                                     : NodeId{0, id::BaseEventType};
    source_ = address_space.node_id(folder);
    queue_ = std::move(queue);
    return {};
}

server::Event MachineEventRaiser::event_of(const MachineEvent& event) const
{
    server::Event result;
    result.event_type = event_type_;
    result.source_node = source_;
    result.source_name = String{std::string{source_details(*event.type)}};
    result.message = LocalizedText{"en", String{text(event)}};
    result.severity = severity_of(event.level);
    result.time = event.time;
    return result;
}

void MachineEventRaiser::happened(const MachineEvent& event)
{
    const std::lock_guard lock{mutex_};
    if (queue_ != nullptr) {
        // The queue counts and reports events that it has no room for.
        static_cast<void>(queue_->raise(event_of(event)));
    }
}

} // namespace busbar::controller
