#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "load.hpp"
#include "tally.hpp"

namespace busbar::bench {

/// The first two messages of a client as somebody between it and the server gets to see them, who
/// can send them again but has not the keys.
struct Overheard {
    std::string host;
    std::string port;
    std::vector<std::byte> hello;
    std::vector<std::byte> open;
};

/// Those of a client of `load`, whose policy is not None. Bad_CommunicationError if the server is
/// not there, or does not answer.
[[nodiscard]] Result<Overheard> overhear(Load& load, const std::string& url);

/// Sends them over one connection after the other until the attack is over, and hangs up as soon as
/// there is an answer, or none for 100 ms. From `own_address` if that is not empty.
void replay(const Overheard& overheard, const std::string& own_address, Tally& tally);

} // namespace busbar::bench
