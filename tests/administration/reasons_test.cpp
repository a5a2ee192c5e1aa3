#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/types/enumerations.hpp>

#include "configuration_fixture.hpp"
#include "server/session/return_diagnostics.hpp"
#include "trust_list_ids.hpp"

namespace reasons_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::uint32_t additional_info = 0x80;

/// Clients who ask why (Part 4, 7.12).
struct Reasons : Configuration {
    using Configuration::Configuration;

    /// What a Call of this Method, with one of the server's own before it, is told of it.
    std::string reason(TestClient& client, const NodeId& object, const NodeId& method,
                       std::vector<Variant> inputs, std::uint32_t wanted = additional_info)
    {
        CallRequest request;
        request.request_header.return_diagnostics = wanted;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = object;
        request.methods_to_call[0].method_id = method;
        request.methods_to_call[0].input_arguments = Array<Variant>{inputs};
        const auto sent = client.send(request);
        complete();
        const auto response = client.take<CallResponse>(sent);
        REQUIRE(response);
        REQUIRE(response->results[0].status_code.is_bad());
        if (response->diagnostic_infos.empty()) {
            return "nothing";
        }
        const auto& info = response->diagnostic_infos[0].additional_info;
        const std::string text = info ? info->str() : std::string{};
        const std::string operand = to_string(method) + " of " + to_string(object);
        if (!text.starts_with(operand)) {
            return text;
        }
        return text == operand ? "only what it is about" : text.substr(operand.size() + 2);
    }
    std::string add_user(TestClient& client, std::string_view name, std::string_view password,
                         std::uint32_t bits = 0, std::uint32_t wanted = additional_info)
    {
        return reason(
            client, NodeId{0, id::UserManagement}, NodeId{0, id::UserManagement_AddUser},
            {Variant{String{name}}, Variant{String{password}}, Variant{bits}, Variant{String{}}},
            wanted);
    }
    std::string on_server_why(TestClient& client, std::uint32_t method, std::vector<Variant> inputs)
    {
        return reason(client, NodeId{0, id::ServerConfiguration}, NodeId{0, method},
                      std::move(inputs));
    }
    std::string self_signed(TestClient& client, const char* subject, std::uint16_t bits = 2'048)
    {
        NodeId method;
        server.address_space().for_each_child(server.address_space().find(id::ServerConfiguration),
                                              server.address_space().find(id::HasComponent), true,
                                              QualifiedName{0, "CreateSelfSignedCertificate"},
                                              [&](model::NodeIndex found) {
                                                  method = server.address_space().node_id(found);
                                                  return false;
                                              });
        return reason(client, NodeId{0, id::ServerConfiguration}, method,
                      {Variant{NodeId{}}, Variant{rsa}, Variant{String{subject}},
                       Variant{Array<String>{}}, Variant{Array<String>{}},
                       Variant{std::uint16_t{30}}, Variant{bits}});
    }
    std::string change_state(TestClient& client, std::int32_t state, std::uint32_t seconds,
                             std::string_view why = "")
    {
        return reason(client, NodeId{0, id::Server}, NodeId{0, id::Server_RequestServerStateChange},
                      {Variant{state}, Variant{DateTime{}}, Variant{seconds},
                       Variant{LocalizedText{"en", String{why}}}, Variant{false}});
    }
    /// Of one Write of these settings: the first one's.
    std::string write(TestClient& client, const char* name, Variant value)
    {
        WriteRequest request;
        request.request_header.return_diagnostics = additional_info;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = NodeId{1, String{"Settings." + std::string{name}}};
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value.value = std::move(value);
        const auto sent = client.send(request);
        complete();
        const auto response = client.take<WriteResponse>(sent);
        REQUIRE(response);
        REQUIRE(response->diagnostic_infos.size() == 1);
        return response->diagnostic_infos[0].additional_info.value_or(String{}).str();
    }
};

bool has(std::string_view text, std::string_view part)
{
    return text.find(part) != std::string_view::npos;
}

} // namespace

TEST_CASE_METHOD(Reasons, "reasons: a user's name, password and configuration")
{
    auto admin = log_in();
    CHECK(add_user(admin, "", "patience is all") ==
          "user name rules: \"\" must have 1 to 64 characters. Choose another one that fits the "
          "rules");
    CHECK(add_user(admin, "pat ", "patience is all") ==
          "user name rules: \"pat \" is not UTF-8, has control characters, or begins or ends with "
          "a space. "
          "Choose another one that fits the rules");
    CHECK(
        add_user(admin, "pat", "short") ==
        "password rules: it must have 12 to 64 characters. Choose another one that fits the rules");
    CHECK(add_user(admin, "admin", "patience is all") ==
          "user list: user \"admin\" already exists");
    CHECK(has(add_user(admin, "pat", "patience is all", 64),
              "unknown bits in its configuration: 64"));
    const NodeId users{0, id::UserManagement};
    CHECK(has(
        reason(admin, users, NodeId{0, id::UserManagement_RemoveUser}, {Variant{String{"admin"}}}),
        "cannot remove themselves"));
    hold = Problem{status::Bad_InvalidState, "users and roles", "cannot change while in RUN"};
    CHECK(add_user(admin, "pat", "patience is all") ==
          "users and roles: cannot change while in RUN");
}

TEST_CASE_METHOD(Reasons, "reasons: certificates, their names and their transactions")
{
    auto admin = log_in();
    CHECK(on_server_why(admin, id::ServerConfiguration_ApplyChanges, {}) ==
          "no changes of certificates or trust lists are waiting to be applied");
    CHECK(on_server_why(admin, id::ServerConfiguration_UpdateCertificate,
                        {Variant{NodeId{}}, Variant{rsa}, Variant{ByteString{}},
                         Variant{Array<ByteString>{}}, Variant{String{}}, Variant{ByteString{}}}) ==
          "own certificate: the certificates cannot be read, expected DER");
    CHECK(has(self_signed(admin, "CN=X"), "must be deleted first"));
    const NodeId list{0, trust_list};
    CHECK(
        has(reason(admin, list, NodeId{0, add_certificate}, {Variant{ByteString{}}, Variant{true}}),
            "cannot be read, expected DER"));
    CHECK(reason(admin, list, NodeId{0, remove_certificate},
                 {Variant{String{"5d0c"}}, Variant{true}}) ==
          "trusted has no certificate with the thumbprint 5D0C");
}

TEST_CASE_METHOD(Reasons, "reasons: a change of the server's state")
{
    auto admin = log_in();
    CHECK(has(change_state(admin, 6, 0), "expected Running, Shutdown, Suspended or Failed"));
    CHECK(change_state(admin, 4, 100'000) ==
          "state of the server: a stop in 100000 seconds, expected at most 86400");
    CHECK(change_state(admin, 4, 5, std::string(300, 'x')) ==
          "state of the server: a reason of 300 bytes, expected at most 256");
}

TEST_CASE_METHOD(Reasons, "reasons: settings that are written")
{
    auto admin = log_in();
    CHECK(write(admin, "limits.sessions", Variant{std::int64_t{0}}) ==
          "ns=1;s=Settings.limits.sessions, attribute 13: limits.sessions: found 0, expected 1 to "
          "1000 (Bad_OutOfRange)");
    owner.refuses_port = true;
    CHECK(has(write(admin, "server.port", Variant{std::int64_t{4'841}}),
              "server.port: cannot change now"));
    // What was not looked at has none.
    CHECK(write(admin, "server.port", Variant{"soon"}) ==
          "ns=1;s=Settings.server.port, attribute 13");
}

TEST_CASE_METHOD(Reasons, "reasons: of a transfer's owner")
{
    auto admin = log_in();
    transfers.why = "it is written in sand";
    const NodeId object{1, "Transfers/backup"};
    auto& space = server.address_space();
    NodeId method;
    space.for_each_child(space.find(object), space.find(id::HasComponent), true,
                         QualifiedName{0, "GenerateFileForWrite"}, [&](model::NodeIndex found) {
                             method = space.node_id(found);
                             return false;
                         });
    const StatusCode given =
        user_list.add({"engineer", {}, 0, {}, {"Engineer"}}, "engineer-secret!", random).has_value()
            ? status::Good
            : status::Bad_InternalError;
    REQUIRE(given.is_good());
    auto engineer = log_in("engineer", "engineer-secret!");
    CHECK(reason(engineer, object, method, {Variant{true}}) == "it is written in sand");
}

TEST_CASE_METHOD(Reasons, "reasons: are for administrators who ask over an encrypted channel")
{
    auto admin = log_in();
    CHECK(add_user(admin, "pat", "short", 0, 0) == "nothing");
    const auto symbolic_id = add_user(admin, "pat", "short", 0, 0x20);
    CHECK(symbolic_id.empty());

    auto is_signed = log_in("admin", "admin-secret!", MessageSecurityMode::Sign);
    CHECK(change_state(is_signed, 4, 100'000) == "only what it is about");

    REQUIRE(user_list.add({"pat", {}, 0, {}, {"Operator"}}, "patience is all", random));
    auto pat = log_in("pat", "patience is all");
    CHECK(reason(pat, NodeId{0, id::UserManagement}, NodeId{0, id::UserManagement_ChangePassword},
                 {Variant{String{"patience is all"}}, Variant{String{"short"}}}) == "nothing");
}

TEST_CASE("reasons: are bounded, each and all")
{
    using server::detail::ReturnDiagnostics;
    ReturnDiagnostics diagnostics{additional_info};
    const std::string long_text(5'000, 'x');
    const auto infos = diagnostics.of_operations(
        1'000, [](std::size_t) { return StatusCode{status::Bad_InvalidArgument}; },
        [&](std::size_t) { return long_text; },
        [&](std::size_t) { return std::string_view{long_text}; });
    std::size_t bytes = 0;
    for (const DiagnosticInfo& info : infos) {
        bytes += info.additional_info ? info.additional_info->size() : 0;
    }
    REQUIRE(infos[0].additional_info);
    CHECK(infos[0].additional_info->size() ==
          ReturnDiagnostics::max_operand + 2 + ReturnDiagnostics::max_reason);
    CHECK(bytes <= ReturnDiagnostics::max_additional_info);
    CHECK(bytes > ReturnDiagnostics::max_additional_info / 2);
}

} // namespace reasons_test
