#include <cstdint>
#include <span>

#include <busbar/administration/role_list.hpp>
#include <busbar/administration/user_list.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace administration_files_fuzz {

using namespace busbar;
using namespace busbar::administration;

namespace {

void put(Storage& storage, const char* name, std::span<const std::byte> bytes)
{
    static_cast<void>(storage.replace(name, bytes, FileAccess::Owner));
}

/// Rules of any origin decide for each kind of user without harm.
void ask(const RoleList& roles)
{
    server::UserIdentity issued{UserTokenType::IssuedToken, "pat"};
    issued.roles = {"line 3"};
    for (const server::UserIdentity& user :
         {server::UserIdentity{}, server::UserIdentity{UserTokenType::UserName, "pat"},
          server::UserIdentity{UserTokenType::Certificate, R"(O="Works, Ltd", CN=Pat)"}, issued}) {
        for (const bool is_trusted : {false, true}) {
            static_cast<void>(roles.roles_of({.user = user,
                                              .application_uri = "urn:client",
                                              .is_trusted = is_trusted,
                                              .endpoint_url = "opc.tcp://plc:4840"}));
        }
    }
    static_cast<void>(roles.is_administrator("pat"));
}

} // namespace

/// A file of roles or users that somebody wrote, or half of one. What was read is written as it was
/// read.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    storage::MemoryStorage storage;
    const auto bytes = std::as_bytes(std::span{data, size});
    put(storage, "roles.json", bytes);
    put(storage, "users.json", bytes);
    RoleList roles{storage, "roles.json"};
    if (roles.load()) {
        ask(roles);
        const std::size_t count = roles.roles().size();
        if (roles.add("added by the fuzzer", "")) {
            RoleList again{storage, "roles.json"};
            if (!again.load() || again.roles().size() != count + 1) {
                __builtin_trap();
            }
        }
    }
    server::PasswordUsers passwords;
    UserList users{storage, "users.json", {}, passwords};
    if (users.load()) {
        const std::vector<User> found = users.users();
        if (!found.empty() && users.remove(found.front().name)) {
            UserList again{storage, "users.json", {}, passwords};
            if (!again.load() || again.users().size() + 1 != found.size()) {
                __builtin_trap();
            }
        }
    }
    return 0;
}

} // namespace administration_files_fuzz
