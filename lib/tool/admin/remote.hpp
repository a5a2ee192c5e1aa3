#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/variant.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/types/configuration.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "tool/connection/connection.hpp"

/// The requests of `busbar admin` to a server, for nodes of the standard by their well-known
/// NodeIds.
namespace busbar::tool::admin {

[[nodiscard]] inline NodeId standard(std::uint32_t id)
{
    return NodeId{0, id};
}

/// Calls a Method, waits that long for the answer, or as long as --timeout says, and returns its
/// outputs; throws a Failure that says that `what` failed.
std::vector<Variant> call(Connection& connection, const NodeId& object, const NodeId& method,
                          const std::vector<Variant>& inputs, const std::string& what,
                          Duration timeout = {});
/// Calls `function`. If it throws a Failure with this status, replaces the hint, even if there is a
/// reason.
template <typename Function>
auto with_hint(Function&& function, StatusCode status, const std::string& hint)
{
    try {
        return function();
    } catch (Failure& failure) {
        failure.hint = failure.status == status ? hint : failure.hint;
        throw;
    }
}
/// Reads a Variable; null if the server refuses it.
[[nodiscard]] Variant read(Connection& connection, const NodeId& variable);
/// Finds the child with this name; null if there is none, or if this user may not see it.
[[nodiscard]] NodeId find_child(Connection& connection, const NodeId& parent,
                                std::string_view name);
/// The same; throws Failure.
[[nodiscard]] NodeId child_of(Connection& connection, const NodeId& parent, std::string_view name);
/// Finds the Method with this name, which a child of another kind may have, too; null if there is
/// none.
[[nodiscard]] NodeId find_method(Connection& connection, const NodeId& parent,
                                 std::string_view name);
/// A child that is an Object, with its name.
struct NamedChild {
    std::string name;
    NodeId id;
};
[[nodiscard]] std::vector<NamedChild> objects_below(Connection& connection, const NodeId& parent);

/// Lists the server's users with passwords; nothing if it has no such list, or this user may not
/// see it.
[[nodiscard]] std::optional<std::vector<UserManagementDataType>> find_users(Connection& connection);
/// True if the configuration file of busbar-controller defines the user, which only that file can
/// change.
[[nodiscard]] bool is_of_file(const UserManagementDataType& user);

/// The trust list of one CertificateGroup.
struct TrustListNodes {
    NodeId object;
    NodeId open;
    NodeId close;
    NodeId read;
    NodeId write;
    NodeId close_and_update;
    NodeId add;
    NodeId remove;
};
/// Finds the trust list of applications or of users; throws Failure if the server has none.
[[nodiscard]] TrustListNodes trust_list(Connection& connection, bool of_users);
/// Reads the contents of the list.
[[nodiscard]] TrustListDataType read_trust_list(Connection& connection,
                                                const TrustListNodes& nodes);
/// Replaces the lists in the specifiedLists of `data`, together; throws Failure with nothing
/// changed.
void write_trust_list(Connection& connection, const TrustListNodes& nodes,
                      const TrustListDataType& data, const std::string& what);
/// Calls AddUser. If name or password are refused, the Failure has the server's rules.
void add_user(Connection& connection, const std::string& name, const crypto::Secret& password,
              std::uint32_t bits, const std::string& description);
/// Calls ModifyUser with the changes; `password` may be null.
void change_user(Connection& connection, const std::string& name, const crypto::Secret* password,
                 std::optional<std::uint32_t> bits);

/// The certificates that the server rejected.
[[nodiscard]] std::vector<crypto::Certificate> rejected(Connection& connection);
/// Decodes certificates; leaves out those that are damaged.
[[nodiscard]] std::vector<crypto::Certificate> certificates_of(const Array<ByteString>& ders);

} // namespace busbar::tool::admin
