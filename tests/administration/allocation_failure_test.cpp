#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/writer.hpp>
#include <busbar/types/configuration.hpp>

#include "failure_world.hpp"
#include "support/effort.hpp"

namespace allocation_failure_test {

// Each Method of administration, and Writes of its Variables, with the k-th of its allocations
// failing, for k = 1, 2, ... until it goes through. What fails answers Bad_OutOfMemory, or closes
// the connection, and changes nothing: the same Method succeeds at once, and nothing that was
// allocated is left in the end.

using namespace busbar;
using namespace busbar::test;

namespace {

using World = FailureWorld;

/// A Method, or the Write of a Variable; whatever is not set does nothing.
template <typename Request>
struct RowOf {
    std::string name;
    /// What has to be before, and what is asked.
    std::function<Request(World&)> prepare;
    /// Makes things as they were before prepare().
    std::function<void(World&)> restore{[](World&) {}};
    /// Of those allocations that fail, for a Method that makes a key each time.
    std::size_t step{1};
};
using Row = RowOf<CallRequest>;
using WriteRow = RowOf<WriteRequest>;

const Variant no_text{String{}};

Variant text(const char* value)
{
    return Variant{String{value}};
}

ByteString bytes_of(const TrustListDataType& data)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, data);
    return ByteString{sink.take(writer.written())};
}

ByteString trusting_the_client()
{
    TrustListDataType data;
    data.specified_lists = 1;
    data.trusted_certificates.push_back(ByteString{client_identity().certificates.front().der()});
    return bytes_of(data);
}

const crypto::Certificate& stranger()
{
    static const crypto::Certificate certificate = issue({}, key_number(1)).certificate;
    return certificate;
}

/// With its key.
CallRequest updating()
{
    static const channel::ApplicationIdentity next = successor();
    static const auto pem = next.key.to_pem();
    return World::on_server(
        id::ServerConfiguration_UpdateCertificate,
        {Variant{NodeId{}}, Variant{rsa}, Variant{ByteString{next.certificates.front().der()}},
         Variant{Array<ByteString>{}}, text("PEM"), Variant{ByteString{pem->span()}}});
}

void cancel(World& world)
{
    world.may(World::on_server(id::ServerConfiguration_CancelChanges, {}));
}

Variant opened_list(World& world, std::uint8_t mode)
{
    return world.need(World::on_list(open_method, {Variant{mode}}))[0];
}

/// What is open, and the transaction, are over.
void close_lists(World& world)
{
    for (std::uint32_t handle = 1; handle <= 3'000; ++handle) {
        const auto count = World::read(world.root, open_count).value.value_or<std::uint16_t>(0);
        if (count == 0) {
            break;
        }
        world.may(World::on_list(close_method, {Variant{handle}}));
    }
    world.may(World::on_server(id::ServerConfiguration_CancelChanges, {}));
}

CallRequest own_method(std::string_view name, const std::vector<Variant>& inputs)
{
    const std::uint32_t method = name == "GetCertificates"     ? 32333
                                 : name == "DeleteCertificate" ? 19345
                                                               : 19342;
    return World::calling(NodeId{0, id::ServerConfiguration}, NodeId{0, method}, inputs);
}

std::vector<Row> certificate_rows()
{
    const auto slot = std::vector<Variant>{Variant{NodeId{}}, Variant{rsa}};
    return {
        {"UpdateCertificate", [](World&) { return updating(); }, cancel},
        {"ApplyChanges",
         [](World& world) {
             world.need(updating());
             return World::on_server(id::ServerConfiguration_ApplyChanges, {});
         }},
        {"CancelChanges",
         [](World& world) {
             world.need(updating());
             return World::on_server(id::ServerConfiguration_CancelChanges, {});
         }},
        {"CreateSigningRequest",
         [slot](World&) {
             auto inputs = slot;
             inputs.insert(inputs.end(), {no_text, Variant{false}, Variant{ByteString{}}});
             return World::on_server(id::ServerConfiguration_CreateSigningRequest, inputs);
         }},
        {"DeleteCertificate", [slot](World&) { return own_method("DeleteCertificate", slot); },
         cancel},
        {"CreateSelfSignedCertificate",
         [slot](World& world) {
             world.need(own_method("DeleteCertificate", slot));
             auto inputs = slot;
             inputs.insert(inputs.end(), {text("CN=Press 4"), Variant{Array<String>{"plc.example"}},
                                          Variant{Array<String>{}}, Variant{std::uint16_t{0}},
                                          Variant{std::uint16_t{0}}});
             return own_method("CreateSelfSignedCertificate", inputs);
         },
         cancel, 40},
        {"GetCertificates",
         [](World&) { return own_method("GetCertificates", {Variant{NodeId{}}}); }},
        {"GetRejectedList",
         [](World& world) {
             static_cast<void>(
                 world.applications.add(crypto::StoreList::Rejected, stranger().der()));
             return World::on_server(id::ServerConfiguration_GetRejectedList, {});
         }},
        {"RemoveRejectedCertificate",
         [](World& world) {
             static_cast<void>(
                 world.applications.add(crypto::StoreList::Rejected, stranger().der()));
             return World::calling(NodeId{0, id::ServerConfiguration},
                                   NodeId{1, "ServerConfiguration/RemoveRejectedCertificate"},
                                   {text(stranger().thumbprint_text().c_str())});
         }},
    };
}

std::vector<Row> trust_list_rows()
{
    return {
        {"Open of a trust list to read",
         [](World&) { return World::on_list(open_method, {Variant{reading}}); }, close_lists},
        {"Open of a trust list to write",
         [](World&) { return World::on_list(open_method, {Variant{writing}}); }, close_lists},
        {"OpenWithMasks",
         [](World&) { return World::on_list(open_with_masks, {Variant{std::uint32_t{1}}}); },
         close_lists},
        {"Close of a trust list",
         [](World& world) { return World::on_list(close_method, {opened_list(world, reading)}); }},
        {"Read of a trust list",
         [](World& world) {
             return World::on_list(read_method,
                                   {opened_list(world, reading), Variant{std::int32_t{100}}});
         },
         close_lists},
        {"Write of a trust list",
         [](World& world) {
             return World::on_list(write_method,
                                   {opened_list(world, writing), Variant{trusting_the_client()}});
         },
         close_lists},
        {"GetPosition of a trust list",
         [](World& world) { return World::on_list(get_position, {opened_list(world, reading)}); },
         close_lists},
        {"SetPosition of a trust list",
         [](World& world) {
             return World::on_list(set_position,
                                   {opened_list(world, reading), Variant{std::uint64_t{1}}});
         },
         close_lists},
        {"CloseAndUpdate",
         [](World& world) {
             const Variant handle = opened_list(world, writing);
             world.need(World::on_list(write_method, {handle, Variant{trusting_the_client()}}));
             return World::on_list(close_and_update, {handle});
         },
         close_lists},
        {"AddCertificate",
         [](World&) {
             return World::on_list(add_certificate,
                                   {Variant{ByteString{stranger().der()}}, Variant{true}});
         },
         [](World& world) {
             world.need(World::on_list(
                 remove_certificate, {text(stranger().thumbprint_text().c_str()), Variant{true}}));
         }},
        {"RemoveCertificate",
         [](World& world) {
             world.need(World::on_list(add_certificate,
                                       {Variant{ByteString{stranger().der()}}, Variant{true}}));
             return World::on_list(remove_certificate,
                                   {text(stranger().thumbprint_text().c_str()), Variant{true}});
         }},
    };
}

CallRequest adding_user()
{
    return World::on_users(id::UserManagement_AddUser,
                           {text("pat"), text("patience is all"), Variant{std::uint32_t{0}},
                            text("of the night shift")});
}

CallRequest removing_user()
{
    return World::on_users(id::UserManagement_RemoveUser, {text("pat")});
}

CallRequest changing_password(const char* from, const char* to)
{
    return World::on_users(id::UserManagement_ChangePassword, {text(from), text(to)});
}

std::vector<Row> user_rows()
{
    return {
        {"ChangePassword",
         [](World&) { return changing_password(World::password, World::other_password); },
         [](World& world) {
             world.need(changing_password(World::other_password, World::password));
         }},
        {"AddUser", [](World&) { return adding_user(); },
         [](World& world) { world.need(removing_user()); }},
        {"ModifyUser",
         [](World& world) {
             world.need(adding_user());
             return World::on_users(id::UserManagement_ModifyUser,
                                    {text("pat"), Variant{false}, no_text, Variant{true},
                                     Variant{administration::user_bit::disabled}, Variant{true},
                                     text("of the day shift")});
         },
         [](World& world) { world.need(removing_user()); }},
        {"RemoveUser",
         [](World& world) {
             world.need(adding_user());
             return removing_user();
         }},
    };
}

CallRequest adding_role()
{
    return World::on_roles(id::Server_ServerCapabilities_RoleSet_AddRole,
                           {text("Fitter of pipes and tubes"), no_text});
}

CallRequest removing_role()
{
    return World::on_roles(id::Server_ServerCapabilities_RoleSet_RemoveRole,
                           {Variant{NodeId{1, "RoleSet//Fitter of pipes and tubes"}}});
}

CallRequest with_rule(std::uint32_t method)
{
    const IdentityMappingRuleType rule{IdentityCriteriaType::UserName,
                                       String{"somebody with a long name"}};
    return World::calling(NodeId{0, id::WellKnownRole_Operator}, NodeId{0, method},
                          {Variant{ExtensionObject::from(IdentityMappingRuleType{rule})}});
}

CallRequest with_application(std::uint32_t method)
{
    return World::calling(NodeId{0, id::WellKnownRole_Operator}, NodeId{0, method},
                          {text("urn:example:an application with a long name")});
}

CallRequest with_endpoint(std::uint32_t method)
{
    EndpointType endpoint;
    endpoint.endpoint_url = "opc.tcp://an-endpoint-with-a-long-name.example:4840";
    return World::calling(NodeId{0, id::WellKnownRole_Operator}, NodeId{0, method},
                          {Variant{ExtensionObject::from(std::move(endpoint))}});
}

std::vector<Row> role_rows()
{
    // Of Operator.
    constexpr std::uint32_t add_identity = 15684;
    constexpr std::uint32_t remove_identity = 15686;
    constexpr std::uint32_t add_application = 16228;
    constexpr std::uint32_t remove_application = 16230;
    constexpr std::uint32_t add_endpoint = 16232;
    constexpr std::uint32_t remove_endpoint = 16234;
    return {
        {"AddRole", [](World&) { return adding_role(); },
         [](World& world) { world.need(removing_role()); }},
        {"RemoveRole",
         [](World& world) {
             world.need(adding_role());
             return removing_role();
         }},
        {"AddIdentity", [](World&) { return with_rule(add_identity); },
         [](World& world) { world.need(with_rule(remove_identity)); }},
        {"RemoveIdentity",
         [](World& world) {
             world.need(with_rule(add_identity));
             return with_rule(remove_identity);
         }},
        {"AddApplication", [](World&) { return with_application(add_application); },
         [](World& world) { world.need(with_application(remove_application)); }},
        {"RemoveApplication",
         [](World& world) {
             world.need(with_application(add_application));
             return with_application(remove_application);
         }},
        {"AddEndpoint", [](World&) { return with_endpoint(add_endpoint); },
         [](World& world) { world.need(with_endpoint(remove_endpoint)); }},
        {"RemoveEndpoint",
         [](World& world) {
             world.need(with_endpoint(add_endpoint));
             return with_endpoint(remove_endpoint);
         }},
    };
}

Variant opened_file(World& world, std::uint8_t mode)
{
    return world.need(World::on_file("a", "Open", {Variant{mode}}))[0];
}

void need_file(World& world)
{
    world.need(World::on_folder("CreateFile", {text("a"), Variant{false}}));
}

void remove_files(World& world)
{
    for (std::uint32_t handle = 1; handle <= 3'000; ++handle) {
        const auto sent = World::on_folder("Delete", {Variant{World::file("a")}});
        world.may(sent);
        if (!world.file_storage.entry("a")) {
            break;
        }
        world.may(World::on_file("a", "Close", {Variant{handle}}));
    }
    if (world.file_storage.entry("b")) {
        world.need(World::on_folder("Delete", {Variant{World::file("b")}}));
    }
}

std::vector<Row> file_rows()
{
    const auto with_open = [](std::uint8_t mode, const char* method, std::vector<Variant> more) {
        return [=](World& world) {
            need_file(world);
            std::vector<Variant> inputs{opened_file(world, mode)};
            inputs.insert(inputs.end(), more.begin(), more.end());
            return World::on_file("a", method, inputs);
        };
    };
    const Variant some{ByteString{std::vector<std::byte>(100)}};
    return {
        {"CreateFile",
         [](World&) {
             return World::on_folder("CreateFile", {text("a"), Variant{false}});
         },
         remove_files},
        {"CreateFile that opens it",
         [](World&) {
             return World::on_folder("CreateFile", {text("a"), Variant{true}});
         },
         remove_files},
        {"CreateDirectory", [](World&) { return World::on_folder("CreateDirectory", {text("a")}); },
         remove_files},
        {"Delete of a file",
         [](World& world) {
             need_file(world);
             return World::on_folder("Delete", {Variant{World::file("a")}});
         }},
        {"MoveOrCopy that moves",
         [](World& world) {
             need_file(world);
             return World::on_folder(
                 "MoveOrCopy",
                 {Variant{World::file("a")}, Variant{World::file("")}, Variant{false}, text("b")});
         },
         remove_files},
        {"MoveOrCopy that copies",
         [](World& world) {
             need_file(world);
             return World::on_folder(
                 "MoveOrCopy",
                 {Variant{World::file("a")}, Variant{World::file("")}, Variant{true}, text("b")});
         },
         remove_files},
        {"Open of a file",
         [](World& world) {
             need_file(world);
             return World::on_file("a", "Open", {Variant{reading}});
         },
         remove_files},
        {"Open of a file to write",
         [](World& world) {
             need_file(world);
             return World::on_file("a", "Open", {Variant{writing}});
         },
         remove_files},
        {"Close of a file that was written",
         [=](World& world) {
             need_file(world);
             const Variant handle = opened_file(world, writing);
             world.need(World::on_file("a", "Write", {handle, some}));
             return World::on_file("a", "Close", {handle});
         },
         remove_files},
        {"Read of a file", with_open(reading, "Read", {Variant{std::int32_t{10}}}), remove_files},
        {"Write of a file", with_open(writing, "Write", {some}), remove_files},
        {"GetPosition of a file", with_open(reading, "GetPosition", {}), remove_files},
        {"SetPosition of a file", with_open(reading, "SetPosition", {Variant{std::uint64_t{0}}}),
         remove_files},
    };
}

const NodeId transfer_root{1, "Transfers/backup"};

struct Transferred {
    NodeId node;
    Variant handle;
};

Transferred transferred(World& world, const char* method)
{
    const auto outputs = world.need(World::on_transfer(transfer_root, method, {Variant{}}));
    return {*outputs[0].get_if<NodeId>(), outputs[1]};
}

/// They are over with their time.
void end_transfers(World& world)
{
    world.advance(world.transfer.client_processing_timeout);
    world.root.channel.handle_deadline(world.now);
    world.root.run();
    world.may(World::on_transfer(transfer_root, "CloseAndCommit", {Variant{std::uint32_t{0}}}));
}

std::vector<Row> transfer_rows()
{
    const auto with_file = [](const char* made_by, const char* method, std::vector<Variant> more) {
        return [=](World& world) {
            const Transferred file = transferred(world, made_by);
            std::vector<Variant> inputs{file.handle};
            inputs.insert(inputs.end(), more.begin(), more.end());
            return World::on_transfer(file.node, method, inputs);
        };
    };
    constexpr const char* to_read = "GenerateFileForRead";
    constexpr const char* to_write = "GenerateFileForWrite";
    return {
        {to_read, [=](World&) { return World::on_transfer(transfer_root, to_read, {Variant{}}); },
         end_transfers},
        {to_write, [=](World&) { return World::on_transfer(transfer_root, to_write, {Variant{}}); },
         end_transfers},
        {"CloseAndCommit",
         [=](World& world) {
             const Transferred file = transferred(world, to_write);
             return World::on_transfer(transfer_root, "CloseAndCommit", {file.handle});
         },
         end_transfers},
        {"Read of a temporary file", with_file(to_read, "Read", {Variant{std::int32_t{10}}}),
         end_transfers},
        {"Write of a temporary file",
         with_file(to_write, "Write", {Variant{ByteString{std::vector<std::byte>(100)}}}),
         end_transfers},
        {"GetPosition of a temporary file", with_file(to_read, "GetPosition", {}), end_transfers},
        {"SetPosition of a temporary file",
         with_file(to_read, "SetPosition", {Variant{std::uint64_t{0}}}), end_transfers},
        {"Close of a temporary file", with_file(to_read, "Close", {}), end_transfers},
    };
}

CallRequest changing_state(ServerState state)
{
    return World::calling(
        NodeId{0, id::Server}, NodeId{0, id::Server_RequestServerStateChange},
        {Variant{static_cast<std::int32_t>(state)}, Variant{DateTime{}}, Variant{std::uint32_t{0}},
         Variant{LocalizedText{"en", "because somebody works at it"}}, Variant{false}});
}

CallRequest setting(std::int64_t sessions)
{
    const NodeId root{1, "Settings"};
    return World::calling(
        root, NodeId{1, "Settings.Set"},
        {Variant{Array<String>{"limits.sessions"}}, Variant{Array<Variant>{Variant{sessions}}}});
}

std::vector<Row> server_rows()
{
    return {
        {"RequestServerStateChange", [](World&) { return changing_state(ServerState::Suspended); },
         [](World& world) { world.need(changing_state(ServerState::Running)); }},
        {"Set of settings", [](World&) { return setting(7); },
         [](World& world) { world.need(setting(100)); }},
    };
}

std::vector<WriteRow> write_rows()
{
    const NodeId sessions{1, "Settings.limits.sessions"};
    const NodeId names{1, "Settings.server.host_names"};
    const NodeId excludes{0, 15418}; // ApplicationsExclude of Operator
    const auto write = [](const NodeId& variable, const Variant& value) {
        return [=](World&) { return World::writing_to(variable, value); };
    };
    const auto restore = [](const NodeId& variable, const Variant& value) {
        return
            [=](World& world) { CHECK(world.ask(World::writing_to(variable, value)).is_good()); };
    };
    const Variant few{Array<String>{"press-4"}};
    const Variant more{Array<String>{"press-4", "the press of the second hall"}};
    return {
        {"a setting", write(sessions, Variant{std::int64_t{7}}),
         restore(sessions, Variant{std::int64_t{100}})},
        {"a setting that is a list", write(names, more), restore(names, few)},
        {"a rule of a role", write(excludes, Variant{true}), restore(excludes, Variant{false})},
    };
}

/// False if the Method went through without a failure.
template <typename Request>
bool fail_once(World& world, const RowOf<Request>& row, std::size_t k)
{
    const Request asked = row.prepare(world);
    world.log.text.clear();
    fail_allocation(k);
    const StatusCode answer = world.ask(asked);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO(row.name << ", allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    if (answer != status::Good) {
        CHECK(has_failed);
        CHECK((answer == status::Bad_OutOfMemory || world.root.is_closed()));
        if (world.root.is_closed()) {
            world.connect_again();
        }
        // A Method that was done before its answer was lost with the connection may say so.
        const StatusCode second = world.ask(asked);
        INFO("then " << name(second));
        CHECK((second == status::Good || answer == status::Bad_ConnectionClosed));
    }
    row.restore(world);
    return has_failed;
}

/// How many allocations failed of the first `most`: each one, or every seventh unless the effort is
/// full.
template <typename Request>
std::size_t fail_each(const RowOf<Request>& row, ManualWorker* worker, std::size_t most)
{
    World world{worker};
    const std::size_t step = is_full_effort() ? row.step : std::max<std::size_t>(row.step, 7);
    std::size_t count = 0;
    for (std::size_t k = 1; k <= most && fail_once(world, row, k); k += step) {
        ++count;
    }
    return count;
}

template <typename Request>
void check(const std::vector<RowOf<Request>>& rows, ManualWorker* worker = nullptr)
{
    for (const RowOf<Request>& row : rows) {
        DYNAMIC_SECTION(row.name)
        {
            static_cast<void>(fail_each(row, worker, 1)); // makes what lasts as long as the program
            const std::size_t before = live_allocations();
            CHECK(fail_each(row, worker, 100'000) > 1);
            CHECK(live_allocations() == before);
        }
    }
}

} // namespace

TEST_CASE("administration: an allocation that fails ends one Method of certificates")
{
    check(certificate_rows());
}

TEST_CASE("administration: an allocation that fails ends one Method of trust lists")
{
    check(trust_list_rows());
}

TEST_CASE("administration: an allocation that fails ends one Method of users")
{
    check(user_rows());
}

TEST_CASE("administration: an allocation that fails ends one Method of users with a worker")
{
    ManualWorker worker;
    check(user_rows(), &worker);
}

TEST_CASE("administration: an allocation that fails ends one Method of keys with a worker")
{
    ManualWorker worker;
    std::vector<Row> rows;
    for (Row& row : certificate_rows()) {
        if (row.name.starts_with("Create")) {
            rows.push_back(std::move(row));
        }
    }
    check(rows, &worker);
}

TEST_CASE("administration: an allocation that fails ends one Method of roles")
{
    check(role_rows());
}

TEST_CASE("administration: an allocation that fails ends one Method of files")
{
    check(file_rows());
}

TEST_CASE("administration: an allocation that fails ends one Method of temporary files")
{
    check(transfer_rows());
}

TEST_CASE("administration: an allocation that fails ends one Method of the server")
{
    check(server_rows());
}

TEST_CASE("administration: an allocation that fails ends one Write")
{
    check(write_rows());
}

} // namespace allocation_failure_test
