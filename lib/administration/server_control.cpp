#include "server_control.hpp"

#include <chrono>
#include <string>
#include <utility>

#include <busbar/administration/state_change_nodes/nodes.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/enumerations.hpp>
#include <busbar/types/ids.hpp>

#include "method_record.hpp"

namespace busbar::administration::detail {

namespace {

using server::MethodCall;

/// A day: further ahead nobody plans by a running countdown.
constexpr std::uint32_t max_seconds = 86'400;
constexpr std::size_t max_reason = 256;

} // namespace

Configured<void> ServerControl::attach()
{
    model::AddressSpace& space = server_.address_space();
    if (const auto added = space.add(state_change_nodes::nodes()); !added) {
        return misconfigured("stop", "RequestServerStateChange cannot be added", added.error());
    }
    table_.bind_method(space, space.find(id::Server_RequestServerStateChange),
                       [this](MethodCall call) { request(std::move(call)); });
    return {};
}

void ServerControl::request(MethodCall call)
{
    const auto state = static_cast<ServerState>(call.input<std::int32_t>(0));
    const auto seconds = call.input<std::uint32_t>(2);
    const auto* const text = call.inputs()[3].get_if<LocalizedText>();
    const std::string reason = text != nullptr ? text->text.str() : std::string{};
    const bool restarts = call.input<bool>(4);
    if (state == ServerState::Running && !restarts) {
        return call.succeed(); // it is
    }
    if (state != ServerState::Shutdown || restarts) {
        return call.fail(status::Bad_NotSupported);
    }
    if (seconds > max_seconds || reason.size() > max_reason) {
        return call.fail(status::Bad_OutOfRange);
    }
    tell_method(log_, RecordKind::SettingsChanged, call, status::Good, nullptr);
    const auto return_time = call.input<DateTime>(1);
    call.succeed();
    table_.post([this, seconds, reason, return_time] {
        const bool has_begun = server::RunningServer{server_}.begin_shutdown(
            reason.empty() ? "an administrator stops the server" : std::string_view{reason},
            std::chrono::seconds{seconds}, return_time);
        if (has_begun) {
            stop_();
        }
    });
}

} // namespace busbar::administration::detail
