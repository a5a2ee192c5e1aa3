#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::crypto {
struct JwtClaims;
struct JwtRules;
} // namespace busbar::crypto

namespace busbar::server {

class Worker;

/// The user of a session.
struct UserIdentity {
    UserTokenType token_type{UserTokenType::Anonymous};
    /// The user's name, the subject of a user certificate or the `sub` of an issued token (Part 5,
    /// 6.4.3, ClientUserId); empty for an anonymous user. It comes from the peer: pass it through
    /// `printable` before it is shown.
    std::string name;
    /// Upper limit of the AccessLevelType bits that the user has at any node. Without CurrentWrite
    /// the user may call no Methods either, except those of the server itself.
    std::uint8_t access_level_mask{0xFF};
    /// Names of the roles that the store gave the user, followed by those of rules.
    std::vector<std::string> roles{};
    /// The token's issuer, `iss`; empty for other kinds of user.
    std::string issuer{};
    /// The thumbprint of a user certificate, in upper-case hexadecimal.
    std::string thumbprint{};
    /// The password must be changed first (Part 18, 5.2.8): until then the session has only the
    /// role Anonymous, and may call the Method ChangePassword and no other.
    bool must_change_password{false};
    /// The time when the certificate or token expires; null for never. The session is anonymous
    /// from then on, or closed if that is not allowed (Part 4, 7.40.5).
    DateTime valid_until{};
    /// Names of roles that an issued token claims. They grant nothing by themselves: rules of a
    /// RoleMapper with the criteria Role use them (Part 18, 4.4.4).
    std::vector<std::string> claimed_roles{};
    /// The user may administer and nothing else: values, history and Methods of nodes are
    /// accessible in namespace 0 and in that of the server's application, which is 1, and in no
    /// other, whatever mask and roles allow.
    bool administers_only{false};

    friend bool operator==(const UserIdentity&, const UserIdentity&) = default;
};

/// True if both are the same user, whatever rights and expiry they have (Part 5, 6.4.3).
[[nodiscard]] inline bool is_same_user(const UserIdentity& a, const UserIdentity& b)
{
    return a.token_type == b.token_type && a.name == b.name && a.issuer == b.issuer;
}

/// True if the user has the well-known role ConfigureAdmin (Part 3, 4.9.2).
[[nodiscard]] BUSBAR_API bool is_configure_admin(const UserIdentity& user);

/// Returns the anonymous user of a server without a store: CurrentRead and HistoryRead.
[[nodiscard]] inline UserIdentity anonymous_reader()
{
    return {UserTokenType::Anonymous, {}, 5};
}

/// The rights of a user.
struct UserRights {
    std::uint8_t access_level_mask{0xFF};
    std::vector<std::string> roles{};
    // See UserIdentity.
    bool must_change_password{false};
    bool administers_only{false};
};

/// Knows the users. The server checks what clients send; the store decides which users are trusted
/// and what they may do. Called on the server's thread, except for log_in (see worker()). Must not
/// keep a password or a token. An exception ends the login with Bad_InternalError, and does not
/// count as a wrong password.
class BUSBAR_API UserStore {
public:
    UserStore() = default;
    UserStore(const UserStore&) = delete;
    UserStore& operator=(const UserStore&) = delete;
    virtual ~UserStore() = default;

    /// Returns the user with this name and password. Any failure is Bad_UserAccessDenied, and takes
    /// as long for an unknown user as for a wrong password. For a token that cannot be decrypted it
    /// is called with a stand-in and the result ignored, so that it takes as long, too.
    [[nodiscard]] virtual Result<UserIdentity> log_in(std::string_view name,
                                                      std::string_view password) = 0;
    /// The worker that log_in runs on, which must then be thread-safe, also for several logins at
    /// once. Null, or a server without a Waker: the server's thread, which waits meanwhile. The
    /// worker must have finished before the store is destroyed.
    [[nodiscard]] virtual Worker* worker() { return nullptr; }
    /// True for a random code: failures with it lock out the certificate they came with, and no
    /// other.
    [[nodiscard]] virtual bool has_code(std::string_view /*name*/) const { return false; }
    /// The rights of an anonymous user, where the endpoint allows one at all: to read, unless the
    /// store decides otherwise.
    [[nodiscard]] virtual UserIdentity anonymous() const { return anonymous_reader(); }

    /// Decides which user certificates are trusted, by a separate trust list. If null, none is, and
    /// no endpoint offers them.
    [[nodiscard]] virtual crypto::CertificateValidator* certificate_validator() { return nullptr; }
    /// Returns the rights of a certificate's user. The validator has accepted it and its key has
    /// signed. Bad_IdentityTokenRejected for a user who is refused nevertheless.
    [[nodiscard]] virtual Result<UserRights> certificate_user(const crypto::Certificate&)
    {
        return fail(status::Bad_IdentityTokenRejected);
    }

    /// The issued tokens that are accepted. If null, none, and no endpoint offers them.
    [[nodiscard]] virtual const crypto::JwtRules* token_rules() const { return nullptr; }
    /// Returns the rights of a verified token's user. Bad_IdentityTokenRejected for a user who is
    /// refused nevertheless.
    [[nodiscard]] virtual Result<UserRights> token_user(const crypto::JwtClaims&)
    {
        return fail(status::Bad_IdentityTokenRejected);
    }
};

/// The facts that decide about roles (Part 18, 4.4.1), in addition to those that the UserStore
/// gives.
struct RoleQuestion {
    const UserIdentity& user;
    /// The client's ApplicationUri; that of its certificate if the channel has security, in which
    /// case `is_trusted` is true too.
    std::string_view application_uri{};
    bool is_trusted{false};
    /// The endpoint that the session uses.
    std::string_view endpoint_url{};
    MessageSecurityMode security_mode{MessageSecurityMode::None};
    std::string_view security_policy_uri{};
    /// The listener that the peer has connected to, see Connection::came_by: a fact, while the
    /// client chooses `endpoint_url`.
    std::uint32_t listener{0};
};

/// Gives roles to sessions by rules. Called on the server's thread, when a session is activated and
/// after RunningServer::roles_changed. An exception gives no roles, and a login then fails.
class BUSBAR_API RoleMapper {
public:
    RoleMapper() = default;
    RoleMapper(const RoleMapper&) = delete;
    RoleMapper& operator=(const RoleMapper&) = delete;
    virtual ~RoleMapper() = default;

    /// Returns names of roles, as in UserIdentity::roles, and bits that the user gets in addition
    /// to his own.
    [[nodiscard]] virtual UserRights roles_of(const RoleQuestion& question) const = 0;
    /// Returns the rights that remain of all that the UserStore and roles_of() gave: for listeners
    /// that restrict access.
    [[nodiscard]] virtual UserRights limited(const RoleQuestion&, UserRights rights) const
    {
        return rights;
    }
};

/// Decides for each node; without one, AccessLevel and the user's mask decide. Called on the
/// server's thread, for every node of a request. An exception counts as a refusal, and the request
/// answers Bad_InternalError.
///
/// The node's own attributes are enforced as well: its AccessRestrictions against the channel
/// (Bad_SecurityModeInsufficient; those of its namespace if it has none), and its RolePermissions,
/// or those of its namespace if it has none, against the user's roles. These are Anonymous, after a
/// login AuthenticatedUser, and UserIdentity::roles by the names of the well-known roles or of the
/// roles' nodes.
class BUSBAR_API AccessControl {
public:
    AccessControl() = default;
    AccessControl(const AccessControl&) = delete;
    AccessControl& operator=(const AccessControl&) = delete;
    virtual ~AccessControl() = default;

    /// A node that may not be browsed is left out of results and answers Bad_NodeIdUnknown.
    [[nodiscard]] virtual bool may_browse(const UserIdentity& user, const NodeId& node) const = 0;
    /// Returns the bits of `access_level` that the user has at this node.
    [[nodiscard]] virtual std::uint8_t user_access_level(const UserIdentity& user,
                                                         const NodeId& node,
                                                         std::uint8_t access_level) const = 0;
    /// Returns whether the user may call the Method, on any Object: its UserExecutable attribute.
    /// Called only for a Method that is Executable and that the user's mask allows.
    [[nodiscard]] virtual bool may_call(const UserIdentity& /*user*/,
                                        const NodeId& /*method*/) const
    {
        return true;
    }
    /// Returns the bits of `write_mask`, an AttributeWriteMask (Part 3, 8.60), whose attributes the
    /// user may write: the node's UserWriteMask. Called only with bits that the node and its
    /// RolePermissions allow. By default it allows all of them.
    [[nodiscard]] virtual std::uint32_t user_write_mask(const UserIdentity& /*user*/,
                                                        const NodeId& /*node*/,
                                                        std::uint32_t write_mask) const
    {
        return write_mask;
    }
    // The NodeManagement services, as the bits of PermissionType (Part 3, 8.55). By default, as
    // without an AccessControl, only ConfigureAdmin may use them. Called only for nodes that the
    // user may browse.

    /// Returns whether the user may add a node below `parent`.
    [[nodiscard]] virtual bool may_add_node(const UserIdentity& user,
                                            const NodeId& /*parent*/) const
    {
        return is_configure_admin(user);
    }
    /// Called for each of the nodes that would be deleted.
    [[nodiscard]] virtual bool may_delete_node(const UserIdentity& user,
                                               const NodeId& /*node*/) const
    {
        return is_configure_admin(user);
    }
    /// Called for both ends of the reference.
    [[nodiscard]] virtual bool may_add_reference(const UserIdentity& user,
                                                 const NodeId& /*node*/) const
    {
        return is_configure_admin(user);
    }
    /// Called for both ends of the reference.
    [[nodiscard]] virtual bool may_remove_reference(const UserIdentity& user,
                                                    const NodeId& /*node*/) const
    {
        return is_configure_admin(user);
    }
};

} // namespace busbar::server
