#include <array>

#include <busbar/server/modules.hpp>
#include <busbar/types/method.hpp>

#include "server/engine/built_in_methods.hpp"
#include "server/engine/run_service.hpp"
#include "server/method/call.hpp"

namespace busbar::server {

namespace detail {

namespace {

struct MethodServices final : ModulePart {
    explicit MethodServices(Core& core)
        : built_in{core.subscriptions},
          needs{core.address_space,      core.sources,      core.types, core.config.limits,
                core.environment.access, core.rationed_log, built_in,   core.life.state}
    {
    }

    SubscriptionMethods built_in;
    const MethodNeeds needs;
};

const MethodNeeds& method_needs(Core& core)
{
    return static_cast<const MethodServices&>(*core.methods).needs;
}

constexpr std::array method_rows{
    operation<CallRequest, make_operation<CallOperation, const MethodNeeds>, method_needs>(
        Need::Activated, Lasts::InCountdown),
};

void add_methods(Core& core)
{
    core.methods = std::make_unique<MethodServices>(core);
    core.services.add(method_rows);
}

} // namespace

} // namespace detail

constinit const Module modules::methods{"methods", detail::add_methods};

} // namespace busbar::server
