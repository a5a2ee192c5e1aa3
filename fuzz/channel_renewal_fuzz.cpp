#include "channel_fuzz.hpp"

namespace channel_renewal_fuzz {

using namespace busbar;

/// A channel with its handshake, whose client renews its SecurityTokens: as many inputs a second as
/// RSA lets through.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    test::ChannelPair pair{fuzz::secured(script)};
    pair.run();
    fuzz::play(pair, script);
    return 0;
}

} // namespace channel_renewal_fuzz
