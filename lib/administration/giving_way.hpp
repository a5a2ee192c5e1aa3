#pragma once

#include <cstddef>
#include <iterator>
#include <map>
#include <string_view>

#include "permissions.hpp"

namespace busbar::administration::detail {

template <typename T>
[[nodiscard]] const Holder& holder_in(const T& held)
{
    if constexpr (requires { held.holder; }) {
        return held.holder;
    } else {
        return held->holder;
    }
}

/// What has to go, so that `taker` can have `wanted` more of what all users together have too much
/// of: of the user who has most of it, and more than `taker` would have, the first one of the
/// smallest `order`. The end of `held` if nobody has more. `weight` is how much each one takes;
/// those of 0 stay.
template <typename Range, typename Weight, typename Order>
[[nodiscard]] auto find_giving_way(Range& held, const Holder& taker, std::size_t wanted,
                                   Weight weight, Order order)
{
    std::map<std::string_view, std::size_t> shares;
    for (const auto& each : held) {
        shares[holder_in(each).share] += weight(each);
    }
    const std::size_t will_have = shares[taker.share] + wanted;
    auto loser = std::end(held);
    for (auto each = std::begin(held); each != std::end(held); ++each) {
        const std::size_t has = shares[holder_in(*each).share];
        if (weight(*each) == 0 || has <= will_have) {
            continue;
        }
        const std::size_t most = loser == std::end(held) ? 0 : shares[holder_in(*loser).share];
        if (has > most || (has == most && order(*each) < order(*loser))) {
            loser = each;
        }
    }
    return loser;
}

/// Of places, of which each counts for one.
template <typename Range, typename Order>
[[nodiscard]] auto find_giving_way(Range& held, const Holder& taker, Order order)
{
    return find_giving_way(
        held, taker, 1, [](const auto&) { return std::size_t{1}; }, order);
}

} // namespace busbar::administration::detail
