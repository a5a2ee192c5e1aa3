#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <busbar/administration/administration.hpp>
#include <busbar/core/storage_folder.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/storage/memory_storage.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "administration_script.hpp"
#include "fuzz_script.hpp"
#include "kept_files.hpp"
#include "server_session.hpp"

namespace administration_fuzz {

using namespace busbar;

namespace {

/// Methods in one Call.
constexpr std::size_t most_together = 8;

/// Everybody may do everything: what is looked for lies behind the rights.
class Users final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        return fail(status::Bad_UserAccessDenied);
    }
    [[nodiscard]] server::UserIdentity anonymous() const override
    {
        server::UserIdentity user;
        user.roles = {"SecurityAdmin", "ConfigureAdmin"};
        return user;
    }
};

/// Hashes and keys cost too much here.
class NoWorker final : public server::Worker {
public:
    [[nodiscard]] bool run(std::function<void()>) override { return false; }
};

/// Makes as many bytes as it is told, and takes everything.
class Transfers final : public administration::TransferOwner {
public:
    [[nodiscard]] Result<std::vector<std::byte>>
    generate(const administration::TransferRequest& request, std::size_t) override
    {
        return std::vector<std::byte>(request.options.value_or<std::uint32_t>(0));
    }
    [[nodiscard]] StatusCode may_take(const administration::TransferRequest&) override
    {
        return status::Good;
    }
    [[nodiscard]] StatusCode take(const administration::TransferRequest&,
                                  std::span<const std::byte> bytes) override
    {
        return bytes.size() % 2 == 0 ? status::Good : status::Bad_InvalidState;
    }
};

struct NoteWaker final : Waker {
    void wake() override { is_awake = true; }

    bool is_awake{false};
};

struct Backend {
    Users users;
    NoteWaker waker;
    NoWorker worker;
    NullLog silence;
    test::FixedWallClock clock;
    crypto::SystemRandom system_random;
    storage::MemoryStorage files;
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
                                       .readers = {},
                                       .writers = {NodeId{0, id::WellKnownRole_SecurityAdmin}}};
    Transfers transfers;
    administration::TemporaryFileTransfer backup{
        .name = "backup",
        .owner = &transfers,
        .limits = {.max_file_size = 200, .max_held = 300, .max_open = 4, .max_open_of_session = 3},
        .client_processing_timeout = std::chrono::seconds{100},
        .readers = {},
        .writers = {NodeId{0, id::WellKnownRole_SecurityAdmin}}};
    server::PasswordUsers passwords;
    administration::RoleList roles{files, "roles.json"};
    administration::UserList user_list{files, "users.json", {}, passwords};
    administration::ManagedCertificates certificates{.files = &files,
                                                     .applications = &applications,
                                                     .users = &user_certificates,
                                                     .users_folder = "users",
                                                     .max_trust_list_size = 20'000};
    administration::Administration administration{{.wall_clock = &clock,
                                                   .log = &silence,
                                                   .roles = &roles,
                                                   .users = &user_list,
                                                   .certificates = &certificates,
                                                   .random = &system_random,
                                                   .worker = &worker,
                                                   .stop = [] {},
                                                   .file_systems = {recipes},
                                                   .file_transfers = {backup}}};
};

struct Fixture : Backend, fuzz::ServerSession {
    Fixture() : fuzz::ServerSession{&users, false, &waker}
    {
        static_cast<void>(applications.create());
        static_cast<void>(user_certificates.create());
        static_cast<void>(roles.load());
        make_recipes();
        static_cast<void>(administration.attach(server));
        auto& space = server.address_space();
        for (const std::uint32_t object :
             {id::Server, id::ServerConfiguration, id::UserManagement,
              id::Server_ServerCapabilities_RoleSet, id::WellKnownRole_Operator,
              std::uint32_t{12642}, std::uint32_t{14123}}) { // and both trust lists
            for (const char* method : methods) {
                add(space.find(object), method);
            }
        }
        for (const char* path : {"", "/d", "/a", "/d/a", "/x"}) { // the last is made by others
            add_file_methods(path);
        }
        for (const char* method :
             {"GenerateFileForRead", "GenerateFileForWrite", "CloseAndCommit"}) {
            add(space.find(NodeId{1, "Transfers/backup"}), method);
        }
        lasting_targets = targets.size();
        keeps_connection = true;
        kept_files.keep();
    }
    void make_recipes()
    {
        static_cast<void>(recipe_files.make_folder("d", FileAccess::Owner));
        for (const char* name : {"a", "d/a"}) {
            static_cast<void>(recipe_files.replace(name, std::as_bytes(std::span{"0123456789"}),
                                                   FileAccess::Owner));
        }
    }
    /// Ends the sessions and undoes what they did. False if the server is shutting down, or if
    /// something of them stays.
    [[nodiscard]] bool disconnect()
    {
        const bool is_over = fuzz::ServerSession::disconnect();
        files.set_protected(false);
        const bool had_changed = kept_files.restore();
        const bool is_restored = !had_changed || undo_roles();
        if (had_changed) {
            administration.refresh_files();
            for (const char* path : {"/d", "/a", "/d/a"}) {
                open_to_all(path);
            }
        }
        handles_before = handles;
        targets.resize(lasting_targets);
        return is_over && is_restored &&
               server::RunningServer{server}.change_state(ServerState::Running, "", {});
    }
    /// Makes the server have the roles of its file again.
    [[nodiscard]] bool undo_roles()
    {
        auto& space = server.address_space();
        for (const administration::RoleRules& role : roles.roles()) {
            if (!administration::RoleList::is_well_known(role.name)) {
                static_cast<void>(space.remove(space.find(
                    NodeId{1, String{"RoleSet/" + role.namespace_uri + "/" + role.name}})));
            }
        }
        return roles.load().has_value();
    }
    void add_call(const fuzz::MethodTarget& target, fuzz::Script& script)
    {
        CallMethodRequest call;
        call.object_id = target.object;
        call.method_id = target.method;
        for (const Argument& argument : target.inputs) {
            const bool is_handle = argument.name.view().ends_with("Handle");
            call.input_arguments.push_back(is_handle ? Variant{handle(target.object, script.byte())}
                                                     : fuzz::value_of(argument, script));
        }
        waiting.methods_to_call.push_back(std::move(call));
        called.push_back(&target);
    }
    /// Sends the Calls that wait. What they left for the server's thread is done before the next.
    void send_calls()
    {
        if (called.empty()) {
            return;
        }
        send(std::exchange(waiting, {}));
        while (std::exchange(waker.is_awake, false)) {
            server.handle_completions(now);
        }
        run();
        note_handles();
        follow_transfers();
        called.clear();
    }
    void add_file_methods(const std::string& path)
    {
        auto& space = server.address_space();
        const NodeId object{1, String{"Files/recipes" + path}};
        const bool is_folder = path.empty() || path == "/d";
        const NodeId methods_of{1, String{is_folder ? "Files/recipes" : "FileTypes/recipes"}};
        const auto first = targets.size();
        for (const char* method : file_methods) {
            add(space.find(methods_of), method);
        }
        for (auto target = first; target < targets.size(); ++target) {
            targets[target].object = object;
        }
        open_to_all(path);
    }
    void open_to_all(const std::string& path)
    {
        auto& space = server.address_space();
        const model::NodeIndex node = space.find(NodeId{1, String{"Files/recipes" + path}});
        if (node != model::no_node) {
            space.set_node_access(node, {});
        }
    }
    /// A session, and no temporary files of earlier inputs: they go with the next of their Methods.
    void begin()
    {
        log_in();
        if (followed.empty()) {
            return;
        }
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = targets.back().object;
        request.methods_to_call[0].method_id = targets.back().method; // CloseAndCommit
        request.methods_to_call[0].input_arguments.push_back(Variant{std::uint32_t{0}});
        send(std::move(request));
        followed.clear();
    }
    /// Temporary files come and go, by a Method of theirs.
    void follow_transfers()
    {
        const bool is_any =
            std::any_of(called.begin(), called.end(), [](const fuzz::MethodTarget* target) {
                return target->object.id_type() == IdType::String &&
                       target->object.string().view().starts_with("Transfers/");
            });
        if (!is_any) {
            return;
        }
        auto& space = server.address_space();
        std::vector<NodeId> transferred;
        const model::NodeIndex type = space.find(id::FileType);
        space.for_each_below(space.find(NodeId{1, "Transfers/backup/files"}),
                             [&](model::NodeIndex node) {
                                 if (space.type_definition(node) == type) {
                                     transferred.push_back(space.node_id(node));
                                 }
                                 return true;
                             });
        if (transferred == followed) {
            return;
        }
        followed = transferred;
        targets.erase(targets.begin() + static_cast<std::ptrdiff_t>(lasting_targets),
                      targets.end());
        for (const NodeId& file : transferred) {
            for (const char* method : file_methods) {
                add(space.find(file), method);
            }
        }
    }
    void add(model::NodeIndex object, const char* name)
    {
        auto& space = server.address_space();
        auto target = fuzz::find_method(space, object, name);
        if (!target) {
            return;
        }
        space.set_node_access(object, {});
        space.set_node_access(space.find(target->method), {});
        targets.push_back(*std::move(target));
    }

    /// What counts the handles of the Object's files.
    [[nodiscard]] static std::string counter_of(const NodeId& object)
    {
        const std::string text = to_string(object);
        return text.find("Files/") != std::string::npos       ? "files"
               : text.find("Transfers/") != std::string::npos ? "transfers"
                                                              : text;
    }
    /// Handles go on from input to input: the script's begin at the first one of the input.
    [[nodiscard]] std::uint32_t handle(const NodeId& object, std::uint8_t small)
    {
        return handles_before[counter_of(object)] + small;
    }
    /// Looks for handles in the last answer.
    void note_handles()
    {
        const bool is_any = std::any_of(called.begin(), called.end(),
                                        [](const auto* target) { return target->gives_handle; });
        if (!is_any || responses.empty()) {
            return;
        }
        binary::Reader reader{responses.back()};
        NodeId id;
        CallResponse response;
        decode(reader, id);
        if (!id.is(CallResponse::binary_encoding_id)) {
            return;
        }
        decode(reader, response);
        for (std::size_t i = 0; i < std::min(called.size(), response.results.size()); ++i) {
            if (!called[i]->gives_handle) {
                continue;
            }
            for (const Variant& output : response.results[i].output_arguments) {
                if (const auto* const given = output.get_if<std::uint32_t>()) {
                    std::uint32_t& latest = handles[counter_of(called[i]->object)];
                    latest = std::max(*given, latest);
                }
            }
        }
    }

    static constexpr std::array file_methods{
        "Open",        "Close",           "Read",       "Write",  "GetPosition",
        "SetPosition", "CreateDirectory", "CreateFile", "Delete", "MoveOrCopy"};
    static constexpr std::array methods{"Open",
                                        "OpenWithMasks",
                                        "Close",
                                        "Read",
                                        "Write",
                                        "GetPosition",
                                        "SetPosition",
                                        "CloseAndUpdate",
                                        "AddCertificate",
                                        "RemoveCertificate",
                                        "UpdateCertificate",
                                        "CreateSigningRequest",
                                        "ApplyChanges",
                                        "CancelChanges",
                                        "GetRejectedList",
                                        "GetCertificates",
                                        "DeleteCertificate",
                                        "CreateSelfSignedCertificate",
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
    /// The latest of each counter, and those before the input.
    std::map<std::string, std::uint32_t> handles;
    std::map<std::string, std::uint32_t> handles_before;
    /// What there is before an input.
    fuzz::KeptFiles kept_files{files};
    std::vector<fuzz::MethodTarget> targets;
    /// The temporary files, whose Methods are behind the lasting ones.
    std::vector<NodeId> followed;
    std::size_t lasting_targets{0};
    /// Methods that are called together, and the targets of each; see send_calls().
    CallRequest waiting;
    std::vector<const fuzz::MethodTarget*> called;
};

} // namespace

/// The administration's Methods with arguments of their types, in any order, alone or some of them
/// in one Call, on a medium that may fail, with time and a second session between them.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static fuzz::KeptServer<Fixture> kept;
    fuzz::Script script{{data, size}};
    Fixture& fixture = kept.begin();
    fixture.begin();
    for (int step = 0; step < 40 && !script.is_over() && !fixture.targets.empty(); ++step) {
        const std::uint8_t choice = script.byte();
        if (choice >= 253) {
            fixture.send_calls();
        }
        if (choice == 255) {
            fixture.files.set_protected(script.byte() % 2 == 0);
            continue;
        }
        if (choice == 254) {
            fixture.pass(std::chrono::seconds{script.byte()});
            continue;
        }
        if (choice == 253) {
            fixture.log_in();
            continue;
        }
        fixture.add_call(fixture.targets[choice % fixture.targets.size()], script);
        if (fixture.called.size() == most_together || script.byte() % 4 == 0) {
            fixture.send_calls();
        }
    }
    fixture.send_calls();
    kept.end();
    return 0;
}

} // namespace administration_fuzz
