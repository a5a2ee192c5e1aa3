#include <busbar/server/modules.hpp>
#include <busbar/types/filter.hpp>

#include "server/engine/core.hpp"
#include "server/engine/event_item.hpp"
#include "server/engine/type_table.hpp"
#include "server/event/events.hpp"
#include "server/event/model_change_events.hpp"

namespace busbar::server {

namespace detail {

namespace {

class EventServices final : public EventPart {
public:
    explicit EventServices(Core& core)
        : events_{core.environment, core.address_space, core.config.limits.events},
          model_changes_{core.address_space, events_, core.rationed_log, core.own_namespace}
    {
        model_changes_.begin();
    }

    [[nodiscard]] EventItems& items() { return items_; }

    [[nodiscard]] std::shared_ptr<EventQueue> queue() const override { return events_.queue(); }
    void handle_raised() override { events_.handle_raised(); }
    [[nodiscard]] bool has_model_changes() const override { return model_changes_.is_pending(); }
    void announce_model_changes() override { model_changes_.announce(); }
    void announce_semantics(const NodeId& node) override
    {
        model_changes_.announce_semantics(node);
    }

private:
    Events events_;
    EventItemMaker items_{events_};
    ModelChangeEvents model_changes_;
};

void add_events(Core& core)
{
    auto events = std::make_unique<EventServices>(core);
    core.subscription_needs.event_items = &events->items();
    core.events = std::move(events);
    core.types.add(0, type_table<EventFilter, AggregateFilter, ContentFilter, ElementOperand,
                                 LiteralOperand, AttributeOperand, SimpleAttributeOperand>());
}

} // namespace

} // namespace detail

constinit const Module modules::events{"events", detail::add_events};

} // namespace busbar::server
