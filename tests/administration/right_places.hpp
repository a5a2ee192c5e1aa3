#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "administration/rights.hpp"

/// Which row of the table of rights each node of the administration belongs to.
namespace right_matrix {

using namespace busbar::administration::detail;

/// Where what lies, by the names on the way; the longest that fits counts.
struct Place {
    std::string_view path;
    Thing thing;
};
inline constexpr std::array places{
    Place{"RequestServerStateChange", Thing::StateChange},
    Place{"ServerDiagnosticsSummary", Thing::ServerStatus},
    Place{"RoleSet", Thing::RoleRules},
    Place{"ServerConfiguration", Thing::ServerFacts},
    Place{"ServerConfiguration/UpdateCertificate", Thing::OwnCertificate},
    Place{"ServerConfiguration/CreateSigningRequest", Thing::OwnCertificate},
    Place{"ServerConfiguration/GetCertificates", Thing::OwnCertificate},
    Place{"ServerConfiguration/CreateSelfSignedCertificate", Thing::OwnCertificate},
    Place{"ServerConfiguration/DeleteCertificate", Thing::OwnCertificate},
    Place{"ServerConfiguration/ApplyChanges", Thing::TransactionEnds},
    Place{"ServerConfiguration/CancelChanges", Thing::TransactionEnds},
    Place{"ServerConfiguration/ResetToServerDefaults", Thing::Reset},
    Place{"ServerConfiguration/GetRejectedList", Thing::TrustLists},
    Place{"ServerConfiguration/RemoveRejectedCertificate", Thing::TrustListChanges},
    Place{"ServerConfiguration/TransactionDiagnostics", Thing::TrustLists},
    Place{"ServerConfiguration/CertificateGroups/", Thing::TrustLists},
    Place{"ServerConfiguration/CertificateGroups/*/TrustList/Write", Thing::TrustListChanges},
    Place{"ServerConfiguration/CertificateGroups/*/TrustList/CloseAndUpdate",
          Thing::TrustListChanges},
    Place{"ServerConfiguration/CertificateGroups/*/TrustList/AddCertificate",
          Thing::TrustListChanges},
    Place{"ServerConfiguration/CertificateGroups/*/TrustList/RemoveCertificate",
          Thing::TrustListChanges},
    Place{"ServerConfiguration/UserManagement", Thing::UserManagement},
    Place{"ServerConfiguration/UserManagement/Users", Thing::Users},
    Place{"ServerConfiguration/UserManagement/AddUser", Thing::Users},
    Place{"ServerConfiguration/UserManagement/ModifyUser", Thing::Users},
    Place{"ServerConfiguration/UserManagement/RemoveUser", Thing::Users},
    Place{"ServerConfiguration/UserManagement/ChangePassword", Thing::OwnPassword},
    Place{"Settings", Thing::Settings},
    Place{"Settings/users/anonymous", Thing::SecuritySettings},
    Place{"Status", Thing::ServiceStatus},
    Place{"recipes", Thing::Files},
    Place{"recipes/CreateDirectory", Thing::FileChanges},
    Place{"recipes/CreateFile", Thing::FileChanges},
    Place{"recipes/Delete", Thing::FileChanges},
    Place{"recipes/MoveOrCopy", Thing::FileChanges},
    Place{"recipes/a/Write", Thing::FileChanges},
    Place{"backup", Thing::Files},
    Place{"backup/GenerateFileForWrite", Thing::FileChanges},
    Place{"backup/CloseAndCommit", Thing::FileChanges},
};

/// "*" in the pattern is one name.
inline bool fits(std::string_view path, std::string_view pattern)
{
    while (!pattern.empty() && !path.empty()) {
        if (pattern.front() == '*') {
            pattern.remove_prefix(1);
            path.remove_prefix(std::min(path.find('/'), path.size()));
        } else if (pattern.front() == path.front()) {
            pattern.remove_prefix(1);
            path.remove_prefix(1);
        } else {
            return false;
        }
    }
    return pattern.empty();
}

} // namespace right_matrix
