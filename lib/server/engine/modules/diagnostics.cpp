#include <busbar/server/modules.hpp>
#include <busbar/types/ids.hpp>

#include "server/diagnostics/diagnostic_values.hpp"
#include "server/diagnostics/part_nodes.hpp"
#include "server/diagnostics/session_nodes.hpp"
#include "server/diagnostics/subscription_nodes.hpp"
#include "server/engine/core.hpp"

namespace busbar::server {

namespace detail {

namespace {

class Diagnostics final : public DiagnosticsPart, private LateNodes {
public:
    explicit Diagnostics(Core& core)
        : nodes_{core.diagnostics_needs},
          subscriptions_{core.diagnostics_needs, nodes_}, values_{core.diagnostics_needs, nodes_}
    {
        core.subscription_needs.observer = &subscriptions_;
        core.late_nodes = this;
    }

    [[nodiscard]] const LiveValues& values() const { return values_; }

    void add(const Session& session) override { nodes_.add(session); }
    void remove(const Session& session) override { nodes_.remove(session); }
    void take_flag() override
    {
        nodes_.take_flag();
        subscriptions_.take_flag();
    }

private:
    std::size_t add_below(model::NodeIndex variable, std::uint64_t handle) override
    {
        return section_of(handle) == Section::Subscription
                   ? subscriptions_.add_fields(variable, handle)
                   : nodes_.add_fields(variable, handle);
    }

    SessionNodes nodes_;
    SubscriptionNodes subscriptions_;
    DiagnosticValues values_;
};

/// They are on until a client switches them off, if the address space has them.
void switch_on(Core& core)
{
    const model::NodeIndex flag = core.address_space.find(id::Server_ServerDiagnostics_EnabledFlag);
    if (flag != model::no_node) {
        static_cast<void>(core.address_space.set_value(flag, true));
    }
    core.counters.take_flag(core.address_space, {core.sessions.size(), core.subscriptions.size()});
}

void add_diagnostics(Core& core)
{
    switch_on(core);
    auto diagnostics = std::make_unique<Diagnostics>(core);
    core.server_object.add(diagnostics->values());
    core.diagnostics = std::move(diagnostics);
}

} // namespace

} // namespace detail

constinit const Module modules::diagnostics{"diagnostics", detail::add_diagnostics};

} // namespace busbar::server
