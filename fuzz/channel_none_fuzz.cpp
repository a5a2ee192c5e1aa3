#include "channel_fuzz.hpp"

namespace channel_none_fuzz {

using namespace busbar;

int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    test::ChannelPair pair;
    pair.run();
    fuzz::play(pair, script);
    return 0;
}

} // namespace channel_none_fuzz
