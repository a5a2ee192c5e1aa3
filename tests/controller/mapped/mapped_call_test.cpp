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

} // namespace mapped_call_test
