#include <busbar/administration/administration.hpp>

#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/administration/role_set_nodes/nodes.hpp>
#include <busbar/harness/catch.hpp>
#include <busbar/storage/memory_storage.hpp>
#include <busbar/types/ids.hpp>

#include "support/server_fixture.hpp"

namespace role_set_test {

using namespace busbar;
using namespace busbar::test;
using harness::BenchClient;

namespace {

constexpr std::uint32_t add_identity = 15684; // of Operator
constexpr std::uint32_t remove_identity = 15686;
constexpr std::uint32_t identities = 16225;
constexpr std::uint32_t applications_exclude = 15418;
constexpr std::uint32_t add_application = 16228;

IdentityMappingRuleType user_rule(const char* name)
{
    return {IdentityCriteriaType::UserName, String{name}};
}

/// The objects that outlive the server.
struct Parts {
    Parts() { REQUIRE(roles.load()); }
    [[nodiscard]] harness::BenchOptions options()
    {
        harness::BenchOptions options;
        options.server = harness::secured_server_config();
        options.server_parts.roles = &roles;
        options.server_parts.log = &log;
        return options;
    }

    harness::World virtual_world;
    LogBook log;
    storage::MemoryStorage storage;
    administration::RoleList roles{storage, "roles.json"};
    int changes{0};
    administration::Administration administration{
        {.wall_clock = &virtual_world.clock(), .log = &log, .roles = &roles, .changed = [this] {
             ++changes;
         }}};
};

/// A server whose roles are managed.
struct Fixture : Parts, harness::Bench {
    Fixture() : Bench{virtual_world, options()}
    {
        users().add("admin", "secret", {0xFF, {"ConfigureAdmin", "SecurityAdmin"}});
        users().add("pat", "secret");
        REQUIRE(administration.attach(server()));
    }
    [[nodiscard]] BenchClient&
    log_in(const char* name, MessageSecurityMode mode = MessageSecurityMode::SignAndEncrypt)
    {
        return Bench::log_in(client::NamedUser{name, "secret"}, setting("Basic256Sha256", mode));
    }
    static CallMethodResult call(BenchClient& client, const NodeId& object, const NodeId& method,
                                 Array<Variant> inputs)
    {
        return harness::need(client.call(object, method, std::move(inputs)));
    }
    static std::string_view call_operator(BenchClient& client, std::uint32_t method, Variant input)
    {
        return name(call(client, NodeId{0, id::WellKnownRole_Operator}, NodeId{0, method},
                         {std::move(input)})
                        .status_code);
    }
    static Variant structure(const IdentityMappingRuleType& rule)
    {
        return Variant{ExtensionObject{rule}};
    }
    /// Null if there is none.
    [[nodiscard]] NodeId child(std::uint32_t parent, std::string_view name)
    {
        const model::AddressSpace& space = server().address_space();
        NodeId found;
        static_cast<void>(space.for_each_child(space.find(parent), space.find(id::Aggregates), true,
                                               QualifiedName{0, String{name}},
                                               [&](model::NodeIndex node) {
                                                   found = space.node_id(node);
                                                   return false;
                                               }));
        return found;
    }
    [[nodiscard]] std::vector<IdentityCriteriaType> criteria_of(BenchClient& client,
                                                                std::uint32_t role)
    {
        std::vector<IdentityCriteriaType> criteria;
        const DataValue listed = client.read(child(role, "Identities"));
        const auto* const objects = listed.value.array_if<ExtensionObject>();
        REQUIRE(objects != nullptr);
        for (const ExtensionObject& object : *objects) {
            criteria.push_back(object.get_if<IdentityMappingRuleType>()->criteria_type);
        }
        return criteria;
    }
};

} // namespace

TEST_CASE_METHOD(Fixture, "role set: a rule gives a role at once, and is told",
                 "[unit:Security Role Server IdentityManagement]")
{
    auto& admin = log_in("admin"); // SecurityAdmin
    auto& pat = log_in("pat");
    log.keeps_records = true;
    CHECK(call_operator(admin, add_identity, structure(user_rule("pat"))) == "Good");
    REQUIRE(log.records.size() >= 1);
    CHECK(log.records[0] == "RolesChanged Good /admin 192.0.2.2 ObjectId MethodId");
    CHECK(log.text.find("RolesChanged by user \"admin\" from 192.0.2.2") != std::string::npos);
    const DataValue listed = admin.read(NodeId{0, identities});
    const auto* const objects = listed.value.array_if<ExtensionObject>();
    REQUIRE(objects != nullptr);
    REQUIRE(objects->size() == 1);
    CHECK(*(*objects)[0].get_if<IdentityMappingRuleType>() == user_rule("pat"));
    CHECK(roles.find("Operator")->identities.size() == 1);
    // Of a session that was there before.
    REQUIRE(roles.add_identity("SecurityAdmin", user_rule("pat")));
    CHECK(pat.read(NodeId{0, identities}).status != status::Good);
    CHECK(call_operator(admin, remove_identity, structure(user_rule("pat"))) == "Good");
    CHECK(pat.read(NodeId{0, identities}).status == status::Good);
    CHECK(call_operator(admin, remove_identity, structure(user_rule("pat"))) == "Bad_NotFound");
    CHECK(log.text.find("has no such rule") != std::string::npos);
}

TEST_CASE_METHOD(Fixture, "role set: the well-known roles have their nodes (Part 18, 4.3)",
                 "[unit:Base Info Security Role Capabilities]"
                 "[unit:Security Role TrustedApplication]"
                 "[unit:Security Role Well Known Group 2]"
                 "[unit:Security Role Well Known Group 3]")
{
    using Criteria = IdentityCriteriaType;
    using All = std::vector<Criteria>;
    auto& admin = log_in("admin");
    const model::AddressSpace& space = server().address_space();
    const auto type_of = [&](std::uint32_t node) {
        return space.node_id(space.type_definition(space.find(node)));
    };
    constexpr std::uint32_t set = id::Server_ServerCapabilities_RoleSet;
    CHECK(child(id::Server_ServerCapabilities, "RoleSet") == NodeId{0, set});
    CHECK(type_of(set) == NodeId{0, id::RoleSetType});
    const std::pair<const char*, std::uint32_t> fixed[] = {
        {"Anonymous", id::WellKnownRole_Anonymous},
        {"AuthenticatedUser", id::WellKnownRole_AuthenticatedUser},
        {"TrustedApplication", id::WellKnownRole_TrustedApplication}};
    for (const auto& [role, node] : fixed) {
        INFO(role);
        CHECK(child(set, role) == NodeId{0, node});
        CHECK(type_of(node) == NodeId{0, id::RoleType});
        CHECK(child(node, "AddIdentity").is_null());
    }
    CHECK(criteria_of(admin, id::WellKnownRole_Anonymous) ==
          All{Criteria::Anonymous, Criteria::AuthenticatedUser});
    CHECK(criteria_of(admin, id::WellKnownRole_AuthenticatedUser) ==
          All{Criteria::AuthenticatedUser});
    CHECK(criteria_of(admin, id::WellKnownRole_TrustedApplication) ==
          All{Criteria::TrustedApplication});
    const std::pair<const char*, std::uint32_t> open[] = {
        {"Observer", id::WellKnownRole_Observer},
        {"Operator", id::WellKnownRole_Operator},
        {"Engineer", id::WellKnownRole_Engineer},
        {"Supervisor", id::WellKnownRole_Supervisor}};
    for (const auto& [role, node] : open) {
        INFO(role);
        CHECK(child(set, role) == NodeId{0, node});
        CHECK(type_of(node) == NodeId{0, id::RoleType});
        CHECK(criteria_of(admin, node).empty());
        CHECK(
            call(admin, NodeId{0, node}, child(node, "AddIdentity"), {structure(user_rule("pat"))})
                .status_code == status::Good);
        CHECK(criteria_of(admin, node) == All{Criteria::UserName});
    }
}

TEST_CASE_METHOD(Fixture, "role set: for SecurityAdmin over an encrypted channel only")
{
    auto& pat = log_in("pat");
    CHECK(call_operator(pat, add_identity, structure(user_rule("pat"))) != "Good");
    CHECK(pat.read(NodeId{0, identities}).status != status::Good);
    auto& weak = log_in("admin", MessageSecurityMode::Sign);
    CHECK(call_operator(weak, add_identity, structure(user_rule("pat"))) ==
          "Bad_SecurityModeInsufficient");
    CHECK(weak.read(NodeId{0, identities}).status == status::Bad_SecurityModeInsufficient);
    CHECK(roles.find("Operator")->identities.empty());
    const NodeId set{0, id::Server_ServerCapabilities_RoleSet};
    CHECK(name(call(weak, set, NodeId{0, id::Server_ServerCapabilities_RoleSet_AddRole},
                    {Variant{String{"Fitter"}}, Variant{String{}}})
                   .status_code) == "Bad_SecurityModeInsufficient");
    CHECK(name(call(weak, set, NodeId{0, id::Server_ServerCapabilities_RoleSet_RemoveRole},
                    {Variant{NodeId{0, id::WellKnownRole_Operator}}})
                   .status_code) == "Bad_SecurityModeInsufficient");
    CHECK(
        weak.read(NodeId{0, id::Server_ServerCapabilities_RoleSet_AddRole_InputArguments}).status ==
        status::Bad_SecurityModeInsufficient);
    CHECK(roles.find("Fitter") == nullptr);
    auto& admin = log_in("admin");
    CHECK(admin.read(NodeId{0, identities}).status == status::Good);
    CHECK(call_operator(admin, add_identity, Variant{7}) == "Bad_InvalidArgument");
}

TEST_CASE_METHOD(Fixture, "role set: applications, and who is excluded",
                 "[unit:Security Role Server ApplicationManagement]"
                 "[unit:Security Role Server EndpointManagement]"
                 "[unit:Security Role Server Restrict Endpoints]"
                 "[unit:Security Role Server Restrict Applications]")
{
    auto& admin = log_in("admin");
    CHECK(call_operator(admin, add_application, Variant{String{"urn:a"}}) == "Good");
    CHECK(call_operator(admin, add_application, Variant{String{"urn:a"}}) == "Bad_AlreadyExists");
    CHECK(admin.read(NodeId{0, applications_exclude}).value == Variant{true});
    const int before = changes;
    CHECK(admin.write(NodeId{0, applications_exclude}, Variant{false}) == status::Good);
    CHECK(changes > before);
    CHECK(admin.read(NodeId{0, applications_exclude}).value == Variant{false});
    CHECK_FALSE(roles.find("Operator")->applications_exclude);
    constexpr std::uint32_t add_endpoint = 16232;
    constexpr std::uint32_t endpoints = 16227;
    EndpointType endpoint;
    endpoint.security_mode = MessageSecurityMode::Sign;
    CHECK(call_operator(admin, add_endpoint, Variant{ExtensionObject{endpoint}}) == "Good");
    CHECK(admin.read(NodeId{0, endpoints}).value.array_if<ExtensionObject>()->size() == 1);
    constexpr std::uint32_t endpoints_exclude = 15423;
    CHECK(admin.read(NodeId{0, endpoints_exclude}).value == Variant{true});
    CHECK(admin.write(NodeId{0, endpoints_exclude}, Variant{false}) == status::Good);
    CHECK(admin.read(NodeId{0, endpoints_exclude}).value == Variant{false});
    CHECK_FALSE(roles.find("Operator")->endpoints_exclude);
    CHECK(admin.write(NodeId{0, identities}, Variant{Array<ExtensionObject>{}}) ==
          status::Bad_NotWritable);
}

TEST_CASE_METHOD(Fixture, "role set: own roles have nodes like the others",
                 "[unit:Security Role Server Management]")
{
    auto& admin = log_in("admin");
    const NodeId set{0, id::Server_ServerCapabilities_RoleSet};
    const NodeId add{0, id::Server_ServerCapabilities_RoleSet_AddRole};
    const NodeId remove{0, id::Server_ServerCapabilities_RoleSet_RemoveRole};
    const auto made = call(admin, set, add, {Variant{String{"Fitter"}}, Variant{String{}}});
    REQUIRE(made.status_code == status::Good);
    const NodeId role = *made.output_arguments[0].get_if<NodeId>();
    CHECK(role == NodeId{1, "RoleSet//Fitter"});
    const NodeId add_rule{1, "RoleSet//Fitter/AddIdentity"};
    CHECK(name(call(admin, role, add_rule, {structure(user_rule("pat"))}).status_code) == "Good");
    CHECK(roles.find("Fitter")->identities.size() == 1);
    CHECK(admin.read(NodeId{1, "RoleSet//Fitter/Identities"})
              .value.array_if<ExtensionObject>()
              ->size() == 1);
    CHECK(admin.read(NodeId{1, "RoleSet//Fitter/EndpointsExclude"}).value == Variant{true});
    auto& pat = log_in("pat");
    CHECK(call(pat, role, add_rule, {structure(user_rule("sam"))}).status_code.is_bad());
    CHECK(pat.read(NodeId{1, "RoleSet//Fitter/Identities"}).status.is_bad());

    CHECK(call(admin, set, add, {Variant{String{"Fitter"}}, Variant{String{}}}).status_code ==
          status::Bad_AlreadyExists);
    CHECK(call(admin, set, add, {Variant{String{"Welder"}}, Variant{String{"urn:unknown"}}})
              .status_code == status::Bad_InvalidArgument);
    CHECK(log.text.find("urn:unknown") != std::string::npos);
    CHECK(call(admin, set, remove, {Variant{NodeId{0, id::WellKnownRole_Operator}}}).status_code ==
          status::Bad_RequestNotAllowed);
    log.text.clear();
    for (const NodeId& none :
         {NodeId{1, "RoleSet//Nobody"}, NodeId{0, id::Server}, NodeId{}}) { // Part 18, 4.2.3
        CHECK(name(call(admin, set, remove, {Variant{none}}).status_code) == "Bad_NodeIdUnknown");
    }
    CHECK(log.text.find("is not a role of this server") != std::string::npos);
    CHECK(call(admin, set, remove, {Variant{role}}).status_code == status::Good);
    CHECK(admin.read(NodeId{1, "RoleSet//Fitter/Identities"}).status == status::Bad_NodeIdUnknown);
    CHECK(roles.find("Fitter") == nullptr);
}

TEST_CASE_METHOD(Fixture, "role set: whatever is added has something behind it")
{
    const auto& space = server().address_space();
    std::size_t count = 0;
    for (const model::StaticNode& each : administration::role_set_nodes::nodes().nodes) {
        const model::NodeIndex node = space.find(NodeId{0, each.id.value});
        REQUIRE(node != model::no_node);
        const std::string browse_name = space.browse_name(node).name.str();
        INFO(browse_name << " i=" << each.id.value);
        if (browse_name == "InputArguments" || browse_name == "OutputArguments") {
            CHECK_FALSE(space.value(node).is_null());
        } else if (space.node_class(node) == NodeClass::Method) {
            CHECK(space.method(node).source != model::no_source);
            ++count;
        } else {
            CHECK(space.variable(node).source != model::no_source);
            ++count;
        }
    }
    CHECK(count == 77);
}

TEST_CASE_METHOD(Fixture, "role set: a medium that fails changes nothing")
{
    auto& admin = log_in("admin");
    storage.set_protected(true);
    CHECK(call_operator(admin, add_identity, structure(user_rule("pat"))) ==
          "Bad_ResourceUnavailable");
    CHECK(roles.find("Operator")->identities.empty());
    const NodeId set{0, id::Server_ServerCapabilities_RoleSet};
    CHECK(call(admin, set, NodeId{0, id::Server_ServerCapabilities_RoleSet_AddRole},
               {Variant{String{"Fitter"}}, Variant{String{}}})
              .status_code == status::Bad_ResourceUnavailable);
    CHECK(admin.read(NodeId{1, "RoleSet//Fitter/Identities"}).status == status::Bad_NodeIdUnknown);
}

TEST_CASE("role set: own roles of the file have nodes, and a server without the list has none")
{
    Parts first;
    REQUIRE(first.roles.add("Fitter", "http://opcfoundation.org/UA/DI/"));
    administration::RoleList roles{first.storage, "roles.json"};
    REQUIRE(roles.load());
    const WallClock& clock = first.virtual_world.clock();
    administration::Administration with{{.wall_clock = &clock, .log = &first.log, .roles = &roles}};
    administration::Administration without{{.wall_clock = &clock, .log = &first.log}};
    harness::Bench one{first.options()};
    REQUIRE(with.attach(one.server()));
    harness::Bench other{first.options()};
    REQUIRE(without.attach(other.server()));
    const NodeId node{1, "RoleSet/http://opcfoundation.org/UA/DI//Fitter"};
    CHECK(one.server().address_space().find(node) != model::no_node);
    CHECK(one.server().address_space().find(add_identity) != model::no_node);
    CHECK(other.server().address_space().find(add_identity) == model::no_node);
}

TEST_CASE_METHOD(Fixture, "role set: applications and endpoints are taken back, once")
{
    constexpr std::uint32_t remove_application = 16230;
    constexpr std::uint32_t applications = 16226;
    constexpr std::uint32_t add_endpoint = 16232;
    constexpr std::uint32_t remove_endpoint = 16234;
    auto& admin = log_in("admin");
    EndpointType endpoint;
    endpoint.endpoint_url = "opc.tcp://plc:4840";
    const Variant structure{ExtensionObject{endpoint}};
    const Variant uri{String{"urn:a"}};
    CHECK(call_operator(admin, remove_application, uri) == "Bad_NotFound");
    CHECK(call_operator(admin, remove_endpoint, structure) == "Bad_NotFound");
    REQUIRE(call_operator(admin, add_application, uri) == "Good");
    REQUIRE(call_operator(admin, add_endpoint, structure) == "Good");
    CHECK(call_operator(admin, add_endpoint, structure) == "Bad_AlreadyExists");
    CHECK(call_operator(admin, add_application, Variant{String{}}) == "Bad_InvalidArgument");
    CHECK(admin.read(NodeId{0, applications}).value == Variant{Array<String>{"urn:a"}});
    CHECK(call_operator(admin, remove_application, uri) == "Good");
    CHECK(admin.read(NodeId{0, applications}).value.array_size() == 0);
    CHECK(call_operator(admin, remove_endpoint, structure) == "Good");
    CHECK(roles.find("Operator")->applications.empty());
    CHECK(roles.find("Operator")->endpoints.empty());
    CHECK(call_operator(admin, remove_endpoint, structure) == "Bad_NotFound");
}

TEST_CASE_METHOD(Fixture, "role set: who is excluded stays, where the medium or the role says so")
{
    constexpr std::uint32_t of_anonymous = 15412; // ApplicationsExclude
    auto& admin = log_in("admin");
    storage.set_protected(true);
    CHECK(admin.write(NodeId{0, applications_exclude}, Variant{false}) ==
          status::Bad_ResourceUnavailable);
    storage.set_protected(false);
    CHECK(admin.read(NodeId{0, applications_exclude}).value == Variant{true});
    CHECK(roles.find("Operator")->applications_exclude);
    CHECK(admin.write(NodeId{0, of_anonymous}, Variant{false}).is_bad());
    CHECK(roles.find("Anonymous")->applications_exclude);
    auto& pat = log_in("pat");
    CHECK(pat.write(NodeId{0, applications_exclude}, Variant{false}).is_bad());
}

TEST_CASE_METHOD(Fixture, "role set: a role whose node is taken is not kept")
{
    auto& admin = log_in("admin");
    model::AddressSpace& space = server().address_space();
    model::NewNode node;
    node.id = NodeId{1, "RoleSet//Fitter"};
    node.browse_name = QualifiedName{1, "taken"};
    node.parent = space.find(id::ObjectsFolder);
    REQUIRE(space.add_folder(node));
    const NodeId set{0, id::Server_ServerCapabilities_RoleSet};
    const NodeId add{0, id::Server_ServerCapabilities_RoleSet_AddRole};
    CHECK(
        call(admin, set, add, {Variant{String{"Fitter"}}, Variant{String{}}}).status_code.is_bad());
    CHECK(roles.find("Fitter") == nullptr);
    // A namespace that the server has is a part of the role's name.
    const char* const uri = "http://opcfoundation.org/UA/";
    const auto made = call(admin, set, add, {Variant{String{"Fitter"}}, Variant{String{uri}}});
    REQUIRE(made.status_code == status::Good);
    CHECK(made.output_arguments[0] ==
          Variant{NodeId{1, String{"RoleSet/" + std::string{uri} + "/Fitter"}}});
}

TEST_CASE_METHOD(Fixture, "role set: one Call that removes a role twice removes it once")
{
    auto& admin = log_in("admin");
    REQUIRE(roles.add("Welder", ""));
    const NodeId set{0, id::Server_ServerCapabilities_RoleSet};
    const NodeId remove{0, id::Server_ServerCapabilities_RoleSet_RemoveRole};
    // A role that only the program added has no node yet, and no client names it.
    CHECK(call(admin, set, remove, {Variant{NodeId{1, "RoleSet//Welder"}}}).status_code ==
          status::Bad_NodeIdUnknown);
    CHECK(roles.find("Welder") != nullptr);
    REQUIRE(call(admin, set, NodeId{0, id::Server_ServerCapabilities_RoleSet_AddRole},
                 {Variant{String{"Fitter"}}, Variant{String{}}})
                .status_code == status::Good);
    CallRequest request;
    request.methods_to_call.resize(2);
    for (CallMethodRequest& one : request.methods_to_call) {
        one.object_id = set;
        one.method_id = remove;
        one.input_arguments = {Variant{NodeId{1, "RoleSet//Fitter"}}};
    }
    const auto response = admin.call<CallResponse>(request);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Good");
    CHECK(name(response->results[1].status_code) == "Bad_NodeIdUnknown");
    CHECK(roles.find("Fitter") == nullptr);
    CHECK(server().address_space().find(NodeId{1, "RoleSet//Fitter"}) == model::no_node);
}

} // namespace role_set_test
