#include "mapped_fixture.hpp"

namespace mapped_read_test {

using namespace busbar;
using namespace busbar::test;

namespace {

struct Fixture : MappedFixture {
    Fixture() : MappedFixture{} { set_up(); }
    explicit Fixture(const MappedOptions& options) : MappedFixture{options} { set_up(); }
    void set_up()
    {
        plc->add("Speed", LabelType::Word, std::int16_t{1480});
        plc->add("A[0]", LabelType::Word, std::int16_t{1});
        plc->add("A[1]", LabelType::Word, std::int16_t{2});
        plc->add("A[2]", LabelType::Word, std::int16_t{3});
        plc->add("Wide", LabelType::DoubleWord, std::int32_t{70'000});
        speed = add("speed", id::Int16, {"Speed"});
        array = add("array", id::Int16, {"A[0]", "A[1]", "A[2]"});
        wide = add("wide", id::Int16, {"Wide"});
        model::NewVariable kept;
        kept.data_type = NodeId{0, id::Int16};
        kept.value = Variant{std::int16_t{7}};
        REQUIRE(server.address_space().add_variable(named("kept"), kept));
    }

    NodeId speed;
    NodeId array;
    NodeId wide;
};

struct SmallLimits : Fixture {
    static MappedOptions limits()
    {
        MappedOptions options;
        options.limits.max_labels = 3;
        return options;
    }
    SmallLimits() : Fixture{limits()} {}
};

} // namespace

TEST_CASE_METHOD(Fixture, "8.3 Read: all labels of a request are read in one", "[8.1][8.3]")
{
    source.start();
    plc->sizes.clear();
    const auto results = read({speed, array});
    REQUIRE(results.size() == 2);
    CHECK(results[0].value == Variant{std::int16_t{1480}});
    CHECK(results[0].status == status::Good);
    CHECK(results[0].source_timestamp == plc->time);
    CHECK(results[1].value == Variant{Array<std::int16_t>{1, 2, 3}});
    CHECK(plc->sizes == std::vector<std::size_t>{4});
}

TEST_CASE_METHOD(Fixture, "8.1 Read: an IndexRange is cut out of the value", "[8.1]")
{
    source.start();
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.nodes_to_read = {value_of(array, "1:2")};
    const auto sent = client->send(request);
    complete();
    const auto response = client->take<ReadResponse>(sent);
    REQUIRE(response);
    CHECK(response->results[0].value == Variant{Array<std::int16_t>{2, 3}});
}

TEST_CASE_METHOD(Fixture, "8.3 Read: nodes of one request fail together", "[8.3]")
{
    source.start();
    const auto results = read({speed, wide});
    REQUIRE(results.size() == 2);
    CHECK(results[0].status == status::Bad_NoCommunication);
    CHECK(results[1].status == status::Bad_NoCommunication);
    CHECK(book.errors == std::vector{MappedErrorCode::OutOfRange});
    CHECK(book.label == "Wide");
    CHECK(book.node == wide);
    CHECK(read(speed).status == status::Good);
}

TEST_CASE_METHOD(SmallLimits, "8.1 Read: more labels than a request may have", "[8.1]")
{
    source.start();
    CHECK(read(array).status == status::Good);
    const auto results = read({speed, array});
    REQUIRE(results.size() == 2);
    CHECK(results[0].status == status::Bad_NoCommunication);
    CHECK(results[1].status == status::Bad_NoCommunication);
    CHECK(plc->started[LabelRequest::Kind::Read] == 1);
}

TEST_CASE_METHOD(Fixture, "8.1 Read: what the PLC answers", "[8.1]")
{
    source.start();
    plc->fault = LabelStatus::NoCommunication; // others: mapped_service_results_test.cpp
    CHECK(read(speed).status == status::Bad_NoCommunication);
    CHECK(write({{speed, Variant{std::int16_t{1}}}})[0] == status::Bad_NoCommunication);
}

TEST_CASE_METHOD(Fixture, "8.1 Read: an unsupported Variable answers for itself only", "[8.1]")
{
    const NodeId none = add("none", id::Int16, 0, {own("none"), nullptr, {"Speed"}, {}});
    source.start();
    const auto results = read({none, speed});
    REQUIRE(results.size() == 2);
    CHECK(results[0].status == status::Bad_NotSupported);
    CHECK(results[1].status == status::Good);
    CHECK(write({{none, Variant{std::int16_t{1}}}})[0] == status::Bad_NotSupported);
    CHECK(read(none).status == status::Bad_NotSupported);
}

TEST_CASE_METHOD(Fixture, "8.1 Read: a label for a type that has none costs its Variable only",
                 "[8.1][8.2]")
{
    const NodeId guid = add("guid", id::Guid, {"Speed"});
    source.start();
    CHECK(book.errors.empty());
    const auto results = read({guid, speed});
    REQUIRE(results.size() == 2);
    CHECK(results[0].status == status::Bad_NotSupported);
    CHECK(results[1].status == status::Good);
    CHECK(write({{guid, Variant{Guid{}}}})[0] == status::Bad_NotSupported);
}

TEST_CASE_METHOD(Fixture, "8.3 Read: parts without a label keep their values", "[8.3]")
{
    const NodeId part =
        add("part", id::Int16, {"A[0]", "", "A[2]"}, Variant{Array<std::int16_t>{40, 50, 60}});
    source.start();
    CHECK(read(part).value == Variant{Array<std::int16_t>{1, 50, 3}});
    REQUIRE(write({{part, Variant{Array<std::int16_t>{5, 6, 7}}}})[0] == status::Good);
    plc->set("A[2]", std::int16_t{70});
    CHECK(read(part).value == Variant{Array<std::int16_t>{5, 6, 70}});
}

TEST_CASE_METHOD(Fixture, "8.3 Write: the labels of a request are written in one", "[8.3]")
{
    source.start();
    plc->sizes.clear();
    const auto results =
        write({{speed, Variant{std::int16_t{5}}}, {array, Variant{Array<std::int16_t>{7, 8, 9}}}});
    CHECK(results == Array<StatusCode>{status::Good, status::Good});
    CHECK(plc->sizes == std::vector<std::size_t>{4});
    CHECK(plc->get<std::int16_t>("Speed") == 5);
    CHECK(plc->get<std::int16_t>("A[2]") == 9);
}

TEST_CASE_METHOD(Fixture, "8.1 Write: what is refused, all or none", "[8.1]")
{
    plc->add("Narrow", LabelType::Word, std::int16_t{0});
    const NodeId narrow = add("narrow", id::Int32, {"Narrow"});
    source.start();
    CHECK(write({{speed, Variant{std::int16_t{5}}}, {narrow, Variant{std::int32_t{40'000}}}}) ==
          Array<StatusCode>{status::Bad_NoCommunication, status::Bad_OutOfRange});
    CHECK(write({{array, Variant{Array<std::int16_t>{1, 2}}}})[0] == status::Bad_WriteNotSupported);
    CHECK(write({{array, Variant{Array<std::int16_t>{1}}}}, "1")[0] ==
          status::Bad_WriteNotSupported);
    CHECK(plc->get<std::int16_t>("Speed") == 1480);
    CHECK(plc->started[LabelRequest::Kind::Write] == 0);
}

TEST_CASE_METHOD(Fixture, "A quality label is the status of the value", "[8.3]")
{
    plc->add("Q", LabelType::Word, std::int16_t{0});
    plc->add("Code", LabelType::UnsignedDoubleWord, std::uint32_t{0});
    MappedVariable by_word{own("by word"), shape(id::Int16), {"Speed"}};
    by_word.quality = "Q";
    MappedVariable by_code{own("by code"), shape(id::Int16, 3), {"A[0]", "A[1]", "A[2]"}};
    by_code.quality = "Code";
    const NodeId first = add("by word", id::Int16, 0, std::move(by_word));
    const NodeId second = add("by code", id::Int16, 3, std::move(by_code));
    source.start();
    plc->sizes.clear();
    auto values = read({first, second, speed});
    CHECK(plc->sizes == std::vector<std::size_t>{7}); // in one request with the values
    CHECK(values[0].status == status::Good);
    CHECK(values[0].value == Variant{std::int16_t{1480}});
    CHECK(values[1].value == Variant{Array<std::int16_t>{1, 2, 3}});
    CHECK(values[2].value == Variant{std::int16_t{1480}});
    plc->set("Q", std::int16_t{-1});
    plc->set("Code", status::Uncertain_LastUsableValue.value());
    values = read({first, second, speed});
    CHECK(values[0].status == status::Bad_DeviceFailure);
    CHECK(values[0].value.is_null());
    CHECK(values[0].source_timestamp == plc->time);
    CHECK(values[1].status == status::Uncertain_LastUsableValue);
    CHECK(values[1].value == Variant{Array<std::int16_t>{1, 2, 3}});
    CHECK(values[2].status == status::Good);
    // What is no StatusCode, and bits of one that are the server's.
    plc->set("Code", std::uint32_t{0xC0000000});
    CHECK(read(second).status == status::Bad_DeviceFailure);
    plc->set("Code", std::uint32_t{0x80310480});
    CHECK(read(second).status == status::Bad_NoCommunication);
    // A value that the node cannot have costs nobody else anything while it does not count.
    plc->set("Q", std::int16_t{0});
    CHECK(write({{first, Variant{std::int16_t{9}}}})[0] == status::Good);
    CHECK(plc->get<std::int16_t>("Speed") == 9);
    CHECK(plc->get<std::int16_t>("Q") == 0);
}

TEST_CASE_METHOD(Fixture, "A bad quality comes before a value that is out of range", "[8.3]")
{
    plc->add("Q", LabelType::Bit, std::uint8_t{1});
    MappedVariable narrow{own("narrow"), shape(id::Int16), {"Wide"}};
    narrow.quality = "Q";
    const NodeId node = add("narrow", id::Int16, 0, std::move(narrow));
    source.start();
    const auto values = read({node, speed});
    CHECK(values[0].status == status::Bad_DeviceFailure);
    CHECK(values[1].status == status::Good);
    CHECK(book.errors.empty());
}

TEST_CASE_METHOD(Fixture, "A quality label of another type is told as any (1A00H)", "[8.3]")
{
    plc->add("Q", LabelType::Float, 0.0F);
    MappedVariable rated{own("rated"), shape(id::Int16), {"Speed"}};
    rated.quality = "Q";
    static_cast<void>(add("rated", id::Int16, 0, std::move(rated)));
    source.start();
    CHECK(book.errors == std::vector{MappedErrorCode::WrongType});
    CHECK(book.label == "Q");
}

TEST_CASE_METHOD(Fixture, "Scaled labels are read and written", "[8.3]")
{
    MappedVariable scaled{own("scaled"), shape(id::Double, 3), {"A[0]", "A[1]", "A[2]"}};
    scaled.scaling = {0, 1'000, 0, 10};
    const NodeId node = add("scaled", id::Double, 3, std::move(scaled));
    source.start();
    plc->set("A[1]", std::int16_t{500});
    plc->set("A[2]", std::int16_t{-100});
    CHECK(read(node).value == Variant{Array<double>{0.01, 5, -1}});
    CHECK(write({{node, Variant{Array<double>{7.5, 0, 10}}}})[0] == status::Good);
    CHECK(plc->get<std::int16_t>("A[0]") == 750);
    CHECK(plc->get<std::int16_t>("A[2]") == 1'000);
    CHECK(write({{node, Variant{Array<double>{0, 0, 400}}}})[0] == status::Bad_OutOfRange);
    CHECK(plc->get<std::int16_t>("A[0]") == 750);
}

} // namespace mapped_read_test
