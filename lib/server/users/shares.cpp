#include "shares.hpp"

#include <busbar/core/text.hpp>

#include "login_guard.hpp"

namespace busbar::server::detail {

/// Returns the same key for the same user only (see is_same_user).
std::string share_key(const UserIdentity& user, std::string_view address)
{
    std::string key = std::to_string(static_cast<int>(user.token_type)) + ' ';
    if (user.token_type == UserTokenType::Anonymous) {
        return key + network_of(address);
    }
    return key + std::to_string(user.issuer.size()) + ' ' + user.issuer + user.name;
}

std::string describe(const UserIdentity& user)
{
    switch (user.token_type) {
    case UserTokenType::UserName:
        return "user \"" + printable(user.name) + "\"";
    case UserTokenType::Certificate:
        return "the user of certificate \"" + printable(user.name) + "\"";
    case UserTokenType::IssuedToken:
        return "user \"" + printable(user.name) + "\" of \"" + printable(user.issuer) + "\"";
    case UserTokenType::Anonymous:
        break;
    }
    return "an anonymous user";
}

Share& Shares::enter(const UserIdentity& user, std::string_view address, std::size_t items)
{
    std::string key = share_key(user, address);
    auto found = shares_.find(key);
    if (found == shares_.end()) {
        Entry made;
        made.key = key;
        made.text = describe(user);
        if (user.token_type == UserTokenType::Anonymous) {
            made.text += " from " + printable(network_of(address));
        }
        found = shares_.emplace(std::move(key), std::move(made)).first;
    }
    Entry& share = found->second;
    ++share.places;
    share.items += items;
    return share;
}

void Shares::leave(Share& share, std::size_t items)
{
    share.items -= items;
    if (--share.places == 0) {
        shares_.erase(shares_.find(static_cast<Entry&>(share).key));
    }
}

const Share* Shares::find(const UserIdentity& user, std::string_view address) const
{
    const auto found = shares_.find(share_key(user, address));
    return found == shares_.end() ? nullptr : &found->second;
}

} // namespace busbar::server::detail
