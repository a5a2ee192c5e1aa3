#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/symmetric.hpp>

namespace busbar::channel::detail {

/// One SecurityToken with the keys of both directions (Part 6, 6.7.5).
struct Token {
    std::uint32_t id{0};
    std::optional<crypto::SymmetricCipher> send;    // none with mode None
    std::optional<crypto::SymmetricCipher> receive; // none with mode None
    TimePoint renew_at{no_deadline};                // 75 % of the lifetime (Part 4, 5.6.2.1)
    TimePoint ends_at{no_deadline};    // 100 %: not used for sending any more if there is another
    TimePoint expires_at{no_deadline}; // 125 %: no longer accepted
};

struct Nonces {
    std::span<const std::byte> own;
    std::span<const std::byte> peer;
};

/// Derives keys for `setting` from the two nonces.
[[nodiscard]] Result<Token> make_token(std::uint32_t id, const SecuritySetting& setting,
                                       const Nonces& nonces, std::chrono::milliseconds lifetime,
                                       TimePoint now);

/// The sequence numbers of one direction (Part 6, 6.7.2.4).
class SequenceNumbers {
public:
    /// Returns the number of the next chunk to send.
    [[nodiscard]] std::uint32_t next();
    /// True if `number` may follow the last accepted one; any number may be the first.
    [[nodiscard]] bool accept(std::uint32_t number);

    [[nodiscard]] std::uint32_t last() const { return last_; }
    /// Reuses numbers that were not sent after all.
    void reset_to(std::uint32_t last) { last_ = last; }

private:
    std::uint32_t last_{0};
    bool has_begun_{false};
};

} // namespace busbar::channel::detail
