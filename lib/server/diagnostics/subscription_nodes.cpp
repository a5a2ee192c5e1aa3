#include "subscription_nodes.hpp"

#include <string>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/ids.hpp>

#include "part_nodes.hpp"
#include "server/session/session.hpp"
#include "server/subscription/subscription.hpp"

namespace busbar::server::detail {

namespace {

PartNodes part_of(const DiagnosticsNeeds& needs, std::string_view name)
{
    return {.section = Section::Subscription,
            .name = name,
            .declaration =
                needs.space.find(id::SubscriptionDiagnosticsArrayType_SubscriptionDiagnostics),
            .type = id::SubscriptionDiagnosticsType,
            .fields = subscription_field_names(),
            .name_space = needs.own_namespace};
}

} // namespace

void SubscriptionNodes::added(const Subscription& subscription)
{
    model::AddressSpace& space = needs_.space;
    const model::NodeIndex array =
        space.find(id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray);
    if (array == model::no_node || !needs_.counters.is_enabled() ||
        entries_.contains(subscription.id())) {
        return;
    }
    const std::string name = std::to_string(subscription.id());
    Entry& entry = entries_[subscription.id()];
    busbar::detail::Undo undo{[&] { removed(subscription); }};
    const model::NodeIndex made =
        add_part(space, array, needs_.own_namespace, subscription.id(), part_of(needs_, name));
    if (made != model::no_node) {
        entry.element = space.handle(made);
        refer(subscription, entry);
        undo.keep();
    }
}

std::size_t SubscriptionNodes::add_fields(model::NodeIndex variable, std::uint64_t handle)
{
    const auto found = entries_.find(number_of(handle));
    if (found == entries_.end() || found->second.has_fields || field_of(handle) != 0) {
        return 0;
    }
    const std::size_t count = detail::add_fields(needs_.space, variable, needs_.own_namespace,
                                                 found->first, part_of(needs_, {}));
    found->second.has_fields = true;
    return count;
}

void SubscriptionNodes::refer(const Subscription& subscription, Entry& entry) const
{
    model::AddressSpace& space = needs_.space;
    const model::NodeIndex element = space.resolve(entry.element);
    const model::NodeIndex next = subscription.session() == nullptr
                                      ? model::no_node
                                      : sessions_.subscriptions_of(*subscription.session());
    const model::NodeIndex before = space.resolve(entry.array);
    if (element == model::no_node || next == before) {
        return;
    }
    const NodeId has_component{0, id::HasComponent};
    if (before != model::no_node) {
        static_cast<void>(space.remove_reference(before, has_component, element));
    }
    entry.array = {};
    if (next != model::no_node && space.add_reference(next, has_component, element)) {
        entry.array = space.handle(next);
    }
}

void SubscriptionNodes::moved(const Subscription& subscription)
{
    const auto found = entries_.find(subscription.id());
    if (found != entries_.end()) {
        refer(subscription, found->second);
    }
}

void SubscriptionNodes::removed(const Subscription& subscription)
{
    const auto found = entries_.find(subscription.id());
    if (found == entries_.end()) {
        return;
    }
    found->second.is_left = true;
    ++left_;
    remove_left();
}

void SubscriptionNodes::remove_left()
{
    for (auto entry = entries_.begin(); left_ != 0 && entry != entries_.end();) {
        if (!entry->second.is_left) {
            ++entry;
            continue;
        }
        const model::NodeIndex element = needs_.space.resolve(entry->second.element);
        const StatusCode thrown = busbar::detail::caught([&] {
            if (element != model::no_node) {
                static_cast<void>(needs_.space.remove(element));
            }
        });
        if (thrown.is_bad()) { // added with the next one
            return;
        }
        entry = entries_.erase(entry);
        --left_;
    }
}

void SubscriptionNodes::take_flag()
{
    if (std::exchange(is_shown_, needs_.counters.is_enabled()) == needs_.counters.is_enabled()) {
        return;
    }
    for (const auto& [id, subscription] : needs_.subscriptions.all()) {
        if (is_shown_) {
            added(*subscription);
        } else {
            removed(*subscription);
        }
    }
}

} // namespace busbar::server::detail
