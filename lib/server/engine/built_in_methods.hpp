#pragma once

#include "server/method/method_needs.hpp"

namespace busbar::server::detail {

class SubscriptionTable;

/// GetMonitoredItems and ResendData (Part 5, 9.1 and 9.2).
class SubscriptionMethods final : public BuiltInMethods {
public:
    explicit SubscriptionMethods(SubscriptionTable& all) : all_{all} {}

    [[nodiscard]] CallResult call(const NodeId& method, const ServiceContext& context,
                                  std::span<const Variant> inputs,
                                  std::size_t& item_count) override;

private:
    SubscriptionTable& all_;
};

} // namespace busbar::server::detail
