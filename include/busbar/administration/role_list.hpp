#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::administration {

class ConfiguredUsers;

/// A role and the rules by which sessions get it (Part 18, 4.4.1): a session must fulfil one of the
/// identities, and its application and endpoint must not be excluded.
struct RoleRules {
    /// The name of a well-known role, or the argument of AddRole.
    std::string name;
    /// The namespace of the name: that of OPC UA for a well-known role.
    std::string namespace_uri;
    std::vector<IdentityMappingRuleType> identities;
    /// If true, the applications of the list do not get the role; if false, only they do.
    bool applications_exclude{true};
    std::vector<std::string> applications; // ApplicationUris
    bool endpoints_exclude{true};
    /// Empty and zero fields match every endpoint.
    std::vector<EndpointType> endpoints;
};

/// Limits the size of rules.
struct RoleLimits {
    std::size_t max_roles{64};
    /// Entries of each list of a role.
    std::size_t max_rules{256};
    std::size_t max_text{1'024};
};

/// The roles of a server, well-known and additional ones, kept in a file of a Storage. A change is
/// completely in the file, or not made at all.
///
/// Rules match by: the name of a user with a password (UserName); the thumbprint of a user
/// certificate (Thumbprint); a role that an issued token names (Role); Anonymous;
/// AuthenticatedUser; an ApplicationUri of a channel with security (Application); name and value
/// pairs of a user certificate's subject, "CN=Pat/O=Works", all of which the subject has
/// (X509Subject); any application with a certificate (TrustedApplication). GroupId is refused,
/// since tokens have no groups.
///
/// The roles Anonymous, AuthenticatedUser and TrustedApplication have the rule of their name and no
/// other. One thread, that of the server.
class BUSBAR_API RoleList final : public server::RoleMapper {
public:
    /// `configured` has users with further roles; may be null. Both must outlive this object.
    RoleList(Storage& storage, std::string file, const RoleLimits& limits = {},
             const ConfiguredUsers* configured = nullptr);

    /// Reads the file; without a file there are the well-known roles without rules. The problem
    /// names the file and the error in it, and nothing changes then.
    [[nodiscard]] Configured<void> load();

    /// The well-known ones first, in the order of Part 3, 4.9.2.
    [[nodiscard]] const std::vector<RoleRules>& roles() const { return roles_; }
    /// Returns null if there is none with this name.
    [[nodiscard]] const RoleRules* find(std::string_view name) const;
    /// True for the roles of Part 3, 4.9.2.
    [[nodiscard]] static bool is_well_known(std::string_view name);
    /// Returns a document in which every role but SecurityAdmin is closed: no session has it,
    /// whichever way it was granted, until an administrator opens it again (EndpointsExclude). It
    /// replaces a list whose restrictions are lost. `others` are roles that are not well-known, as
    /// many as the limit allows.
    [[nodiscard]] static std::string closed_document(std::span<const std::string> others);
    /// Returns the identities that get the role: by the configuration, and by the role's own rules.
    /// Empty for an unknown role.
    [[nodiscard]] std::vector<IdentityMappingRuleType> identities_of(std::string_view role) const;

    // Refusals have the status of the Methods of Part 18, 4.2 and 4.4; Bad_ResourceUnavailable at a
    // limit and if the Storage fails.

    /// Adds a role. Bad_AlreadyExists, also for the name of a well-known role in another namespace,
    /// since permissions name roles by it. Bad_InvalidArgument for an empty or overlong name.
    [[nodiscard]] Checked<void> add(std::string name, std::string namespace_uri);
    /// Removes a role. Bad_NodeIdUnknown; Bad_RequestNotAllowed for a well-known role.
    [[nodiscard]] Checked<void> remove(std::string_view name);
    /// Adds a rule. Bad_InvalidArgument, Bad_NotSupported, Bad_AlreadyExists; Bad_RequestNotAllowed
    /// for a role whose name is its rule.
    [[nodiscard]] Checked<void> add_identity(std::string_view role,
                                             const IdentityMappingRuleType& rule);
    /// Removes a rule. Bad_NotFound; Bad_RequestNotAllowed as above, for rules of the
    /// configuration, and for the last rule that makes a user SecurityAdmin, if the configuration
    /// has no administrator.
    [[nodiscard]] Checked<void> remove_identity(std::string_view role,
                                                const IdentityMappingRuleType& rule);
    [[nodiscard]] Checked<void> add_application(std::string_view role, std::string_view uri);
    [[nodiscard]] Checked<void> remove_application(std::string_view role, std::string_view uri);
    [[nodiscard]] Checked<void> add_endpoint(std::string_view role, const EndpointType& endpoint);
    [[nodiscard]] Checked<void> remove_endpoint(std::string_view role,
                                                const EndpointType& endpoint);
    /// Changes whether the list excludes. Bad_RequestNotAllowed if no user could have the role
    /// SecurityAdmin afterwards; the same applies to the removals above.
    [[nodiscard]] Checked<void> set_applications_exclude(std::string_view role, bool excludes);
    [[nodiscard]] Checked<void> set_endpoints_exclude(std::string_view role, bool excludes);

    /// Returns whether rules alone make the user with this name and password an administrator.
    /// Called from any thread.
    [[nodiscard]] bool is_administrator(std::string_view user) const;

    [[nodiscard]] server::UserRights roles_of(const server::RoleQuestion& question) const override;
    /// Returns the rights without the roles whose lists of applications and endpoints do not allow
    /// them, wherever they come from.
    [[nodiscard]] server::UserRights limited(const server::RoleQuestion& question,
                                             server::UserRights rights) const override;

private:
    [[nodiscard]] bool is_configured(std::string_view role,
                                     const IdentityMappingRuleType& rule) const;
    /// Changes a copy of the role by `change`, which may refuse, and keeps it once it is in the
    /// file.
    template <typename Change>
    [[nodiscard]] Checked<void> change(std::string_view role, Change change);
    [[nodiscard]] Checked<void> replace(std::vector<RoleRules> roles);

    Storage* storage_;
    std::string file_;
    RoleLimits limits_;
    /// Protects changes of roles_, and reads of it by other threads.
    mutable std::mutex mutex_;
    std::vector<RoleRules> roles_;
    const ConfiguredUsers* configured_;
};

} // namespace busbar::administration
