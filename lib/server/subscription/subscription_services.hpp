#pragma once

#include <busbar/types/subscription.hpp>

#include "server/session/service.hpp"
#include <busbar/server/limits.hpp>

/// The Subscription service set (Part 4, 5.14) except Publish. All need an activated session.
namespace busbar::server::detail {

class SubscriptionTable;

[[nodiscard]] StatusCode create_subscription(SubscriptionTable& all, ServiceContext& context,
                                             const CreateSubscriptionRequest& request,
                                             CreateSubscriptionResponse& response);
[[nodiscard]] StatusCode modify_subscription(SubscriptionTable& all, ServiceContext& context,
                                             const ModifySubscriptionRequest& request,
                                             ModifySubscriptionResponse& response);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_set_publishing_mode(SubscriptionTable& all);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_transfer_subscriptions(SubscriptionTable& all);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_delete_subscriptions(SubscriptionTable& all);

/// Republish (Part 4, 5.14.6): answers with the bytes that were sent.
class RepublishOperation final : public OperationOf<RepublishRequest> {
public:
    explicit RepublishOperation(SubscriptionTable& all) : all_{all} {}

    void start(ServiceContext& context) override;

private:
    SubscriptionTable& all_;
};

/// Returns Good, or why a request with this many operations is refused.
[[nodiscard]] StatusCode check_count(const ServerLimits& limits, std::size_t count);

// Methods of the Server object (Part 5, 9.1 and 9.2), as functions.

struct MonitoredItemHandles {
    Array<std::uint32_t> server_handles;
    Array<std::uint32_t> client_handles;
};
/// Returns Bad_SubscriptionIdInvalid, or Bad_UserAccessDenied for a Subscription of another
/// session.
[[nodiscard]] Result<MonitoredItemHandles> get_monitored_items(const SubscriptionTable& all,
                                                               const Session& session,
                                                               std::uint32_t subscription_id);
/// Errors as above.
[[nodiscard]] StatusCode resend_data(SubscriptionTable& all, const Session& session,
                                     std::uint32_t subscription_id, TimePoint now);

} // namespace busbar::server::detail
