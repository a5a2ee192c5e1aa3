#pragma once

#include <busbar/types/monitored_item.hpp>

#include "server/session/service.hpp"

/// The MonitoredItem service set (Part 4, 5.13). All need an activated session.
namespace busbar::server::detail {

class SubscriptionTable;

[[nodiscard]] std::unique_ptr<ServiceOperation> make_create_monitored_items(SubscriptionTable& all);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_modify_monitored_items(SubscriptionTable& all);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_set_monitoring_mode(SubscriptionTable& all);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_set_triggering(SubscriptionTable& all);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_delete_monitored_items(SubscriptionTable& all);

} // namespace busbar::server::detail
