#include <array>
#include <cmath>
#include <limits>

#include <busbar/types/ids.hpp>

#include "fuzz_script.hpp"
#include "kept_world.hpp"
#include "subscription_world.hpp"

namespace subscription_fuzz {

using namespace busbar;
using namespace busbar::fuzz;

namespace {

/// Takes numbers and requests from the script, plausible ones and absurd ones.
struct Chooser {
    template <typename T, std::size_t N>
    T one_of(const std::array<T, N>& values)
    {
        return values[script.byte() % N];
    }
    std::uint32_t count()
    {
        return one_of(std::array<std::uint32_t, 8>{0, 1, 2, 3, 10, 100, 1U << 31U, UINT32_MAX});
    }
    double interval()
    {
        return one_of(std::array{0.0, 10.0, 100.0, 1'000.0, -1.0, 1e300, 5e-324,
                                 std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity()});
    }
    std::uint32_t subscription()
    {
        return world.subscriptions[script.byte() % world.subscriptions.size()];
    }
    /// The first ones, so that few bytes name the same one twice.
    std::uint32_t item()
    {
        const std::size_t number = script.byte() % 10U;
        return number < world.items.size() ? world.items[number] : 0;
    }
    std::string_view user()
    {
        return one_of(std::array<std::string_view, 4>{"maria", "maria", "paul", ""});
    }
    test::TestClient& client()
    {
        client_index = script.byte() % SubscriptionWorld::client_count;
        return world.client(client_index);
    }
    Variant value()
    {
        const std::uint8_t byte = script.byte();
        switch (byte % 5) {
        case 0:
            return Variant{std::int32_t{byte}};
        case 1:
            return Variant{byte / 7.0};
        case 2:
            return Variant{Array<double>(byte % 9U)};
        case 3:
            return Variant{String{std::string(byte * std::size_t{200}, 'x')}};
        default:
            return {};
        }
    }
    ExtensionObject filter()
    {
        switch (script.byte() % 6) {
        case 0: {
            DataChangeFilter filter;
            filter.trigger = static_cast<DataChangeTrigger>(script.byte() % 4);
            filter.deadband_type = script.byte() % 4U;
            filter.deadband_value = interval();
            return ExtensionObject::from(filter);
        }
        case 1:
        case 2: {
            EventFilter filter;
            for (const char* name : {"EventId", "Message", "SourceName", "Nothing"}) {
                SimpleAttributeOperand operand;
                operand.type_definition_id = NodeId{0, id::BaseEventType};
                operand.browse_path = {QualifiedName{0, name}};
                operand.attribute_id = 13;
                filter.select_clauses.push_back(operand);
            }
            return ExtensionObject::from(std::move(filter));
        }
        case 3:
            return ExtensionObject::from(AggregateFilter{});
        default:
            return {};
        }
    }
    MonitoringParameters parameters()
    {
        MonitoringParameters result;
        result.client_handle = script.byte();
        result.sampling_interval = interval();
        result.filter = filter();
        result.queue_size = count();
        result.discard_oldest = script.byte() % 2 == 0;
        return result;
    }
    ReadValueId target()
    {
        ReadValueId id;
        const std::uint8_t choice = script.byte();
        id.node_id = choice % 8 < 5   ? world.variable(choice % 4)
                     : choice % 8 < 7 ? NodeId{0, id::Server}
                                      : NodeId{0, id::Server_ServerStatus_CurrentTime};
        id.attribute_id = choice % 8 == 5 || choice % 8 == 6 ? 12U : (choice < 250 ? 13U : choice);
        if (script.byte() % 8 == 0) {
            id.index_range = one_of(std::array{"0", "1:2", "5", "2:1", "0,0", "x"});
        }
        return id;
    }

    SubscriptionWorld& world;
    Script& script;
    std::size_t client_index{0};
};

void create_subscription(Chooser& choose)
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = choose.interval();
    request.requested_lifetime_count = choose.count();
    request.requested_max_keep_alive_count = choose.count();
    request.max_notifications_per_publish = choose.count();
    request.publishing_enabled = choose.script.byte() % 4 != 0;
    request.priority = choose.script.byte();
    if (const auto made = choose.client().call<CreateSubscriptionResponse>(request)) {
        require(made->revised_lifetime_count >= 3 * made->revised_max_keep_alive_count);
        require(made->revised_publishing_interval > 0);
        choose.world.subscriptions.push_back(made->subscription_id);
    }
}

void modify_subscription(Chooser& choose)
{
    ModifySubscriptionRequest request;
    request.subscription_id = choose.subscription();
    request.requested_publishing_interval = choose.interval();
    request.requested_lifetime_count = choose.count();
    request.requested_max_keep_alive_count = choose.count();
    request.max_notifications_per_publish = choose.count();
    static_cast<void>(choose.client().call<ModifySubscriptionResponse>(request));
}

void set_publishing_mode(Chooser& choose)
{
    SetPublishingModeRequest request;
    request.publishing_enabled = choose.script.byte() % 2 == 0;
    request.subscription_ids = {choose.subscription(), choose.subscription()};
    static_cast<void>(choose.client().call<SetPublishingModeResponse>(request));
}

void delete_subscriptions(Chooser& choose)
{
    DeleteSubscriptionsRequest request;
    request.subscription_ids = {choose.subscription(), choose.subscription()};
    static_cast<void>(choose.client().call<DeleteSubscriptionsResponse>(request));
}

void publish(Chooser& choose)
{
    PublishRequest request;
    request.subscription_acknowledgements.resize(choose.script.byte() % 6U);
    for (SubscriptionAcknowledgement& one : request.subscription_acknowledgements) {
        one = {choose.subscription(), choose.script.byte() % 8U};
    }
    test::TestClient& client = choose.client();
    client.timeout_hint = choose.script.byte() % 8 == 0 ? choose.script.byte() : 0U;
    for (int i = choose.script.byte() % 6; i >= 0; --i) {
        client.send(request);
    }
    client.timeout_hint = 0;
}

void republish(Chooser& choose)
{
    RepublishRequest request;
    request.subscription_id = choose.subscription();
    request.retransmit_sequence_number = choose.script.byte() % 8U;
    const auto response = choose.client().call<RepublishResponse>(request);
    require(!response ||
            response->notification_message.sequence_number == request.retransmit_sequence_number);
}

void transfer(Chooser& choose)
{
    TransferSubscriptionsRequest request;
    request.subscription_ids = {choose.subscription(), choose.subscription()};
    request.send_initial_values = choose.script.byte() % 2 == 0;
    static_cast<void>(choose.client().call<TransferSubscriptionsResponse>(request));
}

void create_items(Chooser& choose)
{
    CreateMonitoredItemsRequest request;
    request.subscription_id = choose.subscription();
    request.timestamps_to_return = static_cast<TimestampsToReturn>(choose.script.byte() % 4);
    request.items_to_create.resize(choose.script.byte() % 4U);
    for (MonitoredItemCreateRequest& item : request.items_to_create) {
        item.item_to_monitor = choose.target();
        item.monitoring_mode = static_cast<MonitoringMode>(choose.script.byte() % 4);
        item.requested_parameters = choose.parameters();
    }
    const auto made = choose.client().call<CreateMonitoredItemsResponse>(std::move(request));
    if (made) {
        for (const MonitoredItemCreateResult& result : made->results) {
            if (result.status_code.is_good()) {
                choose.world.items.push_back(result.monitored_item_id);
            }
        }
    }
}

void modify_items(Chooser& choose)
{
    ModifyMonitoredItemsRequest request;
    request.subscription_id = choose.subscription();
    request.timestamps_to_return = static_cast<TimestampsToReturn>(choose.script.byte() % 5);
    request.items_to_modify.resize(choose.script.byte() % 4U);
    for (MonitoredItemModifyRequest& item : request.items_to_modify) {
        item = {choose.item(), choose.parameters()};
    }
    static_cast<void>(choose.client().call<ModifyMonitoredItemsResponse>(std::move(request)));
}

void set_monitoring_mode(Chooser& choose)
{
    SetMonitoringModeRequest request;
    request.subscription_id = choose.subscription();
    request.monitoring_mode = static_cast<MonitoringMode>(choose.script.byte() % 4);
    request.monitored_item_ids = {choose.item(), choose.item()};
    static_cast<void>(choose.client().call<SetMonitoringModeResponse>(request));
}

void set_triggering(Chooser& choose)
{
    SetTriggeringRequest request;
    request.subscription_id = choose.subscription();
    request.triggering_item_id = choose.item();
    request.links_to_add = {choose.item(), choose.item()};
    request.links_to_remove = {choose.item()};
    static_cast<void>(choose.client().call<SetTriggeringResponse>(request));
}

void delete_items(Chooser& choose)
{
    DeleteMonitoredItemsRequest request;
    request.subscription_id = choose.subscription();
    request.monitored_item_ids = {choose.item(), choose.item()};
    static_cast<void>(choose.client().call<DeleteMonitoredItemsResponse>(request));
}

void let_time_pass(Chooser& choose)
{
    if (choose.script.byte() % 4 == 0) {
        choose.world.advance(std::chrono::milliseconds{
            choose.one_of(std::array{0, 1, 99, 1'000, 5'000, 10'000, 30'000, 70'000, 4'000'000})});
        return;
    }
    for (int i = choose.script.byte() % 16; i >= 0; --i) {
        choose.world.advance(std::chrono::milliseconds{50});
        choose.world.check();
    }
}

void write(Chooser& choose)
{
    const std::size_t variable = choose.script.byte() % SubscriptionWorld::variable_count;
    choose.world.set(variable, choose.value(),
                     choose.script.byte() % 4 == 0 ? StatusCode{status::Bad_SensorFailure}
                                                   : StatusCode{});
}

void raise(Chooser& choose)
{
    server::Event event;
    event.message = LocalizedText{String{std::string(choose.script.byte() * std::size_t{50}, 'm')}};
    event.severity = choose.script.byte();
    for (int i = choose.script.byte() % 8; i >= 0; --i) {
        static_cast<void>(choose.world.server().raise_event(event));
    }
    choose.world.server().handle_completions(choose.world.now);
}

void change_users(Chooser& choose)
{
    SubscriptionWorld& world = choose.world;
    const std::uint8_t choice = choose.script.byte();
    world.users.valid_until = {
        choice % 4 == 0 ? world.wall_clock.time.ticks + DateTime::ticks_per_second : 0};
    world.access.shut_out = choose.user();
    world.access.blind = choice % 8 == 0 ? "paul" : "nobody";
    world.server().announce_access_change(world.now);
    choose.client();
    world.log_in(choose.client_index, choose.user());
}

void change_nodes(Chooser& choose)
{
    model::AddressSpace& space = choose.world.space();
    const auto index = choose.script.byte() % SubscriptionWorld::variable_count;
    const model::NodeIndex node = space.find(choose.world.variable(index));
    const std::uint8_t choice = choose.script.byte();
    if (node == model::no_node) {
        return;
    }
    if (choice == 0) {
        static_cast<void>(space.remove(node));
    } else {
        space.set_access_level(node, model::Access{static_cast<std::uint8_t>(choice % 4)});
    }
    choose.world.server().announce_semantics_change(choose.world.variable(index));
}

void lose_connection(Chooser& choose)
{
    choose.client();
    choose.world.reconnect(choose.client_index, choose.user());
}

void close_session(Chooser& choose)
{
    CloseSessionRequest request;
    request.delete_subscriptions = choose.script.byte() % 2 == 0;
    test::TestClient& client = choose.client();
    if (client.status_of<CloseSessionResponse>(request).is_good()) {
        client.authentication_token = NodeId{};
        choose.world.log_in(choose.client_index, choose.user());
    }
}

constexpr std::array steps{
    create_subscription,
    modify_subscription,
    set_publishing_mode,
    delete_subscriptions,
    publish,
    republish,
    transfer,
    create_items,
    modify_items,
    set_monitoring_mode,
    set_triggering,
    delete_items,
    write,
    raise,
    let_time_pass,
    change_users,
    change_nodes,
    lose_connection,
    close_session,
    publish,
    create_items,
    let_time_pass,
    write,
    let_time_pass,
};

} // namespace

/// The services of Subscriptions and MonitoredItems, against a server that goes on running.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static KeptWorld<SubscriptionWorld> kept;
    SubscriptionWorld& world = kept.next();
    world.begin();
    Script script{{data, size}};
    Chooser choose{world, script};
    // So that few bytes come far.
    create_subscription(choose);
    for (int i = 0; i < 60 && !script.is_over(); ++i) {
        steps[script.byte() % steps.size()](choose);
        world.check();
    }
    world.finish();
    return 0;
}

} // namespace subscription_fuzz
