#include "base_services.hpp"

#include <array>

#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "run_service.hpp"
#include "server/attribute/read.hpp"
#include "server/attribute/write.hpp"
#include "server/session/session_services.hpp"
#include "server/subscription/monitored_item_services.hpp"
#include "server/subscription/publish_queue.hpp"
#include "server/subscription/subscription_services.hpp"
#include "server/view/view_services.hpp"

namespace busbar::server::detail {

namespace {

const AttributeNeeds& attribute_needs(Core& core)
{
    return core.attribute_needs;
}

const SessionNeeds& session_needs(Core& core)
{
    return core.session_needs;
}

constexpr std::array base_session_rows{
    function<FindServersRequest, FindServersResponse, session_needs, find_servers>(
        Need::Nothing, Lasts::WhenFailed),
    function<FindServersOnNetworkRequest, FindServersOnNetworkResponse, session_needs,
             find_servers_on_network>(Need::Nothing, Lasts::WhenFailed),
    function<GetEndpointsRequest, GetEndpointsResponse, session_needs, get_endpoints>(
        Need::Nothing, Lasts::WhenFailed),
    function<CreateSessionRequest, CreateSessionResponse, session_needs, create_session>(
        Need::Nothing, Lasts::WhenFailed),
    operation<ActivateSessionRequest, make_activate_session, session_needs>(Need::Known,
                                                                            Lasts::WhenFailed),
    function<CloseSessionRequest, CloseSessionResponse, session_needs, close_session>(
        Need::Known, Lasts::ToTheEnd),
    function<CancelRequest, CancelResponse, session_needs, cancel>(Need::Activated),
};

constexpr std::array base_node_rows{
    operation<BrowseRequest, make_browse, &Core::view_needs>(Need::Activated),
    operation<BrowseNextRequest, make_browse_next, &Core::view_needs>(Need::Activated),
    operation<TranslateBrowsePathsToNodeIdsRequest, make_translate_browse_paths, &Core::view_needs>(
        Need::Activated),
    operation<RegisterNodesRequest, make_register_nodes, &Core::view_needs>(Need::Activated),
    operation<UnregisterNodesRequest, make_unregister_nodes, &Core::view_needs>(Need::Activated),
    operation<ReadRequest, make_operation<ReadOperation, const AttributeNeeds>, attribute_needs>(
        Need::Activated, Lasts::ToTheEnd),
    operation<WriteRequest, make_operation<WriteOperation, const AttributeNeeds>, attribute_needs>(
        Need::Activated),
};

constexpr std::array base_subscription_rows{
    operation<CreateMonitoredItemsRequest, make_create_monitored_items, &Core::subscriptions>(
        Need::Activated),
    operation<ModifyMonitoredItemsRequest, make_modify_monitored_items, &Core::subscriptions>(
        Need::Activated),
    operation<SetMonitoringModeRequest, make_set_monitoring_mode, &Core::subscriptions>(
        Need::Activated),
    operation<DeleteMonitoredItemsRequest, make_delete_monitored_items, &Core::subscriptions>(
        Need::Activated),
    function<CreateSubscriptionRequest, CreateSubscriptionResponse, &Core::subscriptions,
             create_subscription>(Need::Activated),
    function<ModifySubscriptionRequest, ModifySubscriptionResponse, &Core::subscriptions,
             modify_subscription>(Need::Activated),
    operation<SetPublishingModeRequest, make_set_publishing_mode, &Core::subscriptions>(
        Need::Activated),
    operation<PublishRequest, make_operation<PublishOperation, SubscriptionTable>,
              &Core::subscriptions>(Need::Activated, Lasts::ToTheEnd),
    operation<RepublishRequest, make_operation<RepublishOperation, SubscriptionTable>,
              &Core::subscriptions>(Need::Activated),
    operation<DeleteSubscriptionsRequest, make_delete_subscriptions, &Core::subscriptions>(
        Need::Activated),
};

} // namespace

void add_base_services(ServiceTable& services)
{
    services.add(base_session_rows);
    services.add(base_node_rows);
    services.add(base_subscription_rows);
}

} // namespace busbar::server::detail
