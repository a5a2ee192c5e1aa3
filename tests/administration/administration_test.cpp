#include <algorithm>
#include <span>
#include <string>
#include <string_view>

#include "managed_fixture.hpp"

namespace administration_test {

// What an Administration refuses before anybody connects: parts that do not go together, and nodes
// that a program's own model took.

using namespace busbar;
using namespace busbar::test;

namespace {

using administration::AdministrationParts;

/// Has bytes for so many calls.
struct ShortRandom final : crypto::Random {
    [[nodiscard]] Result<void> fill(std::span<std::byte> bytes) override
    {
        if (left == 0) {
            return fail(status::Bad_ResourceUnavailable);
        }
        --left;
        std::fill(bytes.begin(), bytes.end(), std::byte{7});
        return {};
    }

    int left{0};
};

struct Parts : ManagedFixture {
    [[nodiscard]] server::Server fresh(server::Waker* woken)
    {
        auto made =
            server::Server::create(ServerFixture::secure_config(), {.random = &random,
                                                                    .wall_clock = &wall_clock,
                                                                    .log = &log,
                                                                    .validator = &validator,
                                                                    .users = &passwords,
                                                                    .roles = &roles,
                                                                    .waker = woken});
        REQUIRE(made);
        return *std::move(made);
    }
    [[nodiscard]] server::Server fresh() { return fresh(&waker); }
    /// All of one kind, and what it needs.
    [[nodiscard]] AdministrationParts basic()
    {
        return {.wall_clock = &wall_clock, .log = &log, .random = &random};
    }
    [[nodiscard]] AdministrationParts with_certificates()
    {
        AdministrationParts parts = basic();
        parts.certificates = &certificates;
        parts.users = &user_list;
        parts.stop = [] {};
        parts.reset = [] { return Configured<void>{}; };
        parts.is_in_setup = [] { return false; };
        return parts;
    }
    [[nodiscard]] AdministrationParts with_settings()
    {
        AdministrationParts parts = basic();
        parts.settings = &settings;
        parts.setting_owner = &owner;
        return parts;
    }
    [[nodiscard]] AdministrationParts with_files()
    {
        AdministrationParts parts = basic();
        parts.file_systems = {files};
        return parts;
    }
    [[nodiscard]] AdministrationParts with_transfers()
    {
        AdministrationParts parts = basic();
        parts.file_transfers = {transfer};
        return parts;
    }
    [[nodiscard]] TestClient log_in_to(server::Server& bare)
    {
        TestClient client = connect_to(bare);
        REQUIRE(client.create_session());
        REQUIRE(client.activate(client.user("admin", "admin-secret!")) == status::Good);
        return client;
    }
    /// What attach() says has a problem; empty: nothing.
    [[nodiscard]] std::string problem(const AdministrationParts& parts, const NodeId& taken = {})
    {
        administration::Administration one{parts};
        server::Server bare = fresh();
        model::AddressSpace& space = bare.address_space();
        if (!taken.is_null()) {
            model::NewNode node;
            node.id = taken;
            node.browse_name = QualifiedName{1, "taken"};
            node.parent = space.find(id::ObjectsFolder);
            REQUIRE(space.add_folder(node));
        }
        const auto attached = one.attach(bare);
        return attached ? "" : attached.error().where;
    }
};

} // namespace

TEST_CASE_METHOD(Parts, "administration: a server without a way back to its thread is refused")
{
    server::Server bare = fresh(nullptr);
    administration::Administration one{with_certificates()};
    const auto attached = one.attach(bare);
    REQUIRE_FALSE(attached);
    CHECK(attached.error().where == "waker");
}

TEST_CASE_METHOD(Parts, "administration: parts that do not go together are refused")
{
    CHECK(problem(basic()).empty());
    AdministrationParts parts = with_certificates();
    CHECK(problem(parts).empty());
    parts.random = nullptr;
    CHECK(problem(parts) == "random");
    parts = with_certificates();
    parts.certificates = nullptr;
    CHECK(problem(parts) == "users");
    parts.users = nullptr;
    CHECK(problem(parts) == "reset");
    parts = with_certificates();
    parts.stop = {};
    CHECK(problem(parts) == "reset");

    parts = with_certificates();
    administration::ManagedCertificates incomplete = certificates;
    incomplete.files = nullptr;
    parts.certificates = &incomplete;
    CHECK(problem(parts) == "certificates");
    incomplete = certificates;
    incomplete.applications = nullptr;
    CHECK(problem(parts) == "certificates");

    parts = with_settings();
    parts.setting_owner = nullptr;
    CHECK(problem(parts) == "settings");
    parts = with_settings();
    parts.settings = nullptr;
    CHECK(problem(parts) == "settings");

    parts = with_files();
    parts.file_systems[0].storage = nullptr;
    CHECK(problem(parts) == "files \"recipes\"");
    for (const char* name : {"", ".", "a/b", "a\\b"}) {
        parts = with_files();
        parts.file_systems[0].name = name;
        CHECK(problem(parts) == "files \"" + std::string{name} + "\"");
    }
}

TEST_CASE_METHOD(Parts, "administration: nodes that a program has taken are named")
{
    const auto own = [](const char* text) { return NodeId{1, text}; };
    REQUIRE(roles.add("Fitter", ""));
    AdministrationParts with_roles = basic();
    with_roles.roles = &roles;
    CHECK(problem(with_roles).empty());
    CHECK(problem(with_roles, own("RoleSet//Fitter")) == "role \"Fitter\"");
    CHECK(problem(with_roles, NodeId{0, 15684}) == "roles"); // Operator's AddIdentity

    for (const char* text :
         {"OwnCertificate", "OwnCertificate/HostNames", "OwnCertificate/Thumbprint"}) {
        const std::string name = "ServerConfiguration/" + std::string{text};
        CHECK(problem(with_certificates(), own(name.c_str())) == "certificates");
    }
    // GetCertificates, CreateSelfSignedCertificate, DeleteCertificate, InApplicationSetup.
    for (const std::uint32_t standard : {32333U, 19342U, 19345U, 19309U}) {
        CHECK(problem(with_certificates(), NodeId{0, standard}) == "certificates");
    }
    CHECK(problem(with_certificates(), NodeId{0, id::UserManagement_AddUser}) == "users");
    CHECK(problem(with_certificates(), NodeId{0, id::Server_RequestServerStateChange}) == "stop");
    CHECK(problem(with_certificates(), NodeId{0, id::ServerConfiguration_ResetToServerDefaults}) ==
          "reset");
    CHECK(problem(with_certificates(), NodeId{0, id::ServerConfiguration_ApplicationUri}) ==
          "certificates");

    for (const char* text :
         {"Settings", "Settings.Set", "Settings.limits.sessions",
          "Settings.limits.sessions.InstrumentRange", "Settings.server.port.IsChanged"}) {
        CHECK(problem(with_settings(), own(text)) == "settings");
    }
    for (const char* text : {"Files/recipes", "Files/recipes//CreateFile", "FileTypes/recipes",
                             "FileTypes/recipes//Open"}) {
        CHECK(problem(with_files(), own(text)) == "files recipes");
    }
    for (const char* text :
         {"Transfers/backup", "Transfers/backup//CloseAndCommit",
          "Transfers/backup//ClientProcessingTimeout", "Transfers/backup/files"}) {
        CHECK(problem(with_transfers(), own(text)) == "transfer backup");
    }
}

TEST_CASE_METHOD(Parts, "administration: a file whose node is taken is left out, others are there")
{
    REQUIRE(file_storage.make_folder("press", FileAccess::Owner));
    for (const char* name : {"a", "b", "press/c"}) {
        REQUIRE(file_storage.replace(name, {}, FileAccess::Owner));
    }
    administration::Administration one{with_files()};
    server::Server bare = fresh();
    model::AddressSpace& space = bare.address_space();
    for (const char* taken : {"Files/recipes/a//Size", "Files/recipes/press"}) {
        model::NewNode node;
        node.id = NodeId{1, taken};
        node.browse_name = QualifiedName{1, taken};
        node.parent = space.find(id::ObjectsFolder);
        REQUIRE(space.add_folder(node));
    }
    REQUIRE(one.attach(bare));
    CHECK(space.find(NodeId{1, "Files/recipes/a"}) == model::no_node);
    CHECK(space.find(NodeId{1, "Files/recipes/b"}) != model::no_node);
    CHECK(space.find(NodeId{1, "Files/recipes/press/c"}) == model::no_node);
    CHECK(space.find(NodeId{1, "Files/recipes/a//Size"}) != model::no_node);
}

TEST_CASE_METHOD(Parts, "administration: what a part is missing for is absent")
{
    certificates.users = nullptr;
    AdministrationParts parts = basic();
    parts.certificates = &certificates;
    administration::Administration one{parts};
    server::Server bare = fresh();
    REQUIRE(one.attach(bare));
    const auto& space = bare.address_space();
    CHECK(space.find(id::ServerConfiguration_CertificateGroups_DefaultApplicationGroup) !=
          model::no_node);
    CHECK(space.find(id::ServerConfiguration_CertificateGroups_DefaultUserTokenGroup) ==
          model::no_node);
    CHECK(space.find(id::UserManagement_AddUser) == model::no_node);
    CHECK(space.find(id::Server_RequestServerStateChange) == model::no_node);
    CHECK(space.find(id::ServerConfiguration_ResetToServerDefaults) == model::no_node);
    CHECK(space.find(NodeId{0, 19309}) == model::no_node);
    CHECK(space.find(NodeId{1, "Settings"}) == model::no_node);
}

TEST_CASE_METHOD(Parts, "administration: certificates whose change cannot be finished are not used")
{
    const std::string nonsense = "[{\"name\":7}]";
    REQUIRE(storage.make_folder("transaction", FileAccess::Owner));
    REQUIRE(storage.replace("transaction/journal.json", std::as_bytes(std::span{nonsense}),
                            FileAccess::Owner));
    CHECK(problem(with_certificates()) == storage.place("transaction"));
}

TEST_CASE_METHOD(Parts, "administration: clients are told the rules of passwords")
{
    server::PasswordUsers others;
    server::PasswordRules rules;
    rules.min_password_length = 6;
    rules.max_password_length = 32;
    rules.password_characters = "abcABC123_";
    rules.needs_letters_and_digit = true;
    administration::UserList strict{storage, "others.json", rules, others};
    REQUIRE(strict.load());
    AdministrationParts parts = with_certificates();
    parts.users = &strict;
    administration::Administration one{parts};
    server::Server bare = fresh();
    REQUIRE(one.attach(bare));
    auto admin = log_in_to(bare);
    // Part 18, 5.2.2: what every list does, and three kinds of characters.
    CHECK(read(admin, id::UserManagement_PasswordOptions).value.value_or<std::uint32_t>(0) ==
          (31U | 32U | 64U | 128U));
    const DataValue length = read(admin, id::UserManagement_PasswordLength);
    const auto* const object = length.value.get_if<ExtensionObject>();
    REQUIRE(object != nullptr);
    REQUIRE(object->get_if<Range>() != nullptr);
    CHECK(*object->get_if<Range>() == Range{6, 32});
    CHECK(read(admin, id::UserManagement_PasswordRestrictions)
              .value.value_or<LocalizedText>({})
              .text.view()
              .ends_with("only these characters: abcABC123_"));
    CHECK(read(admin, id::UserManagement_Users).value.array_size() == 0);
}

TEST_CASE_METHOD(Parts, "administration: a file without a name that nobody guesses is not made")
{
    ShortRandom none;
    transfer.readers = {NodeId{0, id::WellKnownRole_SecurityAdmin}};
    transfer.writers = transfer.readers;
    AdministrationParts parts = with_transfers();
    parts.random = &none;
    administration::Administration one{parts};
    server::Server bare = fresh();
    REQUIRE(one.attach(bare));
    auto admin = log_in_to(bare);
    const auto make = [&](const char* method) {
        return name(call(admin, NodeId{1, "Transfers/backup"},
                         NodeId{1, String{"Transfers/backup//" + std::string{method}}}, {Variant{}})
                        .status_code);
    };
    const std::size_t before = bare.address_space().node_count();
    CHECK(make("GenerateFileForRead") == "Bad_ResourceUnavailable");
    CHECK(make("GenerateFileForWrite") == "Bad_ResourceUnavailable");
    CHECK(bare.address_space().node_count() == before);
    none.left = 2;
    CHECK(make("GenerateFileForRead") == "Good");
    // The same name again, whose node is taken.
    CHECK(make("GenerateFileForWrite").starts_with("Bad_"));
}

TEST_CASE("administration: an owner of transfers that overrides nothing has none")
{
    administration::TransferOwner owner;
    const Variant options;
    const server::UserIdentity user;
    const NodeId session{0, 1};
    const administration::TransferRequest request{options, user, session};
    const auto made = owner.generate(request, 1'000);
    REQUIRE_FALSE(made);
    CHECK(made.error() == status::Bad_NotSupported);
    CHECK(owner.may_take(request) == status::Bad_NotSupported);
    CHECK(owner.take(request, {}) == status::Bad_NotSupported);
}

TEST_CASE_METHOD(Parts, "administration: null where a Method expects something changes nothing")
{
    struct Case {
        std::uint32_t object;
        std::uint32_t method;
        std::size_t inputs;
    };
    constexpr std::uint32_t add_identity = 15684; // of Operator
    constexpr std::uint32_t add_endpoint = 16232;
    constexpr std::uint32_t trust_list = 12642;
    constexpr std::uint32_t add_certificate = 12668;
    constexpr std::uint32_t remove_certificate = 12670;
    constexpr Case cases[] = {
        {id::WellKnownRole_Operator, add_identity, 1},
        {id::WellKnownRole_Operator, add_endpoint, 1},
        {id::Server_ServerCapabilities_RoleSet, id::Server_ServerCapabilities_RoleSet_AddRole, 2},
        {id::Server_ServerCapabilities_RoleSet, id::Server_ServerCapabilities_RoleSet_RemoveRole,
         1},
        {id::UserManagement, id::UserManagement_AddUser, 4},
        {id::UserManagement, id::UserManagement_ModifyUser, 7},
        {id::UserManagement, id::UserManagement_RemoveUser, 1},
        {id::UserManagement, id::UserManagement_ChangePassword, 2},
        {id::ServerConfiguration, id::ServerConfiguration_UpdateCertificate, 6},
        {id::ServerConfiguration, id::ServerConfiguration_CreateSigningRequest, 5},
        {trust_list, add_certificate, 2},
        {trust_list, remove_certificate, 2},
    };
    auto admin = log_in();
    const auto files_before = storage.names();
    for (const Case& each : cases) {
        INFO(each.method);
        const auto result = call(admin, NodeId{0, each.object}, NodeId{0, each.method},
                                 std::vector<Variant>(each.inputs));
        CHECK(result.status_code.is_bad());
    }
    CHECK(storage.names() == files_before);
    CHECK(user_list.users().size() == 1);
    CHECK(roles.roles().size() == 9);
    CHECK(roles.find("Operator")->endpoints.empty());
    CHECK_FALSE(admin.is_closed());
}

} // namespace administration_test
