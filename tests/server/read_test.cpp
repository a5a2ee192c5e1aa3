#include <catch2/catch.hpp>

#include <limits>

#include "attribute_fixture.hpp"
#include "support/allocation_count.hpp"

namespace read_test {

using namespace busbar;
using namespace std::chrono_literals;
using busbar::server::detail::check_read;
using busbar::test::AttributeFixture;

namespace {

ReadRequest request_of_one()
{
    return AttributeFixture::read_request({AttributeFixture::read_value_id(NodeId{0, 2256U})});
}

} // namespace

TEST_CASE("a Read that is wrong as a whole is refused (Part 4, 5.11.2.3)")
{
    ReadRequest request = request_of_one();
    CHECK(check_read(request, 1) == status::Good);

    SECTION("nothing to do")
    {
        request.nodes_to_read.clear();
        CHECK(check_read(request, 1) == status::Bad_NothingToDo);
        request.nodes_to_read.reset();
        CHECK(check_read(request, 1) == status::Bad_NothingToDo);
    }
    SECTION("too much to do")
    {
        request.nodes_to_read.resize(2);
        CHECK(check_read(request, 1) == status::Bad_TooManyOperations);
        CHECK(check_read(request, 2) == status::Good);
    }
    SECTION("maxAge")
    {
        for (const double bad : {-1.0, -0.001, std::numeric_limits<double>::quiet_NaN(),
                                 -std::numeric_limits<double>::infinity()}) {
            request.max_age = bad;
            CHECK(check_read(request, 1) == status::Bad_MaxAgeInvalid);
        }
        request.max_age = std::numeric_limits<double>::infinity();
        CHECK(check_read(request, 1) == status::Good);
    }
    SECTION("timestampsToReturn")
    {
        for (const int bad : {-1, 4, 5, 0x7FFFFFFF}) {
            request.timestamps_to_return = static_cast<TimestampsToReturn>(bad);
            CHECK(check_read(request, 1) == status::Bad_TimestampsToReturnInvalid);
        }
    }
}

TEST_CASE_METHOD(AttributeFixture, "values and attributes are read in the request's order",
                 "[unit:Attribute Read]")
{
    const NodeId speed = add("Speed", id::Int16, std::int16_t{7});
    const NodeId name = add("Name", id::String, "Press 1");
    ReadRequest request =
        read_request({read_value_id(name), read_value_id(speed, AttributeId::BrowseName),
                      read_value_id(speed), read_value_id(NodeId{namespace_index, "None"}),
                      read_value_id(name, AttributeId::NodeId), read_value_id(speed)});
    const auto values = read(request);
    REQUIRE(values.size() == 6);
    CHECK(values[0].value == Variant{"Press 1"});
    CHECK(values[1].value == Variant{QualifiedName{namespace_index, "Speed"}});
    CHECK(values[2].value == Variant{std::int16_t{7}});
    CHECK(values[3] == DataValue{status::Bad_NodeIdUnknown});
    CHECK(values[4].value == Variant{name});
    CHECK(values[5] == values[2]);
}

TEST_CASE_METHOD(AttributeFixture, "every attribute of a Variable is there, no other is")
{
    const NodeId speed = add("Speed", id::Int16, std::int16_t{7});
    CHECK(read(speed, AttributeId::NodeClass).value == Variant{std::int32_t{2}});
    CHECK(read(speed, AttributeId::DataType).value == Variant{NodeId{0, id::Int16}});
    CHECK(read(speed, AttributeId::ValueRank).value == Variant{std::int32_t{-1}});
    CHECK(read(speed, AttributeId::AccessLevel).value == Variant{std::uint8_t{3}});
    for (const AttributeId missing :
         {AttributeId::IsAbstract, AttributeId::InverseName, AttributeId::EventNotifier,
          AttributeId::Executable, static_cast<AttributeId>(0), static_cast<AttributeId>(28),
          static_cast<AttributeId>(UINT32_MAX)}) {
        CHECK(read(speed, missing) == DataValue{status::Bad_AttributeIdInvalid});
    }
}

TEST_CASE_METHOD(AttributeFixture, "nodes that cannot be read say why")
{
    CHECK(read(NodeId{}).status == status::Bad_NodeIdInvalid);
    CHECK(read(NodeId{200, "X"}).status == status::Bad_NodeIdUnknown);
    CHECK(read(NodeId{0, id::ObjectsFolder}).status == status::Bad_AttributeIdInvalid);

    const NodeId command = add("Command", id::Boolean, true, model::Access::Write);
    CHECK(read(command).status == status::Bad_NotReadable);

    const NodeId secret = add("Secret", id::Int32, 5);
    user.access_level_mask = 0;
    CHECK(read(secret).status == status::Bad_UserAccessDenied);
    CHECK(read(secret, AttributeId::UserAccessLevel).value == Variant{std::uint8_t{0}});
    CHECK(read(secret, AttributeId::AccessLevel).value == Variant{std::uint8_t{3}});
}

TEST_CASE_METHOD(AttributeFixture, "access control decides for each node")
{
    class HideAndProtect final : public server::AccessControl {
    public:
        bool may_browse(const server::UserIdentity&, const NodeId& node) const override
        {
            return node.is_numeric() || node.string().view() != "Hidden";
        }
        std::uint8_t user_access_level(const server::UserIdentity&, const NodeId& node,
                                       std::uint8_t level) const override
        {
            return node.string().view() == "Protected" ? 0 : level;
        }
    };
    const HideAndProtect access;
    control = &access;
    CHECK(read(add("Hidden", id::Int32, 1), AttributeId::BrowseName).status ==
          status::Bad_NodeIdUnknown);
    CHECK(read(add("Protected", id::Int32, 1)).status == status::Bad_UserAccessDenied);
    CHECK(read(add("Open", id::Int32, 1)).value == Variant{1});
}

TEST_CASE_METHOD(AttributeFixture, "the client chooses the timestamps")
{
    const NodeId speed = add("Speed", id::Int32, 7);
    ReadRequest request =
        read_request({read_value_id(speed), read_value_id(speed, AttributeId::DisplayName),
                      read_value_id(NodeId{namespace_index, "None"})});
    const auto read_with = [&](TimestampsToReturn which) {
        request.timestamps_to_return = which;
        return read(request);
    };
    const DateTime none;
    auto values = read_with(TimestampsToReturn::Source);
    CHECK(values[0].source_timestamp == clock.time);
    CHECK(values[0].server_timestamp == none);
    CHECK(values[1].source_timestamp == none);

    values = read_with(TimestampsToReturn::Server);
    CHECK(values[0].source_timestamp == none);
    CHECK(values[0].server_timestamp == server_time);
    CHECK(values[1].server_timestamp == server_time);

    values = read_with(TimestampsToReturn::Both);
    CHECK(values[0].source_timestamp == clock.time);
    CHECK(values[0].server_timestamp == server_time);
    CHECK(values[2].status == status::Bad_NodeIdUnknown);

    values = read_with(TimestampsToReturn::Neither);
    CHECK(values[0] == DataValue{Variant{7}});
}

TEST_CASE_METHOD(AttributeFixture, "a server without history says of no node that it has some")
{
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.access_level =
        model::Access::ReadWrite | model::Access::HistoryRead | model::Access::HistoryWrite;
    variable.historizing = true;
    const NodeId level = add("Level", variable);
    constexpr std::uint8_t read_write = 3;
    user.access_level_mask = 0xFF;
    CHECK(read(level, AttributeId::AccessLevel).value == Variant{read_write});
    CHECK(read(level, AttributeId::UserAccessLevel).value == Variant{read_write});
    CHECK((*read(level, AttributeId::AccessLevelEx).value.get_if<std::uint32_t>() & 0xFFU) ==
          read_write);
    CHECK(read(level, AttributeId::Historizing).value == Variant{false});

    model::NewNode node;
    node.id = NodeId{namespace_index, "Area"};
    node.browse_name = QualifiedName{namespace_index, "Area"};
    node.parent = space.find(id::ObjectsFolder);
    model::NewObject area;
    area.event_notifier = 0x0D; // SubscribeToEvents, HistoryRead, HistoryWrite
    REQUIRE(space.add_object(node, area));
    CHECK(read(node.id, AttributeId::EventNotifier).value == Variant{std::uint8_t{1}});
}

TEST_CASE_METHOD(AttributeFixture, "a bad status comes without value, an uncertain one with it")
{
    const NodeId speed = add("Speed", id::Int32, 7);
    memory.set(0, 8, status::Uncertain_LastUsableValue);
    CHECK(read(speed) == DataValue{Variant{8}, status::Uncertain_LastUsableValue});
    memory.set(0, 9, status::Bad_SensorFailure);
    CHECK(read(speed) == DataValue{status::Bad_SensorFailure});
}

TEST_CASE_METHOD(AttributeFixture, "an IndexRange cuts values (Part 4, 7.27)")
{
    const NodeId levels =
        add("Levels", id::Int32, Array<std::int32_t>{1, 2, 3}, model::Access::ReadWrite, 1);
    const NodeId name = add("Name", id::String, "Press");
    const NodeId matrix =
        add("Matrix", id::Int32,
            Variant::matrix(Array<std::int32_t>{1, 2, 3, 4, 5, 6}, Array<std::uint32_t>{2, 3}),
            model::Access::ReadWrite, 2);
    const auto cut = [&](const NodeId& node, const char* range) {
        return read(node, AttributeId::Value, range);
    };
    CHECK(cut(levels, "1:2").value == Variant{Array<std::int32_t>{2, 3}});
    CHECK(cut(levels, "2:9").value == Variant{Array<std::int32_t>{3}});
    CHECK(cut(levels, "").value == Variant{Array<std::int32_t>{1, 2, 3}});
    CHECK(cut(name, "1:2").value == Variant{"re"});
    CHECK(cut(matrix, "1,0:1").value ==
          Variant::matrix(Array<std::int32_t>{4, 5}, Array<std::uint32_t>{1, 2}));

    CHECK(cut(levels, "3").status == status::Bad_IndexRangeNoData);
    CHECK(cut(levels, "4294967295").status == status::Bad_IndexRangeNoData);
    CHECK(cut(levels, "0,0").status == status::Bad_IndexRangeNoData);
    CHECK(cut(matrix, "0:1").status == status::Bad_IndexRangeNoData);
    CHECK(cut(matrix, "0:4294967294,0:4294967294").value == cut(matrix, "0:1,0:2").value);
    std::string many = "0";
    for (int i = 0; i < 200; ++i) {
        many += ",0";
    }
    for (const char* bad :
         {"2:1", "1:1", "-1", "a", "1:", ":1", "1,", " 1", "4294967296", many.c_str()}) {
        CHECK(cut(levels, bad).status == status::Bad_IndexRangeInvalid);
    }
    CHECK(read(levels, AttributeId::BrowseName, "0").status == status::Bad_IndexRangeNoData);
    CHECK(read(levels, AttributeId::BrowseName, "x").status == status::Bad_IndexRangeInvalid);
}

TEST_CASE_METHOD(AttributeFixture, "DataEncodings are those of structures (Part 4, 7.29)")
{
    const NodeId number = add("Speed", id::Int32, 7);
    const NodeId structure = add("Argument", id::Argument, ExtensionObject{});
    const NodeId open = add("Any", id::Structure, ExtensionObject{});
    const NodeId anything = add("Anything", id::BaseDataType, 7);
    const auto invalid = status::Bad_DataEncodingInvalid;
    const auto unsupported = status::Bad_DataEncodingUnsupported;
    struct Row {
        QualifiedName encoding;
        StatusCode of_structure;
        StatusCode of_another;
    };
    const Row rows[] = {
        {QualifiedName{}, status::Good, status::Good},
        {QualifiedName{3, ""}, status::Good, status::Good}, // null without a name
        {QualifiedName{0, "Default Binary"}, status::Good, invalid},
        {QualifiedName{0, "Default XML"}, unsupported, invalid},
        {QualifiedName{0, "Default JSON"}, unsupported, invalid},
        {QualifiedName{0, "default binary"}, unsupported, invalid},
        {QualifiedName{0, "Mine"}, unsupported, invalid},
        {QualifiedName{5, "Default Binary"}, unsupported, invalid},
    };
    for (const Row& row : rows) {
        INFO(row.encoding.namespace_index << ":" << row.encoding.name.view());
        const auto read_as = [&](const NodeId& node, AttributeId attribute) {
            ReadValueId value_id = read_value_id(node, attribute);
            value_id.data_encoding = row.encoding;
            return read(read_request({value_id}))[0].status;
        };
        CHECK(read_as(structure, AttributeId::Value) == row.of_structure);
        CHECK(read_as(open, AttributeId::Value) == row.of_structure);
        CHECK(read_as(number, AttributeId::Value) == row.of_another);
        CHECK(read_as(anything, AttributeId::Value) == row.of_another);
        CHECK(read_as(structure, AttributeId::DisplayName) == row.of_another);
        CHECK(read_as(NodeId{0, id::Argument}, AttributeId::DataTypeDefinition) == row.of_another);
    }
}

TEST_CASE_METHOD(AttributeFixture, "values may be kept by the address space or computed")
{
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value = Variant{11};
    CHECK(read(add("Kept", variable)).value == Variant{11});

    live = NodeId{0, id::Server_ServiceLevel};
    CHECK(read(live).value == Variant{42});

    variable.source = 77;
    CHECK(read(add("Lost", variable)).status == status::Bad_NoCommunication);
}

TEST_CASE_METHOD(AttributeFixture,
                 "a source that cuts ranges gets them, with the age that is asked")
{
    auto& source = make_source<test::KeepingSource>();
    source.options_.reads_ranges = true;
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value_rank = 1;
    variable.source = sources.add(source);
    const NodeId levels = add("Levels", variable);
    ReadRequest request =
        read_request({read_value_id(levels, AttributeId::Value, "x"),
                      read_value_id(levels, AttributeId::Value, "1"), read_value_id(levels)});
    request.max_age = 1e300;
    auto job = read_job(request);
    request = {};
    REQUIRE_FALSE(job.start(owner, TimePoint{}));
    REQUIRE(source.reads.size() == 1);
    CHECK(source.reads[0].max_age() == std::chrono::milliseconds{INT32_MAX});
    REQUIRE(source.reads[0].size() == 2);
    CHECK(*source.reads[0].items()[0].range == NumericRange::parse("1").value());
    CHECK(source.reads[0].items()[1].range == nullptr);
    source.reads[0].results()[0] = DataValue{Variant{Array<std::int32_t>{2}}};
    source.reads.clear();
    sources.handle_completions();
    REQUIRE(owner.completed == 1);
    const auto values = results(job);
    CHECK(values[0].status == status::Bad_IndexRangeInvalid);
    CHECK(values[1].value == Variant{Array<std::int32_t>{2}});
    CHECK(values[2].status == status::Bad_NoCommunication);
}

TEST_CASE_METHOD(AttributeFixture, "a source that is late leaves the answers of others alone")
{
    auto& source = make_source<test::KeepingSource>();
    source.options_.timeout = 100ms;
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value_rank = 1;
    variable.source = sources.add(source);
    const NodeId far = add("Far", variable);
    const NodeId near = add("Near", id::Int32, 5);
    auto job = read_job(read_request(
        {read_value_id(far), read_value_id(near), read_value_id(far, AttributeId::Value, "1")}));
    REQUIRE_FALSE(job.start(owner, TimePoint{1s}));
    memory.set(0, 6);
    CHECK(job.next_deadline() == TimePoint{1100ms});
    CHECK(job.handle_deadline(TimePoint{1100ms}));
    const auto values = results(job);
    CHECK(values[0] == DataValue{status::Bad_Timeout});
    CHECK(values[1] == DataValue{Variant{5}});
    CHECK(values[2] == DataValue{status::Bad_Timeout});
}

TEST_CASE_METHOD(AttributeFixture, "a Read allocates as often for 1,000 scalars as for 10")
{
    ReadRequest request = read_request({});
    for (int i = 0; i < 1000; ++i) {
        const std::string name = "A variable with a name that is not short " + std::to_string(i);
        request.nodes_to_read.push_back(read_value_id(add(name.c_str(), id::Int32, i)));
    }
    std::vector<std::byte> buffer(1 << 20);
    const auto count = [&](std::size_t size) {
        binary::SpanSink sink{buffer};
        binary::Writer writer{sink};
        request.nodes_to_read.resize(size);
        encode(writer, request);
        const std::vector<std::byte> message{
            buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(writer.written())};

        const std::size_t before = test::allocation_count();
        binary::Reader reader{message, binary::Strings::Borrow};
        ReadRequest decoded;
        decode(reader, decoded);
        auto job = read_job(decoded);
        const bool is_done = job.start(owner, TimePoint{});
        job.finish();
        binary::SpanSink out{buffer};
        binary::Writer answer{out};
        job.encode_results(answer, DateTime{});
        const std::size_t after = test::allocation_count();
        REQUIRE(is_done);
        REQUIRE(answer.ok());
        REQUIRE(answer.written() == 4 + size * 6 + 4);
        return after - before;
    };
    const std::size_t for_1000 = count(1000);
    const std::size_t for_10 = count(10);
    CAPTURE(for_10);
    CHECK(for_1000 == for_10);
    CHECK(for_10 <= 10);
}

TEST_CASE("a value that a source gave meanwhile has its time as the server's, too")
{
    const auto at = [](std::int64_t seconds) {
        return DateTime{seconds * DateTime::ticks_per_second};
    };
    const server::detail::Timestamps asked{TimestampsToReturn::Both, at(10)};
    CHECK(asked.of_answer(at(12), at(15)).server == at(12));
    CHECK(asked.of_answer(at(8), at(15)).server == at(10));  // it was there before
    CHECK(asked.of_answer(at(99), at(15)).server == at(15)); // by a clock that is ahead
    CHECK(asked.of_answer(DateTime{}, at(15)).server == at(10));
    const server::detail::Timestamps unwanted{TimestampsToReturn::Source, at(10)};
    CHECK(unwanted.of_answer(at(12), at(15)).server.is_null());
}

} // namespace read_test
