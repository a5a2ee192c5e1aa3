#pragma once

#include "value_item.hpp"

namespace busbar::server::detail {

/// Where an item's samples come from, and why if they cannot.
[[nodiscard]] ReadPlan plan_sample(const SubscriptionNeeds& needs, const Subscription& subscription,
                                   const ReadTarget& id);
/// True if the value lies in a process image, whose scans can be followed one by one.
[[nodiscard]] bool can_follow_scans(const SubscriptionNeeds& needs, const ReadPlan& plan);

// For items that are in a group.

void remove_from_group(ValueItem& item);
/// What the item was bound to is looked up again.
void rebind_in_group(ValueItem& item);
/// The same in the middle of a change of the node.
void node_changed_in_group(ValueItem& item);

} // namespace busbar::server::detail
