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

/// What `busbar admin` asks a server for: the nodes of the standard, by their well-known NodeIds.
namespace busbar::tool::admin {

[[nodiscard]] inline NodeId standard(std::uint32_t id)
{
    return NodeId{0, id};
}

/// The outputs of a Method; throws Failure, which says that `what` failed.
std::vector<Variant> call(Connection& connection, const NodeId& object, const NodeId& method,
                          const std::vector<Variant>& inputs, const std::string& what);
/// What `function` returns. A Failure of it by `status` gets another hint, beside a reason too.
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
/// The value of a Variable; null if the server refuses it.
[[nodiscard]] Variant read(Connection& connection, const NodeId& variable);
/// The child with this name; null if there is none, or if this user may not see it.
[[nodiscard]] NodeId find_child(Connection& connection, const NodeId& parent,
                                std::string_view name);
/// The same; throws Failure.
[[nodiscard]] NodeId child_of(Connection& connection, const NodeId& parent, std::string_view name);
/// The Method with this name; null if there is none. A child of another kind may have it, too.
[[nodiscard]] NodeId find_method(Connection& connection, const NodeId& parent,
                                 std::string_view name);
/// All children that are Objects, and their names.
struct NamedChild {
    std::string name;
    NodeId id;
};
[[nodiscard]] std::vector<NamedChild> objects_below(Connection& connection, const NodeId& parent);

/// The server's users with passwords; nothing if it has no such list, or this user may not see it.
[[nodiscard]] std::optional<std::vector<UserManagementDataType>> find_users(Connection& connection);
/// Whether the configuration file of busbar-controller brings the user, who cannot be changed here.
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
/// Of applications, or of users; throws Failure if the server has none.
[[nodiscard]] TrustListNodes trust_list(Connection& connection, bool of_users);
/// What the list holds.
[[nodiscard]] TrustListDataType read_trust_list(Connection& connection,
                                                const TrustListNodes& nodes);
/// Has the server take the lists of `data` that its specifiedLists names, at once; throws Failure,
/// and nothing has changed.
void write_trust_list(Connection& connection, const TrustListNodes& nodes,
                      const TrustListDataType& data, const std::string& what);
/// AddUser. A name or password that is refused is told with the server's rules.
void add_user(Connection& connection, const std::string& name, const crypto::Secret& password,
              std::uint32_t bits, const std::string& description);
/// ModifyUser with what is to change; `password` may be null.
void change_user(Connection& connection, const std::string& name, const crypto::Secret* password,
                 std::optional<std::uint32_t> bits);

/// The certificates that the server refused.
[[nodiscard]] std::vector<crypto::Certificate> rejected(Connection& connection);
/// Those that can be read.
[[nodiscard]] std::vector<crypto::Certificate> certificates_of(const Array<ByteString>& ders);

} // namespace busbar::tool::admin
