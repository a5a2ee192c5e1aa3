#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/configuration.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "administration/node_table.hpp"
#include "administration/rights.hpp"
#include "managed_fixture.hpp"

namespace right_matrix_test {

// Every Method and Variable of the administration, for nine identities over three channels: may do
// what the table of rights says, and nothing else. Then each of them for a user who has a role of
// the table and loses it in between.

using namespace busbar;
using namespace busbar::test;
using namespace administration::detail;
using administration::Authorities;

namespace {

/// Where what lies, by the names on the way; the longest that fits counts.
struct Place {
    std::string_view path;
    Thing thing;
};
constexpr std::array places{
    Place{"RequestServerStateChange", Thing::StateChange},
    Place{"ServerDiagnosticsSummary", Thing::ServerStatus},
    Place{"RoleSet", Thing::RoleRules},
    Place{"ServerConfiguration", Thing::ServerFacts},
    Place{"ServerConfiguration/UpdateCertificate", Thing::OwnCertificate},
    Place{"ServerConfiguration/CreateSigningRequest", Thing::OwnCertificate},
    Place{"ServerConfiguration/GetCertificates", Thing::OwnCertificate},
    Place{"ServerConfiguration/CreateSelfSignedCertificate", Thing::OwnCertificate},
    Place{"ServerConfiguration/DeleteCertificate", Thing::OwnCertificate},
    Place{"ServerConfiguration/ApplyChanges", Thing::TransactionEnds},
    Place{"ServerConfiguration/CancelChanges", Thing::TransactionEnds},
    Place{"ServerConfiguration/ResetToServerDefaults", Thing::Reset},
    Place{"ServerConfiguration/GetRejectedList", Thing::TrustLists},
    Place{"ServerConfiguration/RemoveRejectedCertificate", Thing::TrustListChanges},
    Place{"ServerConfiguration/TransactionDiagnostics", Thing::TrustLists},
    Place{"ServerConfiguration/CertificateGroups/", Thing::TrustLists},
    Place{"ServerConfiguration/CertificateGroups/*/TrustList/Write", Thing::TrustListChanges},
    Place{"ServerConfiguration/CertificateGroups/*/TrustList/CloseAndUpdate",
          Thing::TrustListChanges},
    Place{"ServerConfiguration/CertificateGroups/*/TrustList/AddCertificate",
          Thing::TrustListChanges},
    Place{"ServerConfiguration/CertificateGroups/*/TrustList/RemoveCertificate",
          Thing::TrustListChanges},
    Place{"ServerConfiguration/UserManagement", Thing::UserManagement},
    Place{"ServerConfiguration/UserManagement/Users", Thing::Users},
    Place{"ServerConfiguration/UserManagement/AddUser", Thing::Users},
    Place{"ServerConfiguration/UserManagement/ModifyUser", Thing::Users},
    Place{"ServerConfiguration/UserManagement/RemoveUser", Thing::Users},
    Place{"ServerConfiguration/UserManagement/ChangePassword", Thing::OwnPassword},
    Place{"Settings", Thing::Settings},
    Place{"Settings/users/anonymous", Thing::SecuritySettings},
    Place{"Status", Thing::ServiceStatus},
    Place{"recipes", Thing::Files},
    Place{"recipes/CreateDirectory", Thing::FileChanges},
    Place{"recipes/CreateFile", Thing::FileChanges},
    Place{"recipes/Delete", Thing::FileChanges},
    Place{"recipes/MoveOrCopy", Thing::FileChanges},
    Place{"recipes/a/Write", Thing::FileChanges},
    Place{"backup", Thing::Files},
    Place{"backup/GenerateFileForWrite", Thing::FileChanges},
    Place{"backup/CloseAndCommit", Thing::FileChanges},
};

struct Identity {
    const char* role; // null: anonymous, empty: a user without roles
    Roles roles;
};
constexpr std::array identities{
    Identity{nullptr, who::everybody},
    Identity{"", who::everybody},
    Identity{"TrustedApplication", who::everybody},
    Identity{"Observer", who::everybody},
    Identity{"Operator", who::everybody | who::operator_ | who::readers},
    Identity{"Supervisor", who::everybody | who::supervisor},
    Identity{"Engineer", who::everybody | who::engineer | who::writers},
    Identity{"ConfigureAdmin", who::everybody | who::configure_admin},
    Identity{"SecurityAdmin", who::everybody | who::security_admin},
};
constexpr std::array modes{MessageSecurityMode::None, MessageSecurityMode::Sign,
                           MessageSecurityMode::SignAndEncrypt};

struct Node {
    std::string path;
    NodeId id;
    NodeId parent;
    Thing thing;
    Thing thing_of_parent;
    bool is_method;
    bool is_writable;
};

/// "*" in the pattern is one name.
bool fits(std::string_view path, std::string_view pattern)
{
    while (!pattern.empty() && !path.empty()) {
        if (pattern.front() == '*') {
            pattern.remove_prefix(1);
            path.remove_prefix(std::min(path.find('/'), path.size()));
        } else if (pattern.front() == path.front()) {
            pattern.remove_prefix(1);
            path.remove_prefix(1);
        } else {
            return false;
        }
    }
    return pattern.empty();
}

Thing thing_at(std::string_view path)
{
    const Place* best = nullptr;
    for (const Place& each : places) {
        if (fits(path, each.path) && (best == nullptr || each.path.size() > best->path.size())) {
            best = &each;
        }
    }
    INFO(path);
    REQUIRE(best != nullptr);
    return best->thing;
}

struct Matrix : ManagedFixture {
    explicit Matrix(Authorities of = Authorities::Standard) : ManagedFixture{nullptr, of}
    {
        auto config = ServerFixture::insecure_config();
        for (server::EndpointConfig& endpoint : config.endpoints) {
            endpoint.allows_anonymous = true;
        }
        REQUIRE(server::RunningServer{server}.reconfigure(std::move(config)));
        passwords.set_anonymous_access(0xFF);
        const auto hash = crypto::hash_password("x", random, {.log_n = 4});
        for (const Identity& each : identities) {
            if (each.role != nullptr) {
                std::vector<std::string> given;
                if (*each.role != '\0') {
                    given.emplace_back(each.role);
                }
                REQUIRE(passwords.set(user_of(each), *hash, {0xFF, given}));
            }
        }
        REQUIRE(file_storage.make_folder("", FileAccess::Owner));
        REQUIRE(file_storage.replace("a", {}, FileAccess::Owner));
        administration->refresh_files();
        complete();
        auto admin = log_in();
        REQUIRE(call(admin, NodeId{0, id::Server_ServerCapabilities_RoleSet},
                     NodeId{0, id::Server_ServerCapabilities_RoleSet_AddRole},
                     {Variant{String{"Fitter"}}, Variant{String{}}})
                    .status_code == status::Good);
    }
    static std::string user_of(const Identity& identity)
    {
        return "user" + std::string{identity.role};
    }
    [[nodiscard]] TestClient log_in_as(const Identity& identity, MessageSecurityMode mode)
    {
        const bool is_plain = mode == MessageSecurityMode::None;
        TestClient client{server.connect("192.0.2.1", now).value(),
                          is_plain ? channel::SecuritySetting{} : setting("Basic256Sha256", mode),
                          channel::ChannelEnvironment{.random = &random,
                                                      .wall_clock = &wall_clock,
                                                      .log = &log,
                                                      .validator = &any,
                                                      .identity = &client_identity()},
                          now};
        REQUIRE(client.create_session());
        REQUIRE(client.activate(identity.role == nullptr
                                    ? TestClient::anonymous()
                                    : client.user(user_of(identity), "x")) == status::Good);
        return client;
    }
    /// All Methods and Variables below the Objects of the administration.
    [[nodiscard]] std::vector<Node> nodes()
    {
        std::vector<Node> found;
        std::set<model::NodeIndex> seen;
        const auto& space = server.address_space();
        for (const NodeId& root :
             {NodeId{0, id::ServerConfiguration}, NodeId{0, id::Server_ServerCapabilities_RoleSet},
              NodeId{0, id::Server_RequestServerStateChange},
              NodeId{0, id::Server_ServerDiagnostics_ServerDiagnosticsSummary},
              NodeId{1, "Settings"}, NodeId{1, "Status"}, NodeId{1, "Files/recipes"},
              NodeId{1, "Transfers/backup"}}) {
            const model::NodeIndex node = space.find(root);
            REQUIRE(node != model::no_node);
            collect(node, {NodeId{0, id::Server}, Thing::Roles}, space.browse_name(node).name.str(),
                    found, seen);
        }
        return found;
    }

private:
    struct Above {
        NodeId id;
        Thing thing; // Thing::Roles asks for no channel
    };
    void collect(model::NodeIndex node, const Above& above, const std::string& path,
                 std::vector<Node>& found, std::set<model::NodeIndex>& seen)
    {
        const auto& space = server.address_space();
        const NodeClass node_class = space.node_class(node);
        if (!seen.insert(node).second) {
            return;
        }
        const Thing thing = node_class == NodeClass::Object && path.starts_with("RoleSet")
                                ? Thing::Roles
                                : thing_at(path);
        if (node_class != NodeClass::Object) {
            const bool is_writable =
                node_class == NodeClass::Variable &&
                (static_cast<unsigned>(space.variable(node).access_level) & 2U) != 0;
            found.push_back({path, space.node_id(node), above.id, thing, above.thing,
                             node_class == NodeClass::Method, is_writable});
        }
        std::vector<model::NodeIndex> children;
        model::ReferenceCursor cursor = space.references(node);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward &&
                space.is_subtype_of(reference->type, id::HierarchicalReferences) &&
                space.node_class(reference->target) != NodeClass::ObjectType) {
                children.push_back(reference->target);
            }
        }
        for (const model::NodeIndex child : children) {
            const std::string name = space.browse_name(child).name.str();
            if (path != "backup" || name != "files") { // which is for nobody
                collect(child, {space.node_id(node), thing}, path + "/" + name, found, seen);
            }
        }
    }
};

bool is_enough(MessageSecurityMode mode, Thing thing)
{
    constexpr unsigned is_signed = 1;
    constexpr unsigned is_encrypted = 2;
    const unsigned wanted = right_of(thing).channel;
    return ((wanted & is_signed) == 0 || mode != MessageSecurityMode::None) &&
           ((wanted & is_encrypted) == 0 || mode == MessageSecurityMode::SignAndEncrypt);
}

/// What all Variables answer.
std::vector<StatusCode> read_all(TestClient& client, const std::vector<Node>& nodes)
{
    ReadRequest request;
    for (const Node& node : nodes) {
        ReadValueId item;
        item.node_id = node.id;
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        request.nodes_to_read.push_back(item);
    }
    const auto response = client.call<ReadResponse>(request);
    REQUIRE(response);
    std::vector<StatusCode> answers;
    for (const DataValue& each : response->results) {
        answers.push_back(each.status);
    }
    return answers;
}

/// A value that fits none of them, so that nothing is changed.
std::vector<StatusCode> write_all(TestClient& client, const std::vector<Node>& nodes)
{
    WriteRequest request;
    for (const Node& node : nodes) {
        WriteValue item;
        item.node_id = node.id;
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.value.value = Variant{Guid{}};
        request.nodes_to_write.push_back(item);
    }
    const auto response = client.call<WriteResponse>(request);
    REQUIRE(response);
    return {response->results.begin(), response->results.end()};
}

/// With more arguments than any of them has, so that nothing is done.
std::vector<StatusCode> call_all(TestClient& client, const std::vector<Node>& nodes)
{
    CallRequest request;
    for (const Node& node : nodes) {
        CallMethodRequest item;
        item.object_id = node.parent;
        item.method_id = node.id;
        item.input_arguments.resize(20);
        request.methods_to_call.push_back(item);
    }
    const auto response = client.call<CallResponse>(request);
    REQUIRE(response);
    std::vector<StatusCode> answers;
    for (const CallMethodResult& each : response->results) {
        answers.push_back(each.status_code);
    }
    return answers;
}

/// One identity over one channel, with what the server said of each node.
struct Cells {
    const Identity& identity;
    MessageSecurityMode mode;
    Authorities authorities;

    [[nodiscard]] Rights rights(Thing thing) const
    {
        const RightOfThing& right = right_of(thing);
        return authorities == Authorities::FiveLevels ? right.five_levels : right.standard;
    }
    [[nodiscard]] bool has(Roles roles) const { return (roles & identity.roles) != 0; }
    [[nodiscard]] bool sees(const Node& node) const
    {
        return has(rights(node.thing).see | rights(node.thing).call);
    }
    void check_read(const Node& node, StatusCode answer) const
    {
        if (!sees(node)) {
            CHECK(name(answer) == "Bad_NodeIdUnknown");
        } else if (!is_enough(mode, node.thing)) {
            CHECK(name(answer) == "Bad_SecurityModeInsufficient");
        } else { // some have no value now
            CHECK((answer != status::Bad_NodeIdUnknown && answer != status::Bad_UserAccessDenied &&
                   answer != status::Bad_SecurityModeInsufficient));
        }
    }
    void check_write(const Node& node, StatusCode answer) const
    {
        const bool may = node.is_writable && sees(node) && has(rights(node.thing).write) &&
                         is_enough(mode, node.thing);
        CHECK((answer == status::Bad_TypeMismatch) == may);
        CHECK(answer.is_bad());
    }
    void check_call(const Node& node, StatusCode answer) const
    {
        if (!sees(node)) {
            CHECK((answer == status::Bad_NodeIdUnknown || answer == status::Bad_MethodInvalid));
        } else if (!is_enough(mode, node.thing) || !is_enough(mode, node.thing_of_parent)) {
            CHECK(name(answer) == "Bad_SecurityModeInsufficient");
        } else {
            CHECK(name(answer) ==
                  (has(rights(node.thing).call) ? "Bad_TooManyArguments" : "Bad_UserAccessDenied"));
        }
    }
};

std::vector<Node> only(const std::vector<Node>& nodes, bool methods)
{
    std::vector<Node> some;
    std::copy_if(nodes.begin(), nodes.end(), std::back_inserter(some),
                 [&](const Node& node) { return node.is_method == methods; });
    return some;
}

} // namespace

TEST_CASE("right matrix: each identity may what its row says over a channel that is enough",
          "[attack]")
{
    const Authorities authorities = GENERATE(Authorities::Standard, Authorities::FiveLevels);
    Matrix matrix{authorities};
    const std::vector<Node> nodes = matrix.nodes();
    const std::vector<Node> methods = only(nodes, true);
    const std::vector<Node> variables = only(nodes, false);
    CHECK(methods.size() > 90);
    CHECK(variables.size() > 200);
    for (const Identity& identity : identities) {
        for (const MessageSecurityMode mode : modes) {
            auto client = matrix.log_in_as(identity, mode);
            const Cells cells{identity, mode, authorities};
            const auto read = read_all(client, variables);
            const auto written = write_all(client, variables);
            const auto called = call_all(client, methods);
            for (std::size_t i = 0; i < variables.size(); ++i) {
                INFO((identity.role == nullptr ? "anonymous" : identity.role)
                     << ", mode " << static_cast<int>(mode) << ", " << variables[i].path);
                cells.check_read(variables[i], read[i]);
                cells.check_write(variables[i], written[i]);
            }
            for (std::size_t i = 0; i < methods.size(); ++i) {
                INFO((identity.role == nullptr ? "anonymous" : identity.role)
                     << ", mode " << static_cast<int>(mode) << ", " << methods[i].path);
                cells.check_call(methods[i], called[i]);
            }
        }
    }
    CHECK(matrix.stops + matrix.restarts == 0);
    CHECK(matrix.user_list.users().size() == 1);
}

namespace {

constexpr const char* patience = "patience is all";

/// "pat" has a role by an IdentityMappingRule, which can be taken away.
struct Taken : Matrix {
    explicit Taken(const Identity& of) : identity{of}
    {
        REQUIRE(user_list.add({"pat", {}, 0, {}, {}}, patience, random));
        // Or the last rule of SecurityAdmin would stay.
        configured.replace({{.name = "chief", .roles = {"SecurityAdmin"}}});
        give();
        pat.emplace(log_in("pat", patience));
    }
    void give()
    {
        REQUIRE(roles.add_identity(identity.role, rule()));
        server::RunningServer{server}.roles_changed();
    }
    void take()
    {
        REQUIRE(roles.remove_identity(identity.role, rule()));
        server::RunningServer{server}.roles_changed();
    }
    /// By the role, and not because everybody has it.
    [[nodiscard]] bool has(Roles some) const
    {
        return (some & identity.roles) != 0 && (some & who::everybody) == 0;
    }

    const Identity& identity;
    std::optional<TestClient> pat;

private:
    [[nodiscard]] static IdentityMappingRuleType rule()
    {
        return {IdentityCriteriaType::UserName, "pat"};
    }
};

/// A value of the type.
Variant plain_value(const Argument& argument)
{
    const NodeId& type = argument.data_type;
    if (type.is(id::IdentityMappingRuleType)) {
        return Variant{ExtensionObject::from(
            IdentityMappingRuleType{IdentityCriteriaType::UserName, "somebody else"})};
    }
    if (type.is(id::EndpointType)) {
        return Variant{ExtensionObject::from(EndpointType{})};
    }
    const bool is_array = argument.value_rank >= 1;
    const std::array<std::pair<std::uint32_t, Variant>, 11> values{
        {{id::String, is_array ? Variant{Array<String>{}} : Variant{String{"x"}}},
         {id::ByteString, is_array ? Variant{Array<ByteString>{}} : Variant{ByteString{}}},
         {id::BaseDataType, is_array ? Variant{Array<Variant>{}} : Variant{}},
         {id::NodeId, Variant{NodeId{}}},
         {id::Boolean, Variant{false}},
         {id::Byte, Variant{std::uint8_t{1}}},
         {id::UInt16, Variant{std::uint16_t{0}}},
         {id::Int32, Variant{std::int32_t{0}}},
         {id::ServerState, Variant{std::int32_t{0}}},
         {id::UInt64, Variant{std::uint64_t{0}}},
         {id::LocalizedText, Variant{LocalizedText{"en", "x"}}}}};
    const auto* const found = std::find_if(values.begin(), values.end(),
                                           [&](const auto& each) { return type.is(each.first); });
    return found != values.end()   ? found->second
           : type.is(id::DateTime) ? Variant{DateTime{}}
                                   : Variant{std::uint32_t{0}};
}

/// One of the Method, with arguments of their types.
CallMethodRequest plain_call(const model::AddressSpace& space, const Node& node)
{
    CallMethodRequest call;
    call.object_id = node.parent;
    call.method_id = node.id;
    const model::NodeIndex inputs = child_of(space, space.find(node.id), "InputArguments");
    const Variant value = inputs != model::no_node ? space.value(inputs) : Variant{};
    const auto* const list = value.array_if<ExtensionObject>();
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
        call.input_arguments.push_back(
            plain_value(binary::structure_of<Argument>((*list)[i]).value()));
    }
    return call;
}

} // namespace

TEST_CASE("right matrix: a Method whose turn comes after its right has gone is not called",
          "[attack]")
{
    std::size_t methods = 0;
    for (const Identity& identity : identities) {
        if ((identity.roles & ~who::everybody) == 0) {
            continue; // they can lose nothing
        }
        std::optional<Taken> taken{std::in_place, identity};
        for (const Node& node : only(taken->nodes(), true)) {
            if (!taken->has(right_of(node.thing).standard.call)) {
                continue;
            }
            INFO(identity.role << ", " << node.path);
            CallRequest request;
            request.methods_to_call.push_back(plain_call(taken->server.address_space(), node));
            request.methods_to_call.push_back(request.methods_to_call[0]);
            const auto sent = taken->pat->send(request); // the first is called at once
            taken->take();
            taken->complete();
            const auto response = taken->pat->take<CallResponse>(sent);
            INFO((response ? name(response->results[0].status_code) : name(response.error())));
            REQUIRE(response);
            CHECK(name(response->results[0].status_code) != "Bad_UserAccessDenied");
            CHECK((response->results[1].status_code == status::Bad_UserAccessDenied ||
                   response->results[1].status_code == status::Bad_NodeIdUnknown));
            ++methods;
            if (node.thing == Thing::Reset) { // which takes more away than that
                taken.emplace(identity);
            } else {
                taken->give();
            }
        }
    }
    CHECK(methods > 90);
}

namespace {

/// An item for each Variable, numbered as they are.
void monitor(Taken& taken, const std::vector<Node>& variables)
{
    TestClient& client = *taken.pat;
    CreateSubscriptionRequest subscription;
    subscription.requested_publishing_interval = 100;
    subscription.requested_lifetime_count = 3'000;
    subscription.requested_max_keep_alive_count = 10;
    subscription.publishing_enabled = true;
    const auto made = client.call<CreateSubscriptionResponse>(subscription);
    REQUIRE(made);
    CreateMonitoredItemsRequest request;
    request.subscription_id = made->subscription_id;
    for (const Node& variable : variables) {
        MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
        item.item_to_monitor.node_id = variable.id;
        item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.client_handle =
            static_cast<std::uint32_t>(request.items_to_create.size() - 1);
        item.requested_parameters.sampling_interval = 100;
        item.requested_parameters.queue_size = 2;
    }
    const auto sent = client.send(request);
    auto items = client.take<CreateMonitoredItemsResponse>(sent);
    for (int turn = 0; turn < 100 && !items; ++turn) { // they are made in turns
        taken.complete();
        client.connection.handle_deadline(taken.now);
        items = client.take<CreateMonitoredItemsResponse>(sent);
    }
    INFO((items ? "Good" : name(items.error())));
    REQUIRE(items);
    for (std::size_t i = 0; i < variables.size(); ++i) {
        INFO(variables[i].path);
        CHECK(name(items->results[i].status_code) == "Good");
    }
}

/// The last value that each item reports within some seconds; null for those that do not report.
std::vector<std::optional<DataValue>> publish(Taken& taken, std::size_t items)
{
    using namespace std::chrono_literals;
    std::vector<std::optional<DataValue>> values(items);
    for (int round = 0; round < 4; ++round) {
        const auto sent = taken.pat->send(PublishRequest{});
        for (int i = 0; i < 12; ++i) {
            taken.advance(100ms);
            taken.complete();
            taken.pat->run();
        }
        const auto response = taken.pat->take<PublishResponse>(sent);
        REQUIRE(response);
        for (const auto& data : response->notification_message.notification_data) {
            if (const auto* const changes = data.get_if<DataChangeNotification>()) {
                for (const auto& each : changes->monitored_items) {
                    values.at(each.client_handle) = each.value;
                }
            }
        }
    }
    return values;
}

} // namespace

TEST_CASE("right matrix: an item whose right has gone reports that, and no value any more",
          "[attack]")
{
    std::size_t items = 0;
    for (const Identity& identity : identities) {
        if ((identity.roles & ~who::everybody) == 0) {
            continue; // they can lose nothing
        }
        Taken taken{identity};
        std::vector<Node> variables;
        for (Node& node : only(taken.nodes(), false)) {
            if (taken.has(right_of(node.thing).standard.see)) {
                variables.push_back(std::move(node));
            }
        }
        if (variables.empty()) {
            continue;
        }
        monitor(taken, variables);
        const auto before = publish(taken, variables.size());
        taken.take();
        const auto after = publish(taken, variables.size());
        for (std::size_t i = 0; i < variables.size(); ++i) {
            INFO(identity.role << ", " << variables[i].path);
            CHECK(before[i]);
            REQUIRE(after[i]);
            CHECK(after[i]->status.is_bad());
            CHECK(after[i]->value.is_null());
            ++items;
        }
    }
    CHECK(items > 300);
}

} // namespace right_matrix_test
