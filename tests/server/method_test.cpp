#include <catch2/catch.hpp>

#include "method_fixture.hpp"
#include "server/rights/method_lookup.hpp"

namespace method_test {

using namespace busbar;
using namespace busbar::test;
using busbar::server::MethodCall;

namespace {

struct Fixture : MethodFixture {
    using MethodFixture::MethodFixture;

    /// Answers `result` whatever it is asked.
    NodeId add_answering(server::CallResult result)
    {
        struct Source final : server::DataSource {
            void read(server::ReadBatch) override {}
            void call(server::CallBatch batch) override
            {
                batch.results()[0] = result;
                batch.complete();
            }
            server::CallResult result;
        };
        static Source answering; // outlives the server
        answering.result = std::move(result);
        model::NewMethod method;
        method.input_arguments = {argument(id::Int32)};
        method.output_arguments = {argument(id::Int32)};
        method.source = server.add_source(answering);
        return add(named("Answering", machine), method);
    }
    /// What the client gets of such an answer.
    CallMethodResult answered(server::CallResult result)
    {
        const NodeId method = add_answering(std::move(result));
        auto client = log_in();
        return call(client, to_call(method, {Variant{1}}));
    }
};

server::CallResult with_outputs(StatusCode status, Array<Variant> outputs)
{
    server::CallResult result{status};
    result.outputs = std::move(outputs);
    return result;
}

} // namespace

TEST_CASE_METHOD(Fixture, "a Method gets its typed inputs and who calls, and gives outputs",
                 "[unit:Method Call]")
{
    NodeId object;
    NodeId method;
    NodeId session;
    std::string user;
    const NodeId echo = add("Echo", {argument(id::String), argument(id::Double, 1)},
                            {argument(id::String)}, [&](MethodCall call) {
                                object = call.object_id();
                                method = call.method_id();
                                session = call.session_id();
                                user = call.user().name;
                                call.succeed({Variant{call.input<String>(0)}});
                            });
    auto client = log_in(encrypt);
    const auto result =
        call(client, to_call(echo, {Variant{"text"}, Variant{Array<double>{1, 2}}}));
    CHECK(result.status_code == status::Good);
    CHECK(result.input_argument_results.empty());
    REQUIRE(result.output_arguments.size() == 1);
    CHECK(result.output_arguments[0] == Variant{"text"});
    CHECK(object == own("Machine"));
    CHECK(method == echo);
    CHECK_FALSE(session.is_null());
    CHECK(user == "operator");
}

TEST_CASE_METHOD(Fixture, "what cannot be called answers why")
{
    const NodeId sum = add_sum();
    const NodeId open = add(named("Open", machine));
    const auto other = space().add_object(named("Other", space().find(id::ObjectsFolder))).value();
    add(named("OfOther", other));
    model::NewMethod method;
    method.executable = false;
    method.source = source;
    method.handle = table.add([](MethodCall call) { call.succeed(); });
    add(named("Off", machine), method);
    method.executable = true;
    method.source = 77;
    add(named("Lost", machine), method);
    model::NewVariable variable;
    REQUIRE(space().add_variable(named("Value", machine), variable));
    auto client = log_in();
    const Array<Variant> none;
    CHECK(status_of(client, to_call(sum, none, NodeId{})) == status::Bad_NodeIdInvalid);
    CHECK(status_of(client, to_call(sum, none, own("No"))) == status::Bad_NodeIdUnknown);
    CHECK(status_of(client, to_call(sum, none, own("Value"))) == status::Bad_NodeIdInvalid);
    CHECK(status_of(client, to_call(NodeId{})) == status::Bad_NodeIdInvalid);
    CHECK(status_of(client, to_call(own("No"))) == status::Bad_NodeIdUnknown);
    CHECK(status_of(client, to_call(own("Value"))) == status::Bad_MethodInvalid);
    CHECK(status_of(client, to_call(own("OfOther"))) == status::Bad_MethodInvalid);
    CHECK(status_of(client, to_call(own("Off"))) == status::Bad_NotExecutable);
    CHECK(status_of(client, to_call(open)) == status::Bad_NotImplemented);
    // On an ObjectType (SH-082679, 8.1): ServerType's GetMonitoredItems, which a small namespace 0
    // does not have.
    const NodeId get_monitored_items{0, 11'489};
    if (space().find(get_monitored_items) != model::no_node) {
        CHECK(status_of(client, to_call(get_monitored_items, {Variant{std::uint32_t{1}}},
                                        NodeId{0, 2'004})) == status::Bad_NotSupported);
    }
    CHECK(status_of(client, to_call(own("Lost"))) == status::Bad_NoCommunication);
    CHECK(status_of(client, to_call(sum, {Variant{1}})) == status::Bad_ArgumentsMissing);
    CHECK(status_of(client, to_call(sum, {Variant{1}, Variant{1}, Variant{1}})) ==
          status::Bad_TooManyArguments);
    const auto wrong = call(client, to_call(sum, {Variant{1}, Variant{1.5}}));
    CHECK(wrong.status_code == status::Bad_InvalidArgument);
    CHECK(wrong.input_argument_results ==
          Array<StatusCode>{status::Good, status::Bad_TypeMismatch});
    CHECK(wrong.output_arguments.empty());
    space().set_executable(space().find(own("Off")), true);
    CHECK(status_of(client, to_call(own("Off"))) == status::Good);
}

TEST_CASE_METHOD(Fixture, "inputs have the data type, rank and dimensions of their Argument")
{
    const auto type_of = [&](Argument input, Variant value) {
        static int count = 0;
        const NodeId method = add_taking("Taking" + std::to_string(++count), std::move(input));
        auto client = log_in();
        const auto result = call(client, to_call(method, {std::move(value)}));
        client.close_session();
        if (result.status_code == status::Bad_InvalidArgument) {
            REQUIRE(result.input_argument_results.size() == 1);
            return result.input_argument_results[0];
        }
        return result.status_code;
    };
    const StatusCode mismatch = status::Bad_TypeMismatch;
    const Array<std::int32_t> three{1, 2, 3};
    SECTION("numbers and enumerations")
    {
        CHECK(type_of(argument(id::Int32), Variant{std::uint32_t{1}}) == mismatch);
        CHECK(type_of(argument(id::Integer), Variant{std::int16_t{1}}) == status::Good);
        CHECK(type_of(argument(id::Integer), Variant{1.0}) == mismatch);
        CHECK(type_of(argument(id::Duration), Variant{1.0}) == status::Good);
        CHECK(type_of(argument(id::ServerState), Variant{1}) == status::Good);
        CHECK(type_of(argument(id::ServerState), Variant{std::uint32_t{1}}) == mismatch);
    }
    SECTION("null, and anything")
    {
        CHECK(type_of(argument(id::Int32), Variant{}) == mismatch);
        CHECK(type_of(argument(id::BaseDataType), Variant{}) == status::Good);
        CHECK(type_of(argument(id::BaseDataType, -2), Variant{three}) == status::Good);
        CHECK(type_of(argument(id::Int32, 1), Variant{Array<std::int32_t>{}}) == status::Good);
    }
    SECTION("ranks and dimensions")
    {
        CHECK(type_of(argument(id::Int32), Variant{three}) == mismatch);
        CHECK(type_of(argument(id::Int32, 1), Variant{1}) == mismatch);
        CHECK(type_of(argument(id::Int32, 1, {3}), Variant{three}) == status::Good);
        CHECK(type_of(argument(id::Int32, 1, {2}), Variant{three}) == mismatch);
        const Variant matrix = Variant::matrix(Array<std::int32_t>{1, 2, 3, 4}, {2, 2});
        CHECK(type_of(argument(id::Int32, 2, {0, 2}), matrix) == status::Good);
        CHECK(type_of(argument(id::Int32, 1), matrix) == mismatch);
    }
    SECTION("bytes are not a ByteString")
    {
        const Variant bytes{ByteString{std::vector<std::byte>(2)}};
        CHECK(type_of(argument(id::ByteString), bytes) == status::Good);
        CHECK(type_of(argument(id::Byte, 1), bytes) == mismatch);
        CHECK(type_of(argument(id::Byte, 1), Variant{Array<std::uint8_t>{1, 2}}) == status::Good);
    }
    SECTION("structures")
    {
        const Variant value{ExtensionObject::from(argument(id::Int32))};
        const Variant unknown{ExtensionObject::from_binary(own("Type"), ByteString{})};
        CHECK(type_of(argument(id::Argument), value) == status::Good);
        CHECK(type_of(argument(id::Structure), value) == status::Good);
        CHECK(type_of(argument(id::Argument), unknown) == mismatch);
        CHECK(type_of(argument(id::Argument), Variant{1}) == mismatch);
    }
}

TEST_CASE_METHOD(Fixture, "what the backend answers goes out only if it is well-formed")
{
    SECTION("outputs of the Method")
    {
        const auto result = answered(with_outputs(status::Good, {Variant{5}}));
        CHECK(result.status_code == status::Good);
        CHECK(result.output_arguments == Array<Variant>{Variant{5}});
    }
    SECTION("outputs of another type")
    {
        const auto result = answered(with_outputs(status::Good, {Variant{"five"}}));
        CHECK(result.status_code == status::Bad_InternalError);
        CHECK(result.output_arguments.empty());
        CHECK(log.text.find("OutputArguments") != std::string::npos);
    }
    SECTION("outputs of another number")
    {
        CHECK(answered(with_outputs(status::Good, {})).status_code == status::Bad_InternalError);
    }
    SECTION("Good has no sub code, and Uncertain keeps the outputs")
    {
        SECTION("Good")
        {
            const auto result =
                answered(with_outputs(status::Good_CompletesAsynchronously, {Variant{5}}));
            CHECK(result.status_code == status::Good);
        }
        SECTION("Uncertain")
        {
            const auto result = answered(with_outputs(status::Uncertain, {Variant{5}}));
            CHECK(result.status_code == status::Uncertain);
            CHECK(result.output_arguments.size() == 1);
        }
    }
    SECTION("a bad status has no outputs")
    {
        const auto result = answered(with_outputs(status::Bad_DeviceFailure, {Variant{5}}));
        CHECK(result.status_code == status::Bad_DeviceFailure);
        CHECK(result.output_arguments.empty());
    }
    SECTION("results of inputs belong to Bad_InvalidArgument and are as many")
    {
        server::CallResult refusal{status::Bad_InvalidArgument};
        SECTION("as many")
        {
            refusal.input_results = {status::Bad_OutOfRange};
            const auto result = answered(refusal);
            CHECK(result.status_code == status::Bad_InvalidArgument);
            CHECK(result.input_argument_results == Array<StatusCode>{status::Bad_OutOfRange});
        }
        SECTION("another number")
        {
            refusal.input_results = {status::Good, status::Bad_OutOfRange};
            CHECK(answered(refusal).input_argument_results.empty());
        }
        SECTION("another status")
        {
            refusal.status = status::Bad_InvalidState;
            refusal.input_results = {status::Bad_OutOfRange};
            CHECK(answered(refusal).input_argument_results.empty());
        }
    }
}

TEST_CASE_METHOD(Fixture,
                 "a table answers for functions it does not have, and for those that forget")
{
    model::NewMethod method;
    method.source = source;
    method.handle = 99;
    add(named("Unknown", machine), method);
    const NodeId refusing = add("Refusing", {argument(id::Int32)}, {}, [](MethodCall call) {
        call.refuse({status::Bad_OutOfRange});
        call.succeed(); // too late
    });
    const NodeId forgetting = add("Forgetting", {}, {}, [](MethodCall) {});
    auto client = log_in();
    CHECK(status_of(client, to_call(own("Unknown"))) == status::Bad_NotImplemented);
    CHECK(status_of(client, to_call(forgetting)) == status::Bad_InternalError);
    const auto refused = call(client, to_call(refusing, {Variant{9}}));
    CHECK(refused.status_code == status::Bad_InvalidArgument);
    CHECK(refused.input_argument_results == Array<StatusCode>{status::Bad_OutOfRange});
}

TEST_CASE_METHOD(Fixture, "Methods of types are called on their instances")
{
    const auto base = space().find(id::BaseObjectType);
    const auto type = space().add_object_type(named("Type", base)).value();
    const auto sub_type = space().add_object_type(named("SubType", type)).value();
    std::vector<std::string> called;
    const auto noting = [&](const char* text) {
        model::NewMethod method;
        method.source = source;
        method.handle = table.add([&called, text](MethodCall call) {
            called.emplace_back(text);
            call.succeed();
        });
        return method;
    };
    model::NewNode run = named("Run", type);
    add(run, noting("type"));
    const auto objects = space().find(id::ObjectsFolder);
    const auto plain = space().add_object(named("Plain", objects), {own("SubType"), 0}).value();
    const auto special = space().add_object(named("Special", objects), {own("SubType"), 0}).value();
    model::NewNode own_run = named("SpecialRun", special);
    own_run.browse_name = run.browse_name;
    add(own_run, noting("special"));
    auto client = log_in();
    CHECK(status_of(client, to_call(run.id, {}, own("Plain"))) == status::Good);
    CHECK(status_of(client, to_call(run.id, {}, own("Special"))) == status::Good);
    CHECK(status_of(client, to_call(own_run.id, {}, own("Special"))) == status::Good);
    CHECK(status_of(client, to_call(run.id, {}, own("SubType"))) == status::Good);
    CHECK(called == std::vector<std::string>{"type", "special", "special", "type"});
    CHECK(status_of(client, to_call(own_run.id, {}, own("Plain"))) == status::Bad_MethodInvalid);
    CHECK(status_of(client, to_call(run.id)) == status::Bad_MethodInvalid);

    // One Method may be a component of several Objects.
    const NodeId has_component{0, id::HasComponent};
    REQUIRE(space().add_reference(machine, has_component, space().find(own_run.id)));
    CHECK(status_of(client, to_call(own_run.id)) == status::Good);
    REQUIRE(space().remove(plain));
    CHECK(sub_type != model::no_node);
}

TEST_CASE_METHOD(Fixture, "Executable and UserExecutable tell who may call")
{
    NamedRights rights;
    Fixture fixture{insecure_config(), &rights};
    const NodeId sum = fixture.add_sum();
    const NodeId open = fixture.add(named("Open", fixture.machine));
    const Array<Variant> inputs{Variant{1}, Variant{2}};
    const auto executable = [&](TestClient& client, const NodeId& method) {
        return std::pair{read(client, method, AttributeId::Executable),
                         read(client, method, AttributeId::UserExecutable)};
    };
    const auto pair = [](bool all, bool user) { return std::pair{Variant{all}, Variant{user}}; };
    auto client = fixture.log_in();
    CHECK(executable(client, sum) == pair(true, true));
    CHECK(executable(client, open) == pair(false, false)); // nobody would carry it out
    rights.forbidden = sum;
    CHECK(executable(client, sum) == pair(true, false));
    CHECK(status_of(client, to_call(sum, inputs)) == status::Bad_UserAccessDenied);
    rights.forbidden = NodeId{};
    rights.hidden = sum;
    CHECK(status_of(client, to_call(sum, inputs)) == status::Bad_NodeIdUnknown);
    rights.hidden = own("Machine");
    CHECK(status_of(client, to_call(sum, inputs)) == status::Bad_NodeIdUnknown);
    rights.hidden = NodeId{};

    fixture.users.everybody = server::anonymous_reader();
    auto reader = fixture.log_in();
    CHECK(executable(reader, sum) == pair(true, false));
    CHECK(status_of(reader, to_call(sum, inputs)) == status::Bad_UserAccessDenied);
    CHECK(status_of(client, to_call(sum, inputs)) == status::Good);
    fixture.space().set_executable(fixture.space().find(sum), false);
    CHECK(executable(client, sum) == pair(false, false));
}

TEST_CASE_METHOD(Fixture, "a Method is found from the Object, not among all who have it")
{
    const auto has_component = NodeId{0, id::HasComponent};
    const auto type = space().add_object_type(named("Type", space().find(id::BaseObjectType)));
    REQUIRE(type);
    const NodeId method = add(named("Common", *type));
    model::NewObject of_type;
    of_type.type_definition = own("Type");
    const auto folder = space().find(id::ObjectsFolder);
    for (int i = 0; i < 1'000; ++i) {
        const auto name = "Object" + std::to_string(i);
        const auto object = space().add_object(named(name, folder), of_type);
        REQUIRE(object);
        REQUIRE(space().add_reference(*object, has_component, space().find(method)));
    }
    const server::UserIdentity user;
    const server::detail::NodeRights rights{space(), user};
    std::size_t visits = 100;
    for (int i = 0; i < 10; ++i) {
        CHECK(server::detail::find_method(space(), rights, own("Object500"), method, visits));
    }
    REQUIRE(space().add_object(named("Bare", folder), of_type));
    CHECK(server::detail::find_method(space(), rights, own("Bare"), method, visits));
    // Who has much costs much, and only so much.
    REQUIRE(space().add_object(named("Rich", folder), of_type));
    for (int i = 0; i < 200; ++i) {
        REQUIRE(space().add_reference(space().find(own("Rich")), has_component,
                                      space().find(own("Object" + std::to_string(i)))));
    }
    CHECK(server::detail::find_method(space(), rights, own("Rich"), method, visits).error() ==
          status::Bad_TooManyOperations);
    visits = 1'000;
    CHECK(server::detail::find_method(space(), rights, own("Rich"), method, visits));
}

} // namespace method_test
