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

/// Finds an element to remove so that `taker` can have `wanted` more of a resource that all users
/// share. Takes it from the user with the largest share, if that is larger than the taker's would
/// be: the first of the elements with the smallest `order`. Gives the end of `held` if there is
/// none. `weight` is the share of an element; those with 0 stay.
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

/// The same if each element counts as one.
template <typename Range, typename Order>
[[nodiscard]] auto find_giving_way(Range& held, const Holder& taker, Order order)
{
    return find_giving_way(
        held, taker, 1, [](const auto&) { return std::size_t{1}; }, order);
}

} // namespace busbar::administration::detail
