#pragma once

#include <cstdint>

#include <busbar/channel/channel_types.hpp>

namespace busbar::bench {

/// A self-signed certificate of the moment, for peers that ask for one.
[[nodiscard]] Result<channel::ApplicationIdentity> make_identity(DateTime now,
                                                                 std::uint32_t key_bits = 2048);

} // namespace busbar::bench
