#include "server_control.hpp"

#include <chrono>
#include <memory>
#include <utility>

#include <busbar/administration/reset_to_defaults_nodes/nodes.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/ids.hpp>

#include "method_record.hpp"

namespace busbar::administration::detail {

namespace {

/// Time for the answer to arrive.
constexpr std::chrono::seconds till_end{2};

} // namespace

Configured<void> ServerReset::attach()
{
    model::AddressSpace& space = needs_.server.address_space();
    if (const auto added = space.add(reset_to_defaults_nodes::nodes()); !added) {
        return misconfigured("reset", "ResetToServerDefaults cannot be added", added.error());
    }
    needs_.table.bind_method(
        space, space.find(id::ServerConfiguration_ResetToServerDefaults),
        [this](server::MethodCall call) {
            needs_.table.post(std::move(call), [this](server::MethodCall& each) { reset(each); });
        });
    return {};
}

void ServerReset::reset(server::MethodCall& call)
{
    auto end = std::make_unique<NodeTable::Task>();
    end->function = [needs = needs_] {
        const bool has_begun = server::RunningServer{needs.server}.begin_shutdown(
            "the server was reset: certificates and users may not be accepted any more", till_end,
            {});
        if (has_begun) {
            needs.end();
        }
    };
    if (const auto done = needs_.reset(); !done) {
        const Refusal refusal{done.error().status, "reset", text(done.error()), {}, {}};
        tell_method(needs_.log, RecordKind::SettingsChanged, call, refusal.status, &refusal);
        return call.fail(status::Bad_ResourceUnavailable, reason_of(refusal));
    }
    tell_method(needs_.log, RecordKind::SettingsChanged, call, status::Good, nullptr);
    call.succeed();
    needs_.table.post(std::move(end)); // send the answer first
}

} // namespace busbar::administration::detail
