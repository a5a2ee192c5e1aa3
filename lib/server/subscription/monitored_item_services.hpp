#pragma once

#include <busbar/types/monitored_item.hpp>

#include "server/session/service.hpp"

/// The MonitoredItem service set (Part 4, 5.13). All need an activated session.
namespace busbar::server::detail {

class Subscriptions;

[[nodiscard]] StatusCode create_monitored_items(Subscriptions& all, ServiceContext& context,
                                                const CreateMonitoredItemsRequest& request,
                                                CreateMonitoredItemsResponse& response);
[[nodiscard]] StatusCode modify_monitored_items(Subscriptions& all, ServiceContext& context,
                                                const ModifyMonitoredItemsRequest& request,
                                                ModifyMonitoredItemsResponse& response);
[[nodiscard]] StatusCode set_monitoring_mode(Subscriptions& all, ServiceContext& context,
                                             const SetMonitoringModeRequest& request,
                                             SetMonitoringModeResponse& response);
[[nodiscard]] StatusCode set_triggering(Subscriptions& all, ServiceContext& context,
                                        const SetTriggeringRequest& request,
                                        SetTriggeringResponse& response);
[[nodiscard]] StatusCode delete_monitored_items(Subscriptions& all, ServiceContext& context,
                                                const DeleteMonitoredItemsRequest& request,
                                                DeleteMonitoredItemsResponse& response);

} // namespace busbar::server::detail
