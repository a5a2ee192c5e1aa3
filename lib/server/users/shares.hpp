#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>

#include <busbar/server/access_control.hpp>

namespace busbar::server::detail {

/// One user's part of a common resource.
struct Share {
    /// The user, for display.
    std::string text{};
    std::size_t places{0};
    /// For Subscriptions their items; for sessions the activated ones.
    std::size_t items{0};
    /// It was logged that a place of this share was given to another user.
    bool is_told{false};
};

/// The shares of all users. Anonymous users share one for each network that they come from (see
/// network_of). A Share keeps its address until it is empty.
class Shares {
public:
    /// Takes one more place, with this many items.
    [[nodiscard]] Share& enter(const UserIdentity& user, std::string_view address,
                               std::size_t items = 0);
    /// Returns one place with this many items.
    void leave(Share& share, std::size_t items = 0);
    /// Returns null if the user has nothing.
    [[nodiscard]] const Share* find(const UserIdentity& user, std::string_view address) const;
    [[nodiscard]] std::size_t size() const { return shares_.size(); }

private:
    struct Entry : Share {
        std::string key{};
    };
    std::unordered_map<std::string, Entry> shares_;
};

/// Returns a key that is equal for users with a common Share.
[[nodiscard]] std::string share_key(const UserIdentity& user, std::string_view address);

/// Describes the user for a log line: nothing in it can be mistaken for the line's own text.
[[nodiscard]] std::string describe(const UserIdentity& user);

} // namespace busbar::server::detail
