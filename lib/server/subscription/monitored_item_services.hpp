#pragma once

#include <busbar/types/monitored_item.hpp>

#include "server/session/service.hpp"

/// The MonitoredItem service set (Part 4, 5.13). All need an activated session.
namespace busbar::server::detail {

class Subscriptions;

[[nodiscard]] std::unique_ptr<Operation> make_create_monitored_items(Subscriptions& all);
[[nodiscard]] std::unique_ptr<Operation> make_modify_monitored_items(Subscriptions& all);
[[nodiscard]] std::unique_ptr<Operation> make_set_monitoring_mode(Subscriptions& all);
[[nodiscard]] StatusCode set_triggering(Subscriptions& all, ServiceContext& context,
                                        const SetTriggeringRequest& request,
                                        SetTriggeringResponse& response);
[[nodiscard]] std::unique_ptr<Operation> make_delete_monitored_items(Subscriptions& all);

} // namespace busbar::server::detail
