#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/administration/administration.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/core/storage_folder.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/storage/memory_storage.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "administration_script.hpp"
#include "fuzz_script.hpp"
#include "kept_files.hpp"
#include "kept_world.hpp"
#include "quick_modules.hpp"
#include "require.hpp"
#include "support/server_fixture.hpp"
#include "support/watched_storage.hpp"

namespace rights_fuzz {

using namespace busbar;

inline constexpr std::string_view password = "patience";

/// What changes when somebody uses a right.
enum class Effect : std::uint8_t {
    File,
    Setting,
    SecuritySetting,
    Transfer,
    Certificates,
    Role,
    User,
    Password,
    State
};

/// Who may have it, one of these roles; a password is its owner's, too.
inline std::vector<std::string_view> roles_for(Effect effect)
{
    switch (effect) {
    case Effect::File:
    case Effect::Transfer:
        return {"Engineer"};
    case Effect::Setting:
    case Effect::State:
        return {"ConfigureAdmin", "SecurityAdmin"};
    default:
        return {"SecurityAdmin"};
    }
}

/// A user at one moment, with the roles that he had then.
struct Asker {
    std::string user;
    std::vector<std::string> roles;

    [[nodiscard]] bool has_one_of(const std::vector<std::string_view>& wanted) const
    {
        return std::any_of(wanted.begin(), wanted.end(), [&](std::string_view role) {
            return std::find(roles.begin(), roles.end(), role) != roles.end();
        });
    }
};

/// Keeps jobs until they are wanted, with those for whom each may be.
class LateWorker final : public server::Worker {
public:
    [[nodiscard]] bool run(std::function<void()> job) override
    {
        if (jobs.size() == most) {
            return false;
        }
        jobs.push_back({std::move(job), askers()});
        return true;
    }

    /// Does the oldest job and lets go of it; for whom that was.
    [[nodiscard]] std::vector<Asker> work()
    {
        const Job job = std::move(jobs.front());
        jobs.pop_front();
        job.work();
        return job.askers;
    }

    struct Job {
        std::function<void()> work;
        std::vector<Asker> askers;
    };

    static constexpr std::size_t most = 3;
    std::deque<Job> jobs;
    std::function<std::vector<Asker>()> askers;
};

struct NoteWaker final : Waker {
    void wake() override { is_awake = true; }

    bool is_awake{false};
};

/// Takes whatever it is told.
class Owner final : public administration::SettingOwner {
public:
    [[nodiscard]] Variant value(const administration::Setting& setting) const override
    {
        const auto found = applied.find(setting.name);
        return found != applied.end() ? found->second : setting.otherwise;
    }
    [[nodiscard]] bool waits_for_restart(const administration::Setting&) const override
    {
        return false;
    }
    [[nodiscard]] Configured<void> check(const administration::SettingValues&) override
    {
        return {};
    }
    void apply(const administration::SettingValues& changes) override { applied = changes; }

    administration::SettingValues applied;
};

class Transfers final : public administration::TransferOwner {
public:
    [[nodiscard]] Result<std::vector<std::byte>> generate(const administration::TransferRequest&,
                                                          std::size_t) override
    {
        return std::vector<std::byte>(10);
    }
    [[nodiscard]] StatusCode may_take(const administration::TransferRequest&) override
    {
        return status::Good;
    }
    [[nodiscard]] StatusCode take(const administration::TransferRequest&,
                                  std::span<const std::byte>) override
    {
        has_taken = true;
        return status::Good;
    }

    bool has_taken{false};
};

inline NodeId role(std::uint32_t number)
{
    return NodeId{0, number};
}

/// What is administered.
struct Managed {
    test::SeededRandom random;
    test::FixedWallClock clock;
    NullLog silence;
    NoteWaker waker;
    LateWorker worker;
    storage::MemoryStorage medium;
    test::WatchedStorage files{medium};
    fuzz::KeptFiles kept_files{medium};
    StorageFolder user_files{files, "users"};
    crypto::CertificateStore applications{files, {}, silence};
    crypto::CertificateStore user_certificates{user_files, {}, silence};
    StorageFolder recipe_files{files, "recipes"};
    administration::FileSystem recipes{.name = "recipes",
                                       .storage = &recipe_files,
                                       .limits = {.max_file_size = 200,
                                                  .max_written = 300,
                                                  .max_open = 4,
                                                  .max_open_of_session = 3,
                                                  .max_entries = 8,
                                                  .max_depth = 3},
                                       .readers = {role(id::WellKnownRole_Operator)},
                                       .writers = {role(id::WellKnownRole_Engineer)}};
    Transfers transfers;
    administration::TemporaryFileTransfer backup{
        .name = "backup",
        .owner = &transfers,
        .limits = {.max_file_size = 200, .max_held = 300, .max_open = 4, .max_open_of_session = 3},
        .client_processing_timeout = std::chrono::seconds{100},
        .readers = {role(id::WellKnownRole_Operator)},
        .writers = {role(id::WellKnownRole_Engineer)}};
    server::PasswordUsers passwords;
    administration::RoleList roles{files, "roles.json"};
    /// Hashes that cost nothing.
    administration::UserList users{
        files, "users.json", {.min_password_length = 1, .cost = {.log_n = 1}}, passwords};
    administration::SettingList settings{
        files,
        "settings.json",
        {{.name = "limits.sessions", .otherwise = Variant{std::int64_t{100}}},
         {.name = "users.anonymous", .otherwise = Variant{std::int64_t{0}}, .is_security = true}}};
    Owner owner;
    administration::ManagedCertificates certificates{.files = &files,
                                                     .applications = &applications,
                                                     .users = &user_certificates,
                                                     .users_folder = "users",
                                                     .max_trust_list_size = 20'000};
    administration::Administration administration{{.wall_clock = &clock,
                                                   .log = &silence,
                                                   .roles = &roles,
                                                   .users = &users,
                                                   .certificates = &certificates,
                                                   .random = &random,
                                                   .worker = &worker,
                                                   .stop = [] {},
                                                   .settings = &settings,
                                                   .setting_owner = &owner,
                                                   .file_systems = {recipes},
                                                   .file_transfers = {backup}}};
};

/// A server without security, so that inputs are quick: all that asks for an encrypted channel does
/// not here. Who may do what is as it is.
struct World : Managed {
    World()
    {
        worker.askers = [this] { return askers_now(); };
        fuzz::require(applications.create() && user_certificates.create() && roles.load());
        fuzz::require(recipe_files.make_folder("d", FileAccess::Owner).has_value());
        for (const char* name : {"a", "d/a"}) {
            fuzz::require(
                recipe_files
                    .replace(name, std::as_bytes(std::span{"0123456789"}), FileAccess::Owner)
                    .has_value());
        }
        add_user("ann", {});
        add_user("bob", {});
        give("ann", {"SecurityAdmin", "Engineer", "Operator"});
        give("bob", {"ConfigureAdmin", "Engineer"});
        add_user("chief", {"SecurityAdmin", "ConfigureAdmin", "Engineer", "Operator"});
        fuzz::require(administration.attach(server).has_value());
        for (const std::uint32_t object :
             {id::Server, id::ServerConfiguration, id::UserManagement,
              id::Server_ServerCapabilities_RoleSet, id::WellKnownRole_Engineer,
              id::WellKnownRole_SecurityAdmin, id::WellKnownRole_ConfigureAdmin,
              std::uint32_t{12642}, std::uint32_t{14123}}) { // and both trust lists
            const model::NodeIndex node = server.address_space().find(object);
            for (const char* method : methods) {
                add(node, node, method);
            }
        }
        add_setter();
        for (const char* path : {"", "/d", "/a", "/d/a", "/x"}) { // the last is made by others
            const bool is_folder = *path == '\0' || std::string_view{path} == "/d";
            for (const char* method : file_methods) {
                add_for(NodeId{1, String{std::string{"Files/recipes"} + path}},
                        find(is_folder ? "Files/recipes" : "FileTypes/recipes"), method);
            }
        }
        for (const char* method :
             {"GenerateFileForRead", "GenerateFileForWrite", "CloseAndCommit"}) {
            add(find("Transfers/backup"), find("Transfers/backup"), method);
        }
        open_channels(server.address_space().find(id::Server));
        for (const fuzz::MethodTarget& each : targets) { // which may have several Objects
            open_channels(server.address_space().find(each.object));
            open_channels(server.address_space().find(each.method));
        }
        open_channels(server.address_space().find(id::ObjectsFolder));
        open_channels(find("FileTypes/recipes"));
        open_new_channels(true);
        kept_files.keep();
        static_cast<void>(files.take_changed());
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;
    ~World() { worker.jobs.clear(); }

    void add_user(const char* name, std::vector<std::string> of_roles)
    {
        fuzz::require(
            users.add({name, {}, 0, {}, std::move(of_roles)}, password, random).has_value());
    }
    void give(const char* user, std::initializer_list<const char*> of_roles)
    {
        for (const char* const each : of_roles) {
            fuzz::require(roles.add_identity(each, {IdentityCriteriaType::UserName, String{user}})
                              .has_value());
        }
    }
    [[nodiscard]] model::NodeIndex find(const char* name)
    {
        return server.address_space().find(NodeId{1, String{name}});
    }
    void add(model::NodeIndex object, model::NodeIndex methods_of, const char* name)
    {
        add_for(server.address_space().node_id(object), methods_of, name);
    }
    void add_for(const NodeId& object, model::NodeIndex methods_of, const char* name)
    {
        if (auto target = fuzz::find_method(server.address_space(), methods_of, name)) {
            target->object = object;
            targets.push_back(*std::move(target));
        }
    }
    /// Its Method has no name of namespace 0.
    void add_setter()
    {
        Argument names;
        names.name = "Names";
        names.data_type = NodeId{0, id::String};
        names.value_rank = 1;
        Argument values;
        values.name = "Values";
        values.data_type = NodeId{0, id::BaseDataType};
        values.value_rank = 1;
        targets.push_back({NodeId{1, "Settings"}, NodeId{1, "Settings.Set"}, {names, values}});
    }
    /// Takes AccessRestrictions away of a node and all below it.
    void open_channels(model::NodeIndex top)
    {
        auto& space = server.address_space();
        if (top == model::no_node) {
            return;
        }
        std::vector<model::NodeIndex> nodes{top};
        space.for_each_below(top, [&](model::NodeIndex one) {
            nodes.push_back(one);
            return true;
        });
        for (const model::NodeIndex node : nodes) {
            const auto* const given = space.role_permissions(node);
            if (space.access_restrictions(node) != 0) {
                space.set_node_access(
                    node,
                    {.restrictions = std::uint16_t{0},
                     .role_permissions = given != nullptr ? *given : Array<RolePermissionType>{}});
            }
        }
    }
    /// What files, roles and transfers bring.
    void open_new_channels(bool has_files)
    {
        if (has_files) {
            open_channels(find("Files/recipes"));
        }
        if (std::exchange(has_generated, false)) {
            open_channels(find("Transfers/backup"));
        }
        if (roles.roles().size() != role_count) {
            role_count = roles.roles().size();
            open_channels(server.address_space().find(id::Server_ServerCapabilities_RoleSet));
        }
    }

    /// With the roles that the user has now, as somebody who is not logged in sees it.
    [[nodiscard]] Asker asker(const std::string& user) const
    {
        const auto found = users.find(user);
        if (!found ||
            (found->configuration & (administration::user_bit::disabled |
                                     administration::user_bit::must_change_password)) != 0) {
            return {user, {}};
        }
        server::UserIdentity identity{UserTokenType::UserName, user};
        identity.roles = found->roles;
        const server::RoleQuestion question{.user = identity,
                                            .application_uri = "urn:busbar:test:client",
                                            .endpoint_url = "opc.tcp://localhost:4840",
                                            .security_mode = MessageSecurityMode::None,
                                            .security_policy_uri = crypto::policy_none().uri};
        server::UserRights rights = roles.roles_of(question);
        rights.roles.insert(rights.roles.end(), found->roles.begin(), found->roles.end());
        return {user, roles.limited(question, std::move(rights)).roles};
    }
    /// Of all who wait for an answer, and who asks in this step.
    [[nodiscard]] std::vector<Asker> askers_now() const
    {
        std::vector<Asker> all;
        for (const std::string& user : waiting) {
            all.push_back(asker(user));
        }
        return all;
    }

    test::FixedWallClock& wall_clock{clock};
    TimePoint now{};
    server::Server server{make_server()};
    std::vector<fuzz::MethodTarget> targets;
    /// Users whose Calls may not have ended.
    std::set<std::string> waiting;
    std::size_t role_count{0};
    /// A temporary file may have come.
    bool has_generated{false};
    /// The last one that a Method of the Object gave.
    std::map<std::string, std::uint32_t> handles;
    NodeId transferred{1, ""};

private:
    static constexpr std::array file_methods{
        "Open",        "Close",           "Read",       "Write",  "GetPosition",
        "SetPosition", "CreateDirectory", "CreateFile", "Delete", "MoveOrCopy"};
    /// But those that make keys, which cost too much.
    static constexpr std::array methods{"Open",
                                        "OpenWithMasks",
                                        "Close",
                                        "Read",
                                        "Write",
                                        "SetPosition",
                                        "CloseAndUpdate",
                                        "AddCertificate",
                                        "RemoveCertificate",
                                        "ApplyChanges",
                                        "CancelChanges",
                                        "GetRejectedList",
                                        "AddUser",
                                        "ModifyUser",
                                        "RemoveUser",
                                        "ChangePassword",
                                        "AddRole",
                                        "RemoveRole",
                                        "AddIdentity",
                                        "RemoveIdentity",
                                        "AddApplication",
                                        "RemoveApplication",
                                        "AddEndpoint",
                                        "RemoveEndpoint",
                                        "RequestServerStateChange"};

    server::Server make_server()
    {
        server::ServerConfig config;
        config.application_uri = "urn:busbar:test:server";
        config.endpoints = {{}};
        config.endpoints[0].security = {&crypto::policy_none(), MessageSecurityMode::None};
        config.endpoints[0].allows_anonymous = true;
        config.endpoints[0].password_policy = &crypto::policy_none();
        config.endpoints[0].allows_plain_passwords = true;
        config.limits.events.max_raised_events = 16; // whose places are written for each server
        return *server::Server::create(fuzz::quick_modules(), config,
                                       {.random = &random,
                                        .wall_clock = &clock,
                                        .log = &silence,
                                        .users = &passwords,
                                        .roles = &roles,
                                        .waker = &waker});
    }
};

} // namespace rights_fuzz
