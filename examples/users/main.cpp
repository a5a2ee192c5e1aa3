// Two users with a role each, and a Variable that only one of these roles may write.
// usage: EXAMPLE_PASSWORD=... users-server [PORT]
#include <cstdlib>

#include <busbar/crypto/random.hpp>
#include <busbar/net/server_app.hpp>

using namespace busbar;

namespace {

RolePermissionType permissions(std::uint32_t role, PermissionType granted)
{
    RolePermissionType made;
    made.role_id = NodeId{0, role};
    made.permissions = granted;
    return made;
}

/// Both have the same password here, which you would not do.
Checked<void> add_users(server::PasswordUsers& users, const char* password)
{
    crypto::SystemRandom random;
    server::UserRights reads;
    reads.access_level_mask = static_cast<std::uint8_t>(model::Access::Read);
    reads.roles = {"Observer"};
    server::UserRights writes;
    writes.roles = {"Operator"};
    return users.add("visitor", password, random, reads).and_then([&] {
        return users.add("operator", password, random, writes);
    });
}

/// Operators may change the recipe; observers do not even see it.
void restrict_recipe(model::AddressSpace& space, std::uint16_t ns)
{
    model::NodeAccess access;
    access.role_permissions = {
        permissions(id::WellKnownRole_Operator,
                    PermissionType::Browse | PermissionType::Read | PermissionType::Write)};
    space.set_node_access(space.find(NodeId{ns, "Recipe"}), access);
}

} // namespace

int main(int argc, char** argv)
{
    const std::string port = argc > 1 ? argv[1] : "4840";
    net::ServerApp app{{"urn:example:users-server", "Users server", "server_pki"},
                       "opc.tcp://localhost:" + port};
    const char* const password = std::getenv("EXAMPLE_PASSWORD");
    if (const auto added = add_users(app.users(), password != nullptr ? password : ""); !added) {
        std::fprintf(stderr, "EXAMPLE_PASSWORD: %s\n", text(added.error()).c_str());
        return 1;
    }
    const std::uint16_t ns = app.add_namespace("urn:example:press");
    app.add_variable({ns, "Speed"}, 1480.0, model::Access::ReadWrite);
    app.add_variable({ns, "Recipe"}, "cover plate", model::Access::ReadWrite);
    if (app.status()) {
        restrict_recipe(app.server()->address_space(), ns);
    }
    return app.run();
}
