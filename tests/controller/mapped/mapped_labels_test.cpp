#include "mapped_fixture.hpp"

namespace mapped_labels_test {

using namespace busbar;
using namespace busbar::test;

namespace {

struct Fixture : MappedFixture {
    Fixture()
    {
        plc->add("Speed", LabelType::Word, std::int16_t{1480});
        plc->add("Other", LabelType::Word, std::int16_t{3});
        speed = add("speed", id::Int16, {"Speed"});
        other = add("other", id::Int16, {"Other"});
        model::NewVariable kept;
        kept.data_type = NodeId{0, id::Int16};
        kept.value = Variant{std::int16_t{7}};
        REQUIRE(server.address_space().add_variable(named("kept"), kept));
    }
    /// What the update that was made came to.
    using Events = std::vector<LabelUpdate>;

    NodeId speed;
    NodeId other;
};

/// A label that cannot be used costs its nodes only.
struct Isolated : MappedFixture {
    Isolated() : MappedFixture{options()}
    {
        plc->add("Speed", LabelType::Word, std::int16_t{1480});
        plc->add("Other", LabelType::Word, std::int16_t{3});
        speed = add("speed", id::Int16, {"Speed"});
        other = add("other", id::Int16, {"Other"});
        both = add("both", id::Int16, {"Speed", "Other"});
    }
    static MappedOptions options()
    {
        MappedOptions options;
        options.isolates_failures = true;
        return options;
    }

    NodeId speed;
    NodeId other;
    NodeId both;
};

const Fixture::Events well{LabelUpdate::Started, LabelUpdate::Finished};
const Fixture::Events failed{LabelUpdate::Started, LabelUpdate::Failed};

} // namespace

TEST_CASE_METHOD(Fixture, "8.3 Label update: all labels are resolved in one at start", "[8.3]")
{
    CHECK(read(speed).status == status::Bad_NoCommunication);
    source.start();
    CHECK(plc->started[LabelRequest::Kind::Resolve] == 1);
    CHECK(book.events == well);
    CHECK_FALSE(source.is_updating());
    CHECK(source.target_status() == controller::TargetStatus::Communicating);
}

TEST_CASE("8.3 Label update: nothing is done without labels", "[8.3]")
{
    MappedFixture fixture;
    fixture.source.start();
    CHECK(fixture.book.events.empty());
    CHECK(fixture.plc->started.empty());
}

TEST_CASE_METHOD(Fixture, "A source that is stopped lets go of the PLC and can begin again",
                 "[8.3]")
{
    CHECK(plc->listener == nullptr);
    source.start();
    plc->is_prompt = false;
    const auto asked = send_read({speed});
    source.stop();
    CHECK(plc->listener == nullptr);
    CHECK(take_read(asked)[0].status == status::Bad_NoCommunication);
    CHECK(read(speed).status == status::Bad_NoCommunication);
    plc->answer(); // which is for nobody
    plc->is_prompt = true;
    source.start();
    CHECK(read(speed).value == Variant{std::int16_t{1480}});
    CHECK(book.events == Events{LabelUpdate::Started, LabelUpdate::Finished, LabelUpdate::Started,
                                LabelUpdate::Finished});
}

TEST_CASE_METHOD(Fixture, "8.3 Label update: one bad label fails all mapped nodes", "[8.3]")
{
    MappedErrorCode code{};
    SECTION("1921H")
    {
        plc->labels.erase("Other");
        code = MappedErrorCode::Unavailable;
    }
    SECTION("1A00H")
    {
        plc->labels["Other"].kind = {LabelType::Float};
        plc->labels["Other"].kind.type = LabelType::UnicodeString;
        code = MappedErrorCode::WrongType;
    }
    source.start();
    CHECK(book.events == failed);
    CHECK(book.errors == std::vector{code});
    CHECK(book.label == "Other");
    CHECK(book.node == other);
    CHECK(read(speed).status == status::Bad_NoCommunication);
    CHECK(write({{speed, Variant{std::int16_t{1}}}})[0] == status::Bad_NoCommunication);
    CHECK(read(own("kept")).status == status::Good);
}

TEST_CASE_METHOD(Fixture, "8.3 Label update: a mismatch has labels resolved and is repeated",
                 "[8.3]")
{
    source.start();
    book.events.clear();
    plc->move_labels();
    CHECK(read(speed).value == Variant{std::int16_t{1480}});
    CHECK(book.events == well);
    plc->move_labels();
    CHECK(write({{speed, Variant{std::int16_t{9}}}})[0] == status::Good);
    CHECK(plc->get<std::int16_t>("Speed") == 9);
    CHECK(plc->started[LabelRequest::Kind::Resolve] == 3);
}

TEST_CASE_METHOD(Fixture, "8.3 Label update: requests wait for it", "[8.3]")
{
    source.start();
    plc->is_prompt = false;
    plc->move_labels();
    const auto first = send_read({speed});
    const auto second = send_read({other});
    plc->answer();
    plc->answer();
    CHECK(take_read(first).empty());
    CHECK(source.is_updating());
    const auto third = send_read({speed, other});
    plc->answer();
    plc->is_prompt = true;
    complete();
    while (!plc->requests.empty()) {
        plc->answer();
    }
    CHECK(take_read(first)[0].value == Variant{std::int16_t{1480}});
    CHECK(take_read(second)[0].value == Variant{std::int16_t{3}});
    CHECK(take_read(third).size() == 2);
    CHECK(plc->started[LabelRequest::Kind::Resolve] == 2);
}

TEST_CASE_METHOD(Fixture, "8.3 Label update: labels that change for ever fail the request", "[8.3]")
{
    source.start();
    plc->memory.clear();
    CHECK(read(speed).status == status::Bad_NoCommunication);
    CHECK(plc->started[LabelRequest::Kind::Resolve] == 4);
}

TEST_CASE_METHOD(Fixture, "8.3 Label update: what was announced is resolved", "[8.3]")
{
    source.start();
    plc->move_labels(true);
    complete();
    CHECK(plc->started[LabelRequest::Kind::Resolve] == 2);
    CHECK(read(speed).status == status::Good);
    plc->labels.erase("Other");
    plc->listener->labels_changed();
    complete();
    CHECK(read(speed).status == status::Bad_NoCommunication);
    plc->add("Other", LabelType::Word, std::int16_t{4});
    plc->listener->labels_changed();
    complete();
    CHECK(read(other).value == Variant{std::int16_t{4}});
}

TEST_CASE_METHOD(Fixture, "8.3 Label update: a PLC that is away is asked again", "[8.3]")
{
    plc->fault = LabelStatus::NoCommunication;
    source.start();
    CHECK(book.events == failed);
    CHECK(read(speed).status == status::Bad_NoCommunication);
    CHECK(book.events == failed);
    CHECK(source.target_status() == controller::TargetStatus::Failing);
    plc->fault = LabelStatus::Done;
    CHECK(read(speed).status == status::Good);
    CHECK(book.events == Events{LabelUpdate::Started, LabelUpdate::Failed, LabelUpdate::Started,
                                LabelUpdate::Finished});
}

TEST_CASE_METHOD(Fixture, "8.3 Label update: an answer by the labels before is not taken", "[8.3]")
{
    source.start();
    plc->is_prompt = false;
    const auto sent = send_read({speed});
    plc->move_labels(true);
    complete(); // the update is asked for
    REQUIRE(plc->requests.size() == 2);
    std::swap(plc->requests[0], plc->requests[1]);
    plc->answer();
    auto late = std::move(plc->requests.front());
    plc->requests.pop_front();
    late->status = LabelStatus::Done;
    plc->listener->done(std::move(late));
    plc->is_prompt = true;
    CHECK(take_read(sent)[0].value == Variant{std::int16_t{1480}});
}

TEST_CASE_METHOD(Isolated, "8.3 Isolated failures: a bad label costs the nodes that have it",
                 "[8.3]")
{
    MappedErrorCode code{};
    SECTION("1921H")
    {
        plc->labels.erase("Other");
        code = MappedErrorCode::Unavailable;
    }
    SECTION("1A00H")
    {
        plc->labels["Other"].kind.type = LabelType::String;
        code = MappedErrorCode::WrongType;
    }
    source.start();
    CHECK(book.events == well);
    CHECK(book.errors == std::vector{code, code}); // of both nodes that have it
    CHECK(book.label == "Other");
    const auto values = read({speed, other, both});
    CHECK(values[0].value == Variant{std::int16_t{1480}});
    CHECK(values[1].status == status::Bad_NoCommunication);
    CHECK(values[2].status == status::Bad_NoCommunication);
    CHECK(write({{speed, Variant{std::int16_t{5}}}})[0] == status::Good);
    CHECK(write({{other, Variant{std::int16_t{5}}}})[0] == status::Bad_NoCommunication);
    // A Write is for all or none, whatever is isolated.
    const auto mixed =
        write({{speed, Variant{std::int16_t{6}}}, {other, Variant{std::int16_t{6}}}});
    CHECK(mixed[0] == status::Bad_NoCommunication);
    CHECK(mixed[1] == status::Bad_NoCommunication);
    CHECK(read(speed).value == Variant{std::int16_t{5}});
    // It is well again when the label is.
    plc->add("Other", LabelType::Word, std::int16_t{4});
    plc->move_labels(true);
    static_cast<void>(read(other)); // which finds that labels are others
    CHECK(read(other).value == Variant{std::int16_t{4}});
    CHECK(read(both).status == status::Good);
}

TEST_CASE_METHOD(Isolated, "8.3 Isolated failures: a value that its node cannot have", "[8.3]")
{
    const NodeId narrow = add("narrow", id::SByte, {"Speed"});
    source.start();
    const auto values = read({narrow, other});
    CHECK(values[0].status == status::Bad_NoCommunication);
    CHECK(values[1].value == Variant{std::int16_t{3}});
    CHECK(book.errors == std::vector{MappedErrorCode::OutOfRange});
    CHECK(book.node == own("narrow"));
}

} // namespace mapped_labels_test
