#include "channel_fuzz.hpp"
#include "prepared_channel.hpp"

namespace channel_policy_fuzz {

using namespace busbar;

/// A channel that is secured but costs no RSA: fuzz_channel_renewal has that. The first byte
/// chooses between Sign and SignAndEncrypt.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    fuzz::PreparedPair pair{fuzz::secured(script)};
    fuzz::play(pair, script);
    return 0;
}

} // namespace channel_policy_fuzz
