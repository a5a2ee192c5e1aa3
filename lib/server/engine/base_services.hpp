#pragma once

namespace busbar::server::detail {

class ServiceTable;

/// Adds the services of every server: Discovery, Session, Attribute, View and Subscription
/// services.
void add_base_services(ServiceTable& services);

} // namespace busbar::server::detail
