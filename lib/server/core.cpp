#include "core.hpp"

#include <array>
#include <cstring>

#include <busbar/core/text.hpp>
#include <busbar/types/registry.hpp>

#include "link.hpp"

namespace busbar::server::detail {

namespace {

std::uint32_t random_channel_id(crypto::Random& random)
{
    std::array<std::byte, 4> bytes{};
    std::uint32_t id = 0;
    if (random.fill(bytes)) {
        std::memcpy(&id, bytes.data(), sizeof(id));
    }
    return id == 0 ? 1 : id;
}

} // namespace

Core::Core(ServerConfig c, const ServerEnvironment& e, model::AddressSpace space)
    : config{std::move(c)}, environment{e}, address_space{std::move(space)},
      types{binary::namespace0_types()}, sources{e.waker},
      assembly{config.limits.max_assembly}, logins{config.limits},
      next_channel_id{random_channel_id(*e.random)}, start_time{e.wall_clock->now()}
{
}

void Core::sweep()
{
    if (std::exchange(needs_sweep, false)) {
        for (Link* link : links) {
            link->sweep();
        }
    }
}

void Core::close_session(Session& session, StatusCode status)
{
    for (Link* link : links) {
        link->end_operations(&session, status);
    }
    log(LogLevel::Info, "session",
        "\"" + printable(session.name) + "\" ended: " + std::string{name(status)});
    sessions.remove(session);
}

} // namespace busbar::server::detail
