#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/types/configuration.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "administration/node_table.hpp"
#include "right_matrix.hpp"

namespace right_matrix_test {

// Every Method and Variable of the administration, for nine identities over three channels: may do
// what the table of rights says, and nothing else. Then each of them for a user who has a role of
// the table and loses it in between.

using namespace right_matrix;

namespace {

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
