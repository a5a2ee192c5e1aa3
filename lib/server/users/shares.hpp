#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>

#include <busbar/server/access_control.hpp>

namespace busbar::server::detail {

/// What one user has of something that all have together.
struct Share {
    /// Who that is, to be shown.
    std::string text{};
    std::size_t places{0};
    /// Of Subscriptions their items; of sessions those that are activated.
    std::size_t items{0};
    /// It was logged that a place of this share went to somebody else.
    bool is_told{false};
};

/// The shares of all users. Anonymous users share one for each network that they come from (see
/// network_of). A Share stays where it is until nothing is left of it.
class Shares {
public:
    /// Takes one place more, with that many items.
    [[nodiscard]] Share& enter(const UserIdentity& user, std::string_view address,
                               std::size_t items = 0);
    /// Gives the same back.
    void leave(Share& share, std::size_t items = 0);
    /// Null if that user has nothing.
    [[nodiscard]] const Share* find(const UserIdentity& user, std::string_view address) const;
    [[nodiscard]] std::size_t size() const { return shares_.size(); }

private:
    struct Entry : Share {
        std::string key{};
    };
    std::unordered_map<std::string, Entry> shares_;
};

/// Equal for those who have one Share.
[[nodiscard]] std::string share_key(const UserIdentity& user, std::string_view address);

/// Who that is in a log line: nothing in it can be mistaken for the line's own text.
[[nodiscard]] std::string describe(const UserIdentity& user);

} // namespace busbar::server::detail
