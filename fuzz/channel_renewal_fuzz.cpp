#include "channel_fuzz.hpp"

using namespace busbar;

/// A channel with its handshake, whose client renews its SecurityTokens: as many inputs a second as
/// RSA lets through.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    test::ChannelPair pair{fuzz::secured(script)};
    pair.run();
    fuzz::play(pair, script);
    return 0;
}
