#include "stand_in.hpp"

#include <array>
#include <string>

#include <busbar/crypto/digest.hpp>

namespace busbar::server::detail {

std::size_t stand_in_for(std::string_view name, std::span<const std::string_view> hashes)
{
    // Computed once, since strangers choose its length.
    const auto digest = crypto::sha256(std::as_bytes(std::span{name}));
    std::string text;
    std::array<std::byte, 32> highest{};
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < hashes.size(); ++i) {
        text.assign(hashes[i]);
        text.append(reinterpret_cast<const char*>(digest.data()), digest.size());
        const auto score = crypto::sha256(std::as_bytes(std::span{text}));
        if (score > highest) {
            highest = score;
            chosen = i;
        }
    }
    return chosen;
}

} // namespace busbar::server::detail
