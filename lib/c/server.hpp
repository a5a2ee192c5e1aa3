#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/busbar.h>
#include <busbar/core/function_ref.hpp>
#include <busbar/model/new_node.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/server/server.hpp>

#include "guard.hpp"
#include "surroundings.hpp"
#include "value.hpp"

namespace busbar::server {
class MethodTable;
} // namespace busbar::server

namespace busbar::c {

class VariableSource;

/// The users of a table, and a program's callback for others.
class CallbackUsers final : public server::UserStore {
public:
    /// Null: no others.
    void ask(busbar_login_callback login, void* context);
    [[nodiscard]] server::PasswordUsers& table() { return table_; }

    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view name,
                                                      std::string_view password) override;
    [[nodiscard]] server::UserIdentity anonymous() const override { return table_.anonymous(); }

private:
    server::PasswordUsers table_;
    busbar_login_callback login_{nullptr};
    void* context_{nullptr};
};

/// Runs the body of a function for a server that works; null and one that could not be created have
/// their statuses.
[[nodiscard]] busbar_status enter(busbar_server* server, FunctionRef<StatusCode()> body) noexcept;

/// Runs likewise what changes nodes; Bad_InvalidState in a callback, which requests run around.
[[nodiscard]] busbar_status change(busbar_server* server, FunctionRef<StatusCode()> body) noexcept;

/// Returns the attributes that a program gave a new node, below `folder` unless it names a parent.
/// The NodeId of a node without one is its path, as in AddressSpace::add_variable.
[[nodiscard]] Result<model::NewNode> new_node_of(const model::AddressSpace& space,
                                                 const busbar_node& node, std::uint32_t folder);
/// Returns a DataType of namespace 0 by its built-in type; null for one that busbar_value lacks.
[[nodiscard]] NodeId built_in_type_id(std::uint8_t type);
/// Gives a Variable the DataType, ValueRank and ArrayDimensions of a value.
/// Bad_NodeAttributesInvalid if the value is null.
StatusCode set_shape(const model::AddressSpace& space, const Variant& like,
                     model::NewVariable& variable);

} // namespace busbar::c

/// A server with all that it owns. What the server uses stands before it.
struct busbar_server {
    explicit busbar_server(const busbar_application& application);
    busbar_server(const busbar_server&) = delete;
    busbar_server& operator=(const busbar_server&) = delete;
    ~busbar_server();

    mutable busbar::c::FailureText failure;
    /// The reason why it could not be created, or Good.
    busbar::StatusCode created{busbar::status::Bad_InvalidState};
    busbar::c::ApplicationSurroundings around;
    busbar::net::ServerLoop loop;
    busbar::c::CallbackUsers users;
    std::uint16_t port{0};
    /// The numbers of busbar_server_add_source.
    std::vector<std::uint32_t> sources;
    bool is_started{false};
    bool is_serving{false};
    bool is_over{false};
    /// Structures and images, which programs have pointers to.
    std::vector<std::shared_ptr<void>> owned;
    std::shared_ptr<busbar::c::VariableSource> variables;
    std::shared_ptr<busbar::server::MethodTable> methods;
    /// Keeps what busbar_server_get_value points at.
    busbar::c::Scratch scratch;
    std::optional<busbar::server::Server> server;
};
