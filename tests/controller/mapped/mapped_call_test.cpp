#include "mapped_fixture.hpp"

namespace mapped_call_test {

using namespace busbar;
using namespace busbar::test;

namespace {

struct Fixture : MappedFixture {
    Fixture()
    {
        plc->add("H", LabelType::UnsignedWord, std::uint16_t{0});
        plc->add("In", LabelType::Word, std::int16_t{0});
        plc->add("A[0]", LabelType::Word, std::int16_t{0});
        plc->add("A[1]", LabelType::Word, std::int16_t{0});
    }
    /// A Method of an Object and of an ObjectType, with an Int32 and an array of two Int16.
    NodeId add_method(const std::string& name, MappedMethod mapped)
    {
        model::AddressSpace& space = server.address_space();
        model::NewMethod method;
        method.input_arguments = {{"number", NodeId{0, id::Int32}, -1, {}, {}},
                                  {"list", NodeId{0, id::Int16}, 1, {0}, {}}};
        method.source = index;
        mapped.node = own(name);
        method.handle = source.add(std::move(mapped));
        model::NewNode node = named(name);
        if (space.find(own("machine")) == model::no_node) {
            REQUIRE(space.add_object(named("machine")));
            model::NewNode type = named("MachineType");
            type.parent = space.find(NodeId{0, id::BaseObjectType});
            REQUIRE(space.add_object_type(type));
        }
        node.parent = space.find(own("machine"));
        const auto made = space.add_method(node, method);
        REQUIRE(made);
        REQUIRE(space.add_reference(space.find(own("MachineType")), NodeId{0, id::HasComponent},
                                    *made));
        return own(name);
    }
    NodeId add_method(const std::string& name, const std::string& handle)
    {
        return add_method(name, {{},
                                 handle,
                                 {{shape(id::Int32, 0, true), {"In"}},
                                  {shape(id::Int16, 2, true), {"A[0]", "A[1]"}}}});
    }
    std::uint32_t send_call(const NodeId& method, std::int32_t number = 5,
                            Array<std::int16_t> list = {7, 8}, const char* object = "machine")
    {
        CallMethodRequest call;
        call.object_id = own(object);
        call.method_id = method;
        call.input_arguments = {Variant{number}, Variant{std::move(list)}};
        CallRequest request;
        request.methods_to_call = {call};
        return client->send(request);
    }
    CallMethodResult take_call(std::uint32_t id)
    {
        complete();
        const auto response = client->take<CallResponse>(id);
        REQUIRE(response);
        return response->results[0];
    }
    CallMethodResult call(const NodeId& method, std::int32_t number = 5,
                          Array<std::int16_t> list = {7, 8}, const char* object = "machine")
    {
        return take_call(send_call(method, number, std::move(list), object));
    }
};

} // namespace

TEST_CASE_METHOD(Fixture, "8.3 Call: inputs are written before bit 0 of the Handle", "[8.1][8.3]")
{
    const NodeId method = add_method("start", "H");
    source.start();
    plc->is_prompt = false;
    const auto sent = send_call(method);
    REQUIRE(plc->requests.size() == 1);
    CHECK(plc->requests[0]->kind == LabelRequest::Kind::Read);
    plc->answer();
    complete();
    REQUIRE(plc->requests.size() == 1);
    CHECK(plc->requests[0]->kind == LabelRequest::Kind::Write);
    plc->answer();
    CHECK(plc->get<std::int16_t>("In") == 5);
    CHECK(plc->get<std::int16_t>("A[1]") == 8);
    CHECK(plc->get<std::uint16_t>("H") == 0);
    complete();
    REQUIRE(plc->requests.size() == 1);
    plc->answer();
    CHECK(plc->get<std::uint16_t>("H") == 1);
    const auto result = take_call(sent);
    CHECK(result.status_code == status::Good);
    CHECK(result.output_arguments.empty());
}

TEST_CASE_METHOD(Fixture, "8.1 Call: not while the program has the Handle on", "[8.1]")
{
    const NodeId method = add_method("start", "H");
    source.start();
    CHECK(call(method).status_code == status::Good);
    CHECK(call(method, 6).status_code == status::Bad_TooManyOperations);
    CHECK(plc->get<std::int16_t>("In") == 5);
    plc->set("H", std::uint16_t{0});
    CHECK(call(method, 6).status_code == status::Good);
    CHECK(plc->get<std::int16_t>("In") == 6);
}

TEST_CASE_METHOD(Fixture, "8.1 Call: one at a time of a Method", "[8.1]")
{
    const NodeId method = add_method("start", "H");
    source.start();
    plc->is_prompt = false;
    const auto first = send_call(method);
    CHECK(call(method).status_code == status::Bad_TooManyOperations);
    plc->is_prompt = true;
    plc->answer();
    CHECK(take_call(first).status_code == status::Good);
}

TEST_CASE_METHOD(Fixture, "8.1 Call: what is refused", "[8.1]")
{
    const NodeId method = add_method("start", "H");
    const NodeId unmapped = add_method("unmapped", "");
    const NodeId unsupported = add_method("unsupported", {{}, "H", {{nullptr, {"In"}}}});
    source.start();
    CHECK(call(unmapped).status_code == status::Bad_NotImplemented);
    CHECK(call(method, 5, {7, 8}, "MachineType").status_code == status::Bad_NotSupported);
    auto result = call(method, 40'000);
    CHECK(result.status_code == status::Bad_InvalidArgument);
    CHECK(result.input_argument_results == Array<StatusCode>{status::Bad_OutOfRange, status::Good});
    result = call(method, 5, {1, 2, 3});
    CHECK(result.status_code == status::Bad_InvalidArgument);
    CHECK(result.input_argument_results ==
          Array<StatusCode>{status::Good, status::Bad_NotSupported});
    result = call(unsupported);
    CHECK(result.status_code == status::Bad_InvalidArgument);
    CHECK(result.input_argument_results ==
          Array<StatusCode>{status::Bad_NotSupported, status::Good});
    CHECK(plc->get<std::uint16_t>("H") == 0);
    plc->fault = LabelStatus::NoCommunication;
    CHECK(call(method).status_code == status::Bad_NoCommunication);
}

TEST_CASE_METHOD(Fixture, "8.1 Call: inputs without labels are ignored", "[8.1]")
{
    const NodeId method =
        add_method("start", {{}, "H", {{nullptr, {}}, {shape(id::Int16, 2, true), {"A[0]", ""}}}});
    source.start();
    CHECK(call(method, 40'000).status_code == status::Good);
    CHECK(plc->get<std::int16_t>("A[0]") == 7);
    CHECK(plc->get<std::int16_t>("A[1]") == 0);
    CHECK(plc->get<std::uint16_t>("H") == 1);
}

TEST_CASE_METHOD(Fixture, "8.3 Call: labels that changed are resolved and it is repeated", "[8.3]")
{
    const NodeId method = add_method("start", "H");
    source.start();
    plc->is_prompt = false;
    const auto sent = send_call(method);
    plc->answer();
    complete();
    plc->move_labels();
    plc->is_prompt = true;
    plc->answer();
    CHECK(take_call(sent).status_code == status::Good);
    CHECK(plc->get<std::int16_t>("In") == 5);
    CHECK(plc->get<std::uint16_t>("H") == 1);
}

TEST_CASE_METHOD(Fixture, "8.3 Call: a Handle is a word without sign", "[8.3]")
{
    const NodeId method = add_method("start", "In");
    source.start();
    CHECK(book.errors == std::vector{MappedErrorCode::WrongType});
    CHECK(call(method).status_code == status::Bad_NoCommunication);
}

namespace {

struct Results : Fixture {
    Results()
    {
        plc->add("Done", LabelType::Bit, std::uint8_t{1});
        plc->add("Out", LabelType::Word, std::int16_t{42});
    }
    /// A Method with an Int32 and a String, which has no label, as outputs.
    NodeId add_answering()
    {
        model::AddressSpace& space = server.address_space();
        MappedMethod mapped;
        mapped.node = own("answering");
        mapped.handle = "H";
        mapped.arguments = {{shape(id::Int32, 0, true), {"In"}}};
        mapped.done = "Done";
        mapped.outputs = {{shape(id::Int32, 0, true), {"Out"}}, {shape(id::String, 0, true), {}}};
        model::NewMethod method;
        method.input_arguments = {{"number", NodeId{0, id::Int32}, -1, {}, {}}};
        method.output_arguments = {{"result", NodeId{0, id::Int32}, -1, {}, {}},
                                   {"note", NodeId{0, id::String}, -1, {}, {}}};
        method.source = index;
        method.handle = source.add(std::move(mapped));
        REQUIRE(space.add_object(named("machine")));
        model::NewNode node = named("answering");
        node.parent = space.find(own("machine"));
        REQUIRE(space.add_method(node, method));
        return own("answering");
    }
    std::uint32_t begin(const NodeId& method)
    {
        CallMethodRequest one;
        one.object_id = own("machine");
        one.method_id = method;
        one.input_arguments = {Variant{std::int32_t{5}}};
        CallRequest request;
        request.methods_to_call = {one};
        return client->send(request);
    }
    /// Reads the handle, writes inputs and handle.
    void set_handle()
    {
        for (int i = 0; i < 3; ++i) {
            REQUIRE(plc->requests.size() == 1);
            plc->answer();
            complete();
        }
    }
    /// One look at Done.
    void look()
    {
        REQUIRE(plc->requests.size() == 1);
        CHECK(plc->requests[0]->kind == LabelRequest::Kind::Read);
        plc->answer();
        complete();
        complete();
    }
};

} // namespace

TEST_CASE_METHOD(Results, "Call with a Done: the outputs are answered when the program is done")
{
    const NodeId method = add_answering();
    source.start();
    plc->is_prompt = false;
    const auto sent = begin(method);
    set_handle();
    CHECK(plc->get<std::uint8_t>("Done") == 0); // what was left of the Call before
    CHECK(plc->get<std::int16_t>("In") == 5);
    CHECK(plc->get<std::uint16_t>("H") == 1);
    look();
    look();
    plc->set("Out", std::int16_t{-7});
    plc->set("Done", std::uint8_t{1});
    REQUIRE(plc->requests.size() == 1);
    plc->answer();
    const auto result = take_call(sent);
    CHECK(result.status_code == status::Good);
    REQUIRE(result.output_arguments.size() == 2);
    CHECK(result.output_arguments[0] == Variant{std::int32_t{-7}});
    CHECK(result.output_arguments[1] == Variant{String{}});
    CHECK(plc->requests.empty());
    // And it can be called again.
    plc->set("H", std::uint16_t{0});
    static_cast<void>(begin(method));
    CHECK(plc->requests.size() == 1);
}

TEST_CASE_METHOD(Results, "Call with a Done: it waits no longer than the limit by the PLC's clock")
{
    const NodeId method = add_answering();
    source.start();
    plc->is_prompt = false;
    const auto sent = begin(method);
    set_handle();
    look();
    const DateTime begun = plc->time;
    plc->time = DateTime{begun.ticks + 4 * DateTime::ticks_per_second};
    look();
    plc->time.ticks += 1;
    REQUIRE(plc->requests.size() == 1);
    plc->answer();
    CHECK(take_call(sent).status_code == status::Bad_Timeout);
    CHECK(plc->requests.empty());
    // Not again before the program has taken the Handle.
    const auto again = begin(method);
    plc->answer();
    CHECK(take_call(again).status_code == status::Bad_TooManyOperations);
}

TEST_CASE_METHOD(Results, "Call with a Done: labels that move meanwhile do not begin it again")
{
    const NodeId method = add_answering();
    source.start();
    plc->is_prompt = false;
    const auto sent = begin(method);
    set_handle();
    plc->set("H", std::uint16_t{0}); // the program has begun
    plc->move_labels();
    plc->answer(); // Mismatch
    complete();
    while (!plc->requests.empty() && plc->requests[0]->kind == LabelRequest::Kind::Resolve) {
        plc->answer();
        complete();
    }
    look();
    CHECK(plc->get<std::uint16_t>("H") == 0);
    plc->set("Done", std::uint8_t{1});
    plc->answer();
    CHECK(take_call(sent).status_code == status::Good);
}

TEST_CASE_METHOD(Results, "Call with a Done: a PLC that answers at once keeps nobody waiting")
{
    const NodeId method = add_answering();
    source.start();
    const auto sent = begin(method);
    const int looked = plc->started[LabelRequest::Kind::Read];
    complete();
    CHECK(plc->started[LabelRequest::Kind::Read] <= looked + 2); // one look in each turn
    plc->set("Done", std::uint8_t{1});
    complete();
    CHECK(take_call(sent).status_code == status::Good);
}

TEST_CASE_METHOD(Results, "Call with a Done: an output that its type cannot have")
{
    const NodeId method = add_answering();
    plc->add("Out", LabelType::UnsignedDoubleWord, UINT32_MAX);
    source.start();
    plc->is_prompt = false;
    const auto sent = begin(method);
    set_handle();
    plc->set("Done", std::uint8_t{1});
    plc->answer();
    CHECK(take_call(sent).status_code == status::Bad_NoCommunication);
    CHECK(book.errors == std::vector{MappedErrorCode::OutOfRange});
    CHECK(book.label == "Out");
}

} // namespace mapped_call_test
