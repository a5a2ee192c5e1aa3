#pragma once

#include "fuzz_script.hpp"
#include "support/channel_pair.hpp"

namespace busbar::fuzz {

/// Lets `script` play both a well-behaved and a hostile client on an open channel: messages are
/// sent as they are, with bytes changed, cut, repeated or replaced by raw input; time passes.
void play(test::ChannelPair& pair, Script& script);

} // namespace busbar::fuzz
