#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "load.hpp"
#include "tally.hpp"

namespace busbar::bench {

/// One way to take what others need: what each of so many attackers does until the tally says that
/// it is over.
struct Attack {
    std::string name;
    std::size_t attackers{0};
    std::function<void(Tally&, std::size_t)> what;
};

/// What strangers can take of what is shared: sessions, Subscriptions that nobody reads, memory of
/// unfinished messages, sockets that say nothing, and the time of password hashes. `strangers` has
/// no user, `guessers` one that the server does not know; both must outlive the attacks.
[[nodiscard]] std::vector<Attack> quota_attacks(Load& strangers, Load& guessers,
                                                const std::vector<std::size_t>& attackers);

} // namespace busbar::bench
