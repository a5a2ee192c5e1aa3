#include "channel_fuzz.hpp"

using namespace busbar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    test::ChannelPair pair;
    pair.run();
    fuzz::play(pair, script);
    return 0;
}
