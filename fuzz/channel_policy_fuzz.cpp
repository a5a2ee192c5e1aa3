#include "channel_fuzz.hpp"
#include "prepared_channel.hpp"

using namespace busbar;

/// A channel that is secured but costs no RSA: fuzz_channel_renewal has that. The first byte
/// chooses between Sign and SignAndEncrypt.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    fuzz::PreparedPair pair{fuzz::secured(script)};
    fuzz::play(pair, script);
    return 0;
}
