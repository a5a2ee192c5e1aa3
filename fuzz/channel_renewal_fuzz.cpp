#include "channel_fuzz.hpp"

using namespace busbar;

/// A channel with its handshake, whose client renews its SecurityTokens: as many inputs a second as
/// RSA lets through. The first byte chooses between Sign and SignAndEncrypt.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    const auto mode =
        script.byte() % 2 == 0 ? MessageSecurityMode::Sign : MessageSecurityMode::SignAndEncrypt;
    test::ChannelPair pair{test::setting("Basic256Sha256", mode)};
    pair.run();
    fuzz::play(pair, script);
    return 0;
}
