#include <catch2/catch.hpp>

#include "attribute_fixture.hpp"

namespace write_test {

using namespace busbar;
using namespace std::chrono_literals;
using busbar::server::detail::check_write;
using busbar::server::detail::WriteJob;
using busbar::test::AttributeFixture;

namespace {

struct WriteFixture : AttributeFixture {
    NodeId add_far(const char* name, std::uint32_t data_type, std::int32_t value_rank = -1)
    {
        model::NewVariable variable;
        variable.data_type = NodeId{0, data_type};
        variable.value_rank = value_rank;
        variable.access_level = model::Access::ReadWrite;
        variable.source = far_index();
        return add(name, variable);
    }
    std::uint32_t far_index()
    {
        if (far_index_ == 0) {
            far_index_ = sources.add(far);
        }
        return far_index_;
    }
    Variant value_of(const NodeId& node) { return read(node).value; }

    test::KeepingSource& far{make_source<test::KeepingSource>()};
    std::uint32_t far_index_{0};
};

} // namespace

TEST_CASE("a Write that is wrong as a whole is refused (Part 4, 5.11.4.3)")
{
    WriteRequest request;
    CHECK(check_write(request, 1) == status::Bad_NothingToDo);
    request.nodes_to_write.resize(2);
    CHECK(check_write(request, 1) == status::Bad_TooManyOperations);
    CHECK(check_write(request, 2) == status::Good);
}

TEST_CASE_METHOD(WriteFixture, "values are written; each item has its own result",
                 "[unit:Attribute Write Values]")
{
    const NodeId speed = add("Speed", id::Int16, std::int16_t{7});
    const NodeId name = add("Name", id::String, "Press 1");
    const NodeId fixed = add("Fixed", id::Int16, std::int16_t{1}, model::Access::Read);
    WriteRequest request;
    request.nodes_to_write = {write_value(speed, Variant{std::int16_t{8}}),
                              write_value(fixed, Variant{std::int16_t{8}}),
                              write_value(name, Variant{"Press 2"}),
                              write_value(NodeId{namespace_index, "None"}, Variant{1}),
                              write_value(speed, Variant{std::int16_t{9}})};
    CHECK(write(request) == std::vector{status::Good, status::Bad_NotWritable, status::Good,
                                        status::Bad_NodeIdUnknown, status::Good});
    CHECK(value_of(speed) == Variant{std::int16_t{9}});
    CHECK(value_of(name) == Variant{"Press 2"});
    CHECK(value_of(fixed) == Variant{std::int16_t{1}});
}

TEST_CASE_METHOD(WriteFixture, "only Values of Variables can be written")
{
    const NodeId speed = add("Speed", id::Int16, std::int16_t{7});
    const DataValue text{Variant{LocalizedText{"", "Faster"}}};
    CHECK(write(speed, text, nullptr, AttributeId::DisplayName) == status::Bad_NotWritable);
    CHECK(write(speed, text, nullptr, AttributeId::WriteMask) == status::Bad_NotWritable);
    CHECK(write(speed, text, nullptr, AttributeId::IsAbstract) == status::Bad_AttributeIdInvalid);
    CHECK(write(speed, text, nullptr, static_cast<AttributeId>(99)) ==
          status::Bad_AttributeIdInvalid);
    CHECK(write(NodeId{0, id::ObjectsFolder}, text) == status::Bad_AttributeIdInvalid);
    CHECK(write(NodeId{0, id::BaseVariableType}, text) == status::Bad_NotWritable);
    CHECK(write(NodeId{}, text) == status::Bad_NodeIdInvalid);
}

TEST_CASE_METHOD(WriteFixture, "a user without the right is refused")
{
    const NodeId speed = add("Speed", id::Int32, 7);
    user.access_level_mask = static_cast<std::uint8_t>(model::Access::Read);
    CHECK(write(speed, Variant{8}) == status::Bad_UserAccessDenied);
    CHECK(value_of(speed) == Variant{7});
}

TEST_CASE_METHOD(WriteFixture, "a value has the Variable's type and shape")
{
    const NodeId speed = add("Speed", id::Int16, std::int16_t{7});
    const NodeId levels =
        add("Levels", id::Double, Array<double>{1, 2}, model::Access::ReadWrite, 1);
    const NodeId time = add("Time", id::UtcTime, DateTime{5});
    const NodeId number = add("Number", id::Number, 1);
    const NodeId anything = add("Anything", id::BaseDataType, 1, model::Access::ReadWrite, -2);

    for (const Variant& wrong :
         {Variant{8}, Variant{"8"}, Variant{Array<std::int16_t>{8}}, Variant{}, Variant{true}}) {
        CHECK(write(speed, wrong) == status::Bad_TypeMismatch);
    }
    CHECK(write(levels, Variant{1.0}) == status::Bad_TypeMismatch);
    CHECK(write(levels, Variant{Array<float>{1}}) == status::Bad_TypeMismatch);
    CHECK(write(levels, Variant{Array<double>{}}) == status::Good);
    CHECK(write(levels, Variant::matrix(Array<double>{1}, Array<std::uint32_t>{1, 1})) ==
          status::Bad_TypeMismatch);
    CHECK(write(time, Variant{DateTime{6}}) == status::Good);
    CHECK(write(number, Variant{std::uint8_t{6}}) == status::Good);
    CHECK(write(number, Variant{"6"}) == status::Bad_TypeMismatch);
    CHECK(write(anything, Variant{Array<String>{"x"}}) == status::Good);
    CHECK(value_of(speed) == Variant{std::int16_t{7}});
}

TEST_CASE_METHOD(WriteFixture, "an enumeration takes its own values only (Part 4, 5.11.4.4)")
{
    const auto add_enumeration = [&](const char* name, const NodeId& base,
                                     std::initializer_list<std::int64_t> values) {
        EnumDefinition definition;
        for (const std::int64_t value : values) {
            definition.fields.push_back({});
            definition.fields.back().value = value;
            definition.fields.back().name = String{"V" + std::to_string(value)};
        }
        model::NewNode node;
        node.id = NodeId{namespace_index, name};
        node.browse_name = QualifiedName{namespace_index, name};
        node.parent = space.find(base);
        REQUIRE(space.add_data_type(node, {ExtensionObject::from(std::move(definition)), false}));
        return node.id;
    };
    const auto add_variable = [&](const char* name, const NodeId& data_type, Variant value,
                                  std::int32_t rank = -1) {
        model::NewVariable variable;
        variable.data_type = data_type;
        variable.value_rank = rank;
        variable.access_level = model::Access::ReadWrite;
        variable.value = std::move(value);
        return add(name, variable);
    };
    const NodeId modes = add_enumeration("Modes", NodeId{0, id::Enumeration}, {0, 1, 2});
    const NodeId sparse = add_enumeration("Sparse", modes, {-5, 1, 700});
    const NodeId mode = add_variable("Mode", modes, Variant{0});
    const NodeId level = add_variable("Level", sparse, Variant{1});
    const NodeId all = add_variable("All", sparse, Variant{Array<std::int32_t>{1, 1}}, 1);
    const NodeId any = add_variable("Any", NodeId{0, id::Enumeration}, Variant{0});
    for (const std::int32_t good : {0, 1, 2}) {
        CHECK(write(mode, Variant{good}) == status::Good);
    }
    for (const std::int32_t bad : {-1, 3, INT32_MIN, INT32_MAX}) {
        CHECK(write(mode, Variant{bad}) == status::Bad_OutOfRange);
    }
    CHECK(value_of(mode) == Variant{2});
    CHECK(write(mode, Variant{std::uint8_t{1}}) == status::Bad_TypeMismatch);
    for (const std::int32_t good : {-5, 700, 1}) {
        CHECK(write(level, Variant{good}) == status::Good);
    }
    for (const std::int32_t bad : {0, 2, 699}) {
        CHECK(write(level, Variant{bad}) == status::Bad_OutOfRange);
    }
    CHECK(write(all, Variant{Array<std::int32_t>{700, 2}}) == status::Bad_OutOfRange);
    CHECK(write(all, Variant{Array<std::int32_t>{2}}, "1") == status::Bad_OutOfRange);
    CHECK(write(all, Variant{Array<std::int32_t>{-5}}, "1") == status::Good);
    CHECK(value_of(all) == Variant{Array<std::int32_t>{1, -5}});
    CHECK(write(any, Variant{12'345}) == status::Good); // which has no values of its own
}

TEST_CASE_METHOD(WriteFixture, "a ByteString is taken for an array of Byte (Part 4, 5.11.4.2)")
{
    const NodeId bytes =
        add("Bytes", id::Byte, Array<std::uint8_t>{1, 2, 3}, model::Access::ReadWrite, 1);
    const NodeId byte = add("Byte", id::Byte, std::uint8_t{1});
    const NodeId blob = add("Blob", id::ByteString, ByteString{});
    const std::byte raw[] = {std::byte{8}, std::byte{9}};

    CHECK(write(bytes, Variant{ByteString{raw}}) == status::Good);
    CHECK(value_of(bytes) == Variant{Array<std::uint8_t>{8, 9}});
    CHECK(write(bytes, Variant{ByteString{std::span{raw}.first(1)}}, "1") == status::Good);
    CHECK(value_of(bytes) == Variant{Array<std::uint8_t>{8, 8}});
    CHECK(write(byte, Variant{ByteString{raw}}) == status::Bad_TypeMismatch);
    CHECK(write(blob, Variant{ByteString{raw}}) == status::Good);
    CHECK(write(blob, Variant{Array<std::uint8_t>{1}}) == status::Bad_TypeMismatch);
}

TEST_CASE_METHOD(WriteFixture, "a part of a value can be written where the source can do it")
{
    const NodeId levels =
        add("Levels", id::Int32, Array<std::int32_t>{1, 2, 3}, model::Access::ReadWrite, 1);
    const NodeId name = add("Name", id::String, "Press");
    CHECK(write(levels, Variant{Array<std::int32_t>{8, 9}}, "1:2") == status::Good);
    CHECK(value_of(levels) == Variant{Array<std::int32_t>{1, 8, 9}});
    CHECK(write(name, Variant{"ur"}, "1:2") == status::Good);
    CHECK(value_of(name) == Variant{"Purss"});

    CHECK(write(levels, Variant{Array<std::int32_t>{1}}, "3") == status::Bad_IndexRangeNoData);
    CHECK(write(levels, Variant{Array<std::int32_t>{1}}, "1:2") ==
          status::Bad_IndexRangeDataMismatch);
    CHECK(write(levels, Variant{Array<std::int32_t>{1}}, "0,0").is_bad());
    CHECK(write(levels, Variant{Array<double>{1}}, "0") == status::Bad_TypeMismatch);
    CHECK(write(levels, Variant{}, "0") == status::Bad_TypeMismatch);
    CHECK(write(levels, Variant{Array<std::int32_t>{1}}, "1:0") == status::Bad_IndexRangeInvalid);
    CHECK(write(add_far("Far", id::Int32, 1), Variant{Array<std::int32_t>{1}}, "0") ==
          status::Bad_WriteNotSupported);
    // A row that is longer than the array of strings.
    const NodeId names =
        add("Names", id::String, Array<String>{"a", "b", "c"}, model::Access::ReadWrite, 1);
    CHECK(write(names, Variant{Array<String>{"x"}}, "0:2,0").is_bad());
    CHECK(value_of(names) == Variant{Array<String>{"a", "b", "c"}});
}

TEST_CASE_METHOD(WriteFixture, "an IndexRange is written and read of any shape (Part 4, 7.27)",
                 "[unit:Attribute Write Index]")
{
    const auto both_ways = [&](const NodeId& node, const char* range, const Variant& part,
                               const Variant& whole) {
        INFO(range);
        CHECK(write(node, part, range) == status::Good);
        CHECK(read(node, AttributeId::Value, range).value == part);
        CHECK(value_of(node) == whole);
    };
    const auto bytes = [](std::string_view text) {
        return Variant{ByteString{std::as_bytes(std::span{text})}};
    };
    const auto matrix = [](Array<std::int32_t> values, std::uint32_t rows, std::uint32_t columns) {
        return Variant::matrix(std::move(values), {rows, columns});
    };
    both_ways(add("Bytes", id::ByteString, bytes("abcd")), "1:2", bytes("BC"), bytes("aBCd"));
    const NodeId grid =
        add("Grid", id::Int32, matrix({1, 2, 3, 4, 5, 6}, 2, 3), model::Access::ReadWrite, 2);
    both_ways(grid, "0:1,1", matrix({20, 50}, 2, 1), matrix({1, 20, 3, 4, 50, 6}, 2, 3));
    both_ways(grid, "1,0:2", matrix({7, 8, 9}, 1, 3), matrix({1, 20, 3, 7, 8, 9}, 2, 3));
    CHECK(write(grid, matrix({1, 2}, 1, 2), "0:1,1") == status::Bad_IndexRangeDataMismatch);
    CHECK(write(grid, Variant{Array<std::int32_t>{1}}, "2,0").is_bad());
    const NodeId names =
        add("Texts", id::String, Array<String>{"alpha", "beta"}, model::Access::ReadWrite, 1);
    both_ways(names, "1", Array<String>{"gamma"}, Array<String>{"alpha", "gamma"});
    both_ways(names, "0:1,1:2", Array<String>{"LP", "AM"}, Array<String>{"aLPha", "gAMma"});
    CHECK(write(names, Variant{Array<String>{"x", "y"}}, "0:1,9") == status::Bad_IndexRangeNoData);
    CHECK(value_of(names) == Variant{Array<String>{"aLPha", "gAMma"}});
}

TEST_CASE_METHOD(WriteFixture, "status and timestamps are written only where that is allowed",
                 "[unit:Attribute Write StatusCode & Timestamp]")
{
    constexpr model::Access everything =
        model::Access::ReadWrite | model::Access::StatusWrite | model::Access::TimestampWrite;
    const NodeId plain = add("Plain", id::Int32, 7);
    const NodeId open = add("Open", id::Int32, 7, everything);
    const DateTime then{12345};
    const DataValue with_status{Variant{8}, status::Uncertain_InitialValue};
    const DataValue with_time{Variant{8}, {}, then};
    DataValue with_server_time{Variant{8}};
    with_server_time.server_timestamp = then;

    CHECK(write(plain, with_status) == status::Bad_WriteNotSupported);
    CHECK(write(plain, with_time) == status::Bad_WriteNotSupported);
    CHECK(write(plain, with_server_time) == status::Bad_WriteNotSupported);
    CHECK(value_of(plain) == Variant{7});
    CHECK(write(open, with_status) == status::Good);
    CHECK(read(open).status == status::Uncertain_InitialValue);
    CHECK(write(open, with_time) == status::Good);
    CHECK(memory.get(1).source_timestamp == then);
    CHECK(write(open, with_server_time) == status::Bad_WriteNotSupported);
}

TEST_CASE_METHOD(WriteFixture, "the address space keeps what has no source")
{
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value_rank = 1;
    variable.access_level = model::Access::ReadWrite;
    variable.value = Variant{Array<std::int32_t>{1, 2}};
    const NodeId kept = add("Kept", variable);
    CHECK(write(kept, Variant{Array<std::int32_t>{3}}, "0") == status::Good);
    CHECK(value_of(kept) == Variant{Array<std::int32_t>{3, 2}});
    CHECK(write(kept, Variant{Array<std::int32_t>{3}}, "2") == status::Bad_IndexRangeNoData);
    CHECK(write(kept, Variant{Array<std::int32_t>{}}) == status::Good);
    CHECK(value_of(kept) == Variant{Array<std::int32_t>{}});
}

TEST_CASE_METHOD(WriteFixture, "a source may be given all or nothing")
{
    far.options_.all_or_nothing = true;
    const NodeId a = add_far("A", id::Int32);
    const NodeId b = add_far("B", id::Int32);
    const NodeId near = add("Near", id::Int32, 0);
    WriteRequest request;
    request.nodes_to_write = {write_value(a, Variant{1}), write_value(b, Variant{"1"}),
                              write_value(near, Variant{1})};
    CHECK(write(request) ==
          std::vector{status::Bad_NoCommunication, status::Bad_TypeMismatch, status::Good});
    CHECK(far.writes.empty());
    CHECK(value_of(near) == Variant{1});
}

TEST_CASE_METHOD(WriteFixture, "a source may have too long an array told from another type")
{
    far.options_.has_fixed_lengths = GENERATE(false, true);
    model::NewVariable variable;
    variable.source = far_index();
    variable.data_type = NodeId{0, id::Int32};
    variable.value_rank = 1;
    variable.array_dimensions = {2};
    variable.access_level = model::Access::ReadWrite;
    const NodeId pair = add("Pair", variable);
    CHECK(write(pair, Variant{Array<std::int32_t>{1, 2, 3}}) == (far.options_.has_fixed_lengths
                                                                     ? status::Bad_WriteNotSupported
                                                                     : status::Bad_TypeMismatch));
    CHECK(write(pair, Variant{Array<float>{1, 2, 3}}) == status::Bad_TypeMismatch);
    CHECK(far.writes.empty());
}

TEST_CASE_METHOD(WriteFixture, "a source may use the values after the request is forgotten")
{
    const NodeId name = add_far("Name", id::String);
    const NodeId bytes = add_far("Bytes", id::Byte, 1);
    binary::VectorSink sink;
    binary::Writer writer{sink};
    WriteRequest sent;
    const std::byte raw[] = {std::byte{8}, std::byte{9}};
    sent.nodes_to_write = {write_value(name, Variant{"a text that lies in the message"}),
                           write_value(bytes, Variant{ByteString{raw}})};
    encode(writer, sent);
    std::vector<std::byte> message = sink.take(writer.written());
    {
        binary::Reader reader{message, binary::Strings::Borrow};
        WriteRequest request;
        decode(reader, request);
        REQUIRE(reader.ok());
        server::detail::DefinitionChecks none;
        WriteJob job{sources, request};
        server::detail::Turn endless;
        REQUIRE(job.plan({space, sources, {space, user, control}, none, {}}, endless));
        REQUIRE_FALSE(job.start(owner, TimePoint{}));
        SECTION("it was cancelled")
        {
            job.keep(std::move(request), std::move(message));
        }
        SECTION("it timed out")
        {
            CHECK(job.handle_deadline(TimePoint{5s}));
            CHECK(results(job) == std::vector{status::Bad_Timeout, status::Bad_Timeout});
            job.keep(std::move(request), std::move(message));
        }
    }
    REQUIRE(far.writes.size() == 1);
    CHECK(far.writes[0].items()[0].data->value == Variant{"a text that lies in the message"});
    CHECK(far.writes[0].items()[1].data->value == Variant{Array<std::uint8_t>{8, 9}});
    far.writes.clear();
    sources.handle_completions();
    CHECK(owner.completed == 0);
}

} // namespace write_test
