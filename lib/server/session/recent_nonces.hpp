#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

namespace busbar::server::detail {

/// The client nonces of the last sessions, as hashes: one must not be used again (Part 4,
/// 5.7.2.2).
class RecentNonces {
public:
    /// Returns false if the nonce is among them; otherwise adds it in place of the oldest.
    [[nodiscard]] bool take(std::span<const std::byte> nonce)
    {
        const std::size_t hash = std::hash<std::string_view>{}(
            {reinterpret_cast<const char*>(nonce.data()), nonce.size()});
        const auto end = hashes_.begin() + static_cast<std::ptrdiff_t>(count_);
        if (std::find(hashes_.begin(), end, hash) != end) {
            return false;
        }
        hashes_[next_] = hash;
        next_ = (next_ + 1) % hashes_.size();
        count_ = std::max(count_, next_ == 0 ? hashes_.size() : next_);
        return true;
    }

private:
    std::array<std::size_t, 128> hashes_{};
    std::size_t count_{0};
    std::size_t next_{0};
};

} // namespace busbar::server::detail
