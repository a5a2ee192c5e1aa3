#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <busbar/core/clock.hpp>

namespace busbar::server::detail {

struct Core;
class PeerLink;

/// Processes one request of `link`: finds its service, checks the request header and the session,
/// and answers or leaves an Operation waiting (Part 4, 7.32 and 7.33).
void dispatch(Core& core, PeerLink& link, std::vector<std::byte> message, std::uint32_t request_id,
              TimePoint now);

} // namespace busbar::server::detail
