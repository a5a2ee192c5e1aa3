#pragma once

#include "value_item.hpp"

namespace busbar::server::detail {

/// Returns the source of an item's samples, or the reason why there is none.
[[nodiscard]] ReadPlan plan_sample(const SubscriptionNeeds& needs, const Subscription& subscription,
                                   const ReadTarget& id);
/// Returns true if the value is in a process image, whose scans can be followed one by one.
[[nodiscard]] bool can_follow_scans(const SubscriptionNeeds& needs, const ReadPlan& plan);

// Only for items in a group.

void remove_from_group(ValueItem& item);
/// Looks up the item's source again.
void rebind_in_group(ValueItem& item);
/// Does the same in the middle of a change of the node.
void node_changed_in_group(ValueItem& item);

} // namespace busbar::server::detail
