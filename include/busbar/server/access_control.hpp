#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include <busbar/core/log.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::server {

/// Who a session belongs to.
struct UserIdentity {
    UserTokenType token_type{UserTokenType::Anonymous};
    /// Empty for an anonymous user. From the peer: goes through `printable` before it is shown.
    std::string name;
    /// Bits of AccessLevelType that the user has at most, at any node.
    std::uint8_t access_level_mask{0xFF};

    friend bool operator==(const UserIdentity&, const UserIdentity&) = default;
};

/// The anonymous user of a server without a store: CurrentRead and HistoryRead.
[[nodiscard]] inline UserIdentity anonymous_reader()
{
    return {UserTokenType::Anonymous, {}, 5};
}

/// Knows the users. Called on the server's thread; must not keep the password.
class UserStore {
public:
    UserStore() = default;
    UserStore(const UserStore&) = delete;
    UserStore& operator=(const UserStore&) = delete;
    virtual ~UserStore() = default;

    /// The user with that name and password. Any failure is Bad_UserAccessDenied and takes as long
    /// for a user that is not there as for a wrong password.
    [[nodiscard]] virtual Result<UserIdentity> log_in(std::string_view name,
                                                      std::string_view password) = 0;
    /// What an anonymous user may do, where the endpoint allows one at all: read, unless the store
    /// says otherwise.
    [[nodiscard]] virtual UserIdentity anonymous() const { return anonymous_reader(); }
};

/// Users in memory, with hashes of their passwords (crypto::hash_password).
class PasswordUsers final : public UserStore {
public:
    /// Adds or replaces a user. Bad_InvalidArgument for an empty name or what is no hash.
    [[nodiscard]] Result<void> set(std::string name, std::string password_hash,
                                   std::uint8_t access_level_mask = 0xFF);
    void set_anonymous_access(std::uint8_t access_level_mask) { anonymous_ = access_level_mask; }

    [[nodiscard]] Result<UserIdentity> log_in(std::string_view name,
                                              std::string_view password) override;
    [[nodiscard]] UserIdentity anonymous() const override;

private:
    struct User {
        std::string password_hash;
        std::uint8_t access_level_mask;
    };
    std::map<std::string, User, std::less<>> users_;
    std::uint8_t anonymous_{anonymous_reader().access_level_mask};
};

/// Decides for each node; without one, AccessLevel and the user's mask decide. Called on the
/// server's thread, for every node of a request.
class AccessControl {
public:
    AccessControl() = default;
    AccessControl(const AccessControl&) = delete;
    AccessControl& operator=(const AccessControl&) = delete;
    virtual ~AccessControl() = default;

    /// A node that may not be browsed is left out of results and answers Bad_NodeIdUnknown.
    [[nodiscard]] virtual bool may_browse(const UserIdentity& user, const NodeId& node) const = 0;
    /// The bits of `access_level` that the user has at this node.
    [[nodiscard]] virtual std::uint8_t user_access_level(const UserIdentity& user,
                                                         const NodeId& node,
                                                         std::uint8_t access_level) const = 0;
};

} // namespace busbar::server
