#include <catch2/catch.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/model/data_access.hpp>
#include <busbar/model/instance.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/view.hpp>

#include "subscription_fixture.hpp"

namespace kept_values_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// A client that writes Variables whose values the address space keeps.
struct KeptValues : SubscriptionFixture {
    NodeId add_kept(const char* name, Variant value, std::uint32_t data_type,
                    model::Access access = model::Access::ReadWrite)
    {
        model::NewVariable variable;
        variable.data_type = NodeId{0, data_type};
        variable.value = std::move(value);
        variable.access_level = access;
        return add_variable(name, variable);
    }
    StatusCode write(const NodeId& node, DataValue value, const char* range = nullptr)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = node;
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value = std::move(value);
        if (range != nullptr) {
            request.nodes_to_write[0].index_range = range;
        }
        const auto response = client.call<WriteResponse>(request);
        return response ? response->results[0] : response.error();
    }
    DataValue read(const NodeId& node)
    {
        ReadRequest request;
        request.timestamps_to_return = TimestampsToReturn::Source;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] model::NewNode named(const char* name)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = server.address_space().find(id::ObjectsFolder);
        return node;
    }

    /// False with a small namespace 0, which has no types of Data Access.
    [[nodiscard]] bool has_data_access()
    {
        return server.address_space().find(id::DataItemType) != model::no_node;
    }

    TestClient client{log_in_as("operator")};
};

/// As a file or a client that does not know the type leaves it.
template <typename T>
ExtensionObject still_encoded(const T& value)
{
    const std::vector<std::byte> bytes = binary::to_bytes(value).value();
    return ExtensionObject::from_binary(NodeId{0, T::binary_encoding_id}, ByteString{bytes});
}

} // namespace

TEST_CASE_METHOD(KeptValues, "status and source timestamp are written with the value")
{
    const NodeId level = add_kept("level", 1, id::Int32,
                                  model::Access::ReadWrite | model::Access::StatusWrite |
                                      model::Access::TimestampWrite);
    const DataValue doubtful{Variant{7}, status::Uncertain_LastUsableValue, DateTime{12'345'678}};
    CHECK(write(level, doubtful) == status::Good);
    CHECK(read(level) == doubtful);
    CHECK(write(level, DataValue{Variant{8}}) == status::Good);
    CHECK(read(level) == DataValue{Variant{8}, status::Good, wall_clock.time});
}

TEST_CASE_METHOD(KeptValues, "a value that is written has the time when it was")
{
    const NodeId level = add_kept("level", 1, id::Int32);
    const DateTime started = wall_clock.time;
    CHECK(read(level).source_timestamp == started); // when it was made, it came with its node
    advance(5s);
    CHECK(read(level).source_timestamp == started);
    CHECK(write(level, DataValue{Variant{1}}) == status::Good);
    const DateTime then = wall_clock.time;
    advance(5s);
    CHECK(read(level) == DataValue{Variant{1}, status::Good, then});
    // The server's own set_value is the application's, which says no time.
    const auto index = server.address_space().find(level);
    REQUIRE(server.address_space().set_value(index, Variant{2}));
    CHECK(read(level) == DataValue{Variant{2}});
    REQUIRE(server.address_space().set_data_value(index, {Variant{3}, status::Good, then}));
    CHECK(read(level) == DataValue{Variant{3}, status::Good, then});
}

TEST_CASE_METHOD(KeptValues, "StatusValueTimestamp reports an equal value that is written again")
{
    const NodeId level = add_kept("level", 1, id::Int32);
    const std::uint32_t id = subscribe(client);
    auto item = item_request(level);
    DataChangeFilter filter;
    filter.trigger =
        GENERATE(DataChangeTrigger::StatusValue, DataChangeTrigger::StatusValueTimestamp);
    item.requested_parameters.filter = ExtensionObject::from(filter);
    REQUIRE(monitor(client, id, item).status_code == status::Good);
    CHECK(next_data(client, 100ms).size() == 1);
    CHECK(write(level, DataValue{Variant{1}}) == status::Good);
    const bool has_timestamp = filter.trigger == DataChangeTrigger::StatusValueTimestamp;
    CHECK(next_data(client, 100ms).size() == (has_timestamp ? 1 : 0));
}

TEST_CASE_METHOD(KeptValues, "a percent deadband goes by an EURange that is still encoded")
{
    if (!has_data_access()) {
        return;
    }
    auto& space = server.address_space();
    model::AnalogItem analog;
    analog.eu_range = Range{0, 200};
    analog.variable.data_type = NodeId{0, id::Double};
    analog.variable.value = Variant{10.0};
    analog.variable.access_level = model::Access::ReadWrite;
    const auto level = add_analog_item(space, named("level"), analog);
    REQUIRE(level);
    REQUIRE(space.set_value(find_by_path(space, *level, "EURange"), still_encoded(Range{0, 100})));
    const std::uint32_t id = subscribe(client);
    auto item = item_request(NodeId{1, "level"});
    DataChangeFilter filter;
    filter.trigger = DataChangeTrigger::StatusValue;
    filter.deadband_type = static_cast<std::uint32_t>(DeadbandType::Percent);
    filter.deadband_value = 10;
    item.requested_parameters.filter = ExtensionObject::from(filter);
    REQUIRE(monitor(client, id, item).status_code == status::Good);
    CHECK(next_data(client, 100ms).size() == 1);
    CHECK(write(NodeId{1, "level"}, DataValue{Variant{19.0}}) == status::Good);
    CHECK(next_data(client, 100ms).empty());
    CHECK(write(NodeId{1, "level"}, DataValue{Variant{21.0}}) == status::Good);
    CHECK(next_data(client, 100ms).size() == 1);
}

TEST_CASE_METHOD(KeptValues, "MultiStateDiscrete has the values that EnumStrings names")
{
    if (!has_data_access()) {
        return;
    }
    auto& space = server.address_space();
    model::MultiStateItem item;
    item.enum_strings = {LocalizedText{"off"}, LocalizedText{"on"}};
    item.variable.value = Variant{std::uint32_t{0}};
    item.variable.access_level = model::Access::ReadWrite;
    REQUIRE(add_multi_state(space, named("state"), item));
    const NodeId state{1, "state"};
    CHECK(write(state, DataValue{Variant{std::uint32_t{1}}}) == status::Good);
    CHECK(write(state, DataValue{Variant{std::uint32_t{2}}}) == status::Bad_OutOfRange);
    CHECK(read(state).value == Variant{std::uint32_t{1}});
    // There are none at all.
    const auto strings = find_by_path(space, space.find(state), "EnumStrings");
    REQUIRE(space.set_value(strings, Variant{Array<LocalizedText>(0)}));
    CHECK(write(state, DataValue{Variant{std::uint32_t{0}}}) == status::Bad_OutOfRange);
}

TEST_CASE_METHOD(KeptValues, "ValueAsText follows a MultiStateValueDiscrete that is written")
{
    if (!has_data_access()) {
        return;
    }
    auto& space = server.address_space();
    model::MultiStateValueItem item;
    item.enum_values.resize(2);
    item.enum_values[0].value = 1;
    item.enum_values[0].display_name = LocalizedText{"one"};
    item.enum_values[1].value = 4;
    item.enum_values[1].display_name = LocalizedText{"four"};
    item.variable.value = Variant{std::int32_t{1}};
    item.variable.access_level = model::Access::ReadWrite;
    const auto made = add_multi_state_value(space, named("mode"), item);
    REQUIRE(made);
    const auto as_text = [&] { return space.value(find_by_path(space, *made, "ValueAsText")); };
    const NodeId mode{1, "mode"};
    if (GENERATE(false, true)) { // as a file has them
        Array<ExtensionObject> values;
        for (const EnumValueType& each : item.enum_values) {
            values.push_back(still_encoded(each));
        }
        REQUIRE(space.set_value(find_by_path(space, *made, "EnumValues"), std::move(values)));
    }
    CHECK(as_text() == Variant{LocalizedText{"one"}});
    CHECK(write(mode, DataValue{Variant{std::int32_t{4}}}) == status::Good);
    CHECK(as_text() == Variant{LocalizedText{"four"}});
    CHECK(write(mode, DataValue{Variant{std::int32_t{2}}}) == status::Bad_OutOfRange);
    CHECK(as_text() == Variant{LocalizedText{"four"}});
}

TEST_CASE_METHOD(KeptValues, "what an IndexRange names is written as an array")
{
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value_rank = 1;
    variable.value = Variant{Array<std::int32_t>{1, 2, 3}};
    variable.access_level = model::Access::ReadWrite;
    const NodeId list = add_variable("list", variable);
    CHECK(write(list, DataValue{Variant{9}}, "1") == status::Bad_IndexRangeDataMismatch);
    CHECK(write(list, DataValue{Variant{Array<std::int32_t>{9}}}, "1") == status::Good);
    CHECK(read(list).value == Variant{Array<std::int32_t>{1, 9, 3}});
}

TEST_CASE_METHOD(KeptValues, "a structure cannot be replaced by nothing")
{
    const NodeId range = add_kept("range", ExtensionObject::from(Range{1, 2}), id::Range);
    CHECK(write(range, DataValue{Variant{ExtensionObject{}}}) == status::Bad_TypeMismatch);
    CHECK(write(range, DataValue{Variant{ExtensionObject::from(Range{3, 4})}}) == status::Good);
    const NodeId any = add_kept("any", ExtensionObject::from(Range{1, 2}), id::Structure);
    CHECK(write(any, DataValue{Variant{ExtensionObject{}}}) == status::Good);
}

TEST_CASE_METHOD(KeptValues, "who has subscribed to State learns that the server stops")
{
    const std::uint32_t id = subscribe(client);
    monitor(client, id, item_request(NodeId{0, id::Server_ServerStatus_State}));
    CHECK(next_data(client, 100ms).size() == 1);
    const std::uint32_t waiting = publish(client);
    server.begin_shutdown(now, "maintenance");
    advance(100ms);
    const auto told = take(client, waiting);
    REQUIRE(told);
    REQUIRE(data(told->notification_message).size() == 1);
    CHECK(data(told->notification_message)[0].value.value == Variant{ServerState::Shutdown});
    CHECK(client.status_of<BrowseResponse>(BrowseRequest{}) == status::Bad_Shutdown);
    advance(2s);
    CHECK(client.is_closed());
}

TEST_CASE_METHOD(KeptValues, "a client nonce serves one session")
{
    TestClient other = connect("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
    const CreateSessionRequest request = other.create_request();
    REQUIRE(other.create_session(request));
    CHECK(other.create_session(request).error() == status::Bad_NonceInvalid);
    REQUIRE(other.create_session(other.create_request()));
}

} // namespace kept_values_test
