#include <catch2/catch.hpp>

#include <busbar/client/text_access.hpp>
#include <busbar/client/type_cache.hpp>
#include <busbar/client/value_text.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/view.hpp>

#include "scripted_requester.hpp"

namespace text_access_refusal_test {

using namespace busbar;
using namespace busbar::client;

namespace {

const NodeId machine{2, "machine"};
const NodeId method{2, "method"};
const NodeId input_arguments{2, "arguments"};

/// A server that says of a method and a Variable what the test wants.
struct LyingServer {
    LyingServer()
    {
        requester.on<BrowseRequest, BrowseResponse>([this](const BrowseRequest& request) {
            BrowseResponse response;
            response.results.resize(request.nodes_to_browse.size());
            if (request.nodes_to_browse[0].node_id == method) {
                response.results[0] = properties;
            }
            return response;
        });
        requester.on<ReadRequest, ReadResponse>([this](const ReadRequest& request) {
            ReadResponse response;
            for (const ReadValueId& item : request.nodes_to_read) {
                response.results.push_back(value_of(item));
            }
            return response;
        });
        requester.on<CallRequest, CallResponse>([this](const CallRequest& request) {
            calls.push_back(request.methods_to_call[0]);
            CallResponse response;
            response.results.push_back(outcome);
            return response;
        });
        requester.on<WriteRequest, WriteResponse>([this](const WriteRequest& request) {
            ++writes;
            WriteResponse response;
            response.results = Array<StatusCode>(request.nodes_to_write.size());
            response.results[0] = write_status;
            return response;
        });
    }
    [[nodiscard]] DataValue value_of(const ReadValueId& item) const
    {
        if (item.node_id == input_arguments) {
            return arguments;
        }
        if (item.node_id == machine && item.attribute_id == std::uint32_t{14}) {
            return data_type;
        }
        return DataValue{StatusCode{status::Bad_AttributeIdInvalid}};
    }
    void have_property(ExpandedNodeId id = ExpandedNodeId{input_arguments})
    {
        ReferenceDescription& property = properties.references.emplace_back();
        property.node_id = std::move(id);
        property.browse_name = QualifiedName{0, "InputArguments"};
    }
    void have_argument(const char* name, const NodeId& type)
    {
        have_property();
        Argument argument;
        argument.name = name;
        argument.data_type = type;
        argument.value_rank = -1;
        arguments = DataValue{Variant{Array<ExtensionObject>{ExtensionObject::from(argument)}}};
    }
    /// "" or the error.
    std::string called(std::vector<std::string> texts, const NodeAddress& object = machine)
    {
        std::string error = "not done";
        call_text(requester, types, object, method, std::move(texts),
                  [&](const Accessed<CallMethodResult>& result) { error = error_of(result); });
        REQUIRE(requester.run());
        return error;
    }
    std::string written(const char* text)
    {
        std::string error = "not done";
        write_text(requester, types, machine, text,
                   [&](const Accessed<void>& result) { error = error_of(result); });
        REQUIRE(requester.run());
        return error;
    }
    template <typename T>
    [[nodiscard]] static std::string error_of(const Accessed<T>& result)
    {
        return result ? ""
                      : std::string{name(result.error().status)} + ": " + result.error().message;
    }

    test::ScriptedRequester requester;
    TypeCache types{requester};
    BrowseResult properties;
    DataValue arguments;
    DataValue data_type{Variant{NodeId{0, 6}}};
    CallMethodResult outcome;
    StatusCode write_status;
    std::vector<CallMethodRequest> calls;
    int writes{0};
};

} // namespace

TEST_CASE_METHOD(LyingServer, "A method whose arguments cannot be known is not called")
{
    SECTION("as its object is not there")
    {
        CHECK(called({}, NodeAddress::parse("nsu=urn:else;s=x").value()) ==
              "Bad_NodeIdUnknown: the object's address names no node");
    }
    SECTION("as it cannot be browsed")
    {
        properties.status_code = status::Bad_NodeIdUnknown;
        CHECK(called({"1"}) == "Bad_NodeIdUnknown: the method cannot be browsed");
    }
    SECTION("as they cannot be read")
    {
        have_property();
        arguments = DataValue{StatusCode{status::Bad_UserAccessDenied}};
        CHECK(called({"1"}) == "Bad_UserAccessDenied: the method's InputArguments cannot be read");
    }
    SECTION("as they are something else")
    {
        have_property();
        arguments = DataValue{5};
        CHECK(called({"1"}) == "Bad_UnknownResponse: the method's InputArguments cannot be read");
    }
    SECTION("as one of them is something else")
    {
        have_property();
        arguments = DataValue{Variant{Array<ExtensionObject>{ExtensionObject::from(Range{})}}};
        CHECK(called({"1"}).starts_with("Bad_DataTypeIdUnknown: argument 1: its DataType "));
    }
    SECTION("as nobody describes the type of one")
    {
        have_argument("speed\x1b", NodeId{2, 99});
        const std::string error = called({"1"});
        CHECK(error.starts_with("Bad_DataTypeIdUnknown: speed"));
        CHECK(error.ends_with(": its DataType ns=2;i=99 is not described by the server"));
        CHECK(error.find('\x1b') == std::string::npos);
    }
    SECTION("as there are fewer than texts")
    {
        CHECK(called({"1"}) == "Bad_TooManyArguments: the method has 0 arguments, not 1");
    }
    CHECK(calls.empty());
}

TEST_CASE_METHOD(LyingServer, "Properties at another server are not asked for")
{
    have_property(ExpandedNodeId{input_arguments, {}, 1});
    CHECK(called({}).empty());
    REQUIRE(calls.size() == 1);
    CHECK(calls[0].object_id == machine);
    CHECK(calls[0].method_id == method);
    CHECK(calls[0].input_arguments.empty());
}

TEST_CASE_METHOD(LyingServer, "A call that fails says which arguments are to blame")
{
    have_argument("speed", NodeId{0, 6});
    outcome.status_code = status::Bad_InvalidArgument;
    SECTION("as far as there are such arguments")
    {
        outcome.input_argument_results = {status::Bad_OutOfRange, status::Bad_TypeMismatch};
        CHECK(called({"7"}) == "Bad_InvalidArgument: the call failed; speed: Bad_OutOfRange");
    }
    SECTION("if any is")
    {
        outcome.input_argument_results = {status::Good};
        CHECK(called({"7"}) == "Bad_InvalidArgument: the call failed");
    }
    SECTION("or that there was no call")
    {
        requester.on<CallRequest, CallResponse>([this](const CallRequest& request) {
            calls.push_back(request.methods_to_call[0]);
            return fail(status::Bad_UserAccessDenied);
        });
        CHECK(called({"7"}) == "Bad_UserAccessDenied: the call failed");
    }
    REQUIRE(calls.size() == 1);
    CHECK(calls[0].input_arguments == Array<Variant>{Variant{7}});
}

TEST_CASE_METHOD(LyingServer, "A call that is cancelled is not made")
{
    have_argument("speed", NodeId{0, 6});
    const int steps = GENERATE(0, 1, 2, 3);
    bool is_done = false;
    Operation operation = call_text(requester, types, machine, method, {"7"},
                                    [&](const Accessed<CallMethodResult>&) { is_done = true; });
    for (int i = 0; i < steps && calls.empty() && requester.waiting() > 0; ++i) {
        requester.step();
    }
    const std::size_t made = calls.size();
    const bool was_done = is_done;
    operation.cancel();
    REQUIRE(requester.run());
    CHECK(calls.size() == made);
    CHECK(is_done == was_done);
}

TEST_CASE_METHOD(LyingServer, "A text that cannot be written says why")
{
    std::string expected;
    SECTION("as the DataType cannot be read")
    {
        data_type = DataValue{StatusCode{status::Bad_NodeIdUnknown}};
        expected = "Bad_NodeIdUnknown: its DataType cannot be read";
    }
    SECTION("as the DataType is no NodeId")
    {
        data_type = DataValue{6};
        expected = "Bad_UnknownResponse: its DataType cannot be read";
    }
    SECTION("as the DataType is not described")
    {
        data_type = DataValue{Variant{NodeId{2, 99}}};
        expected = "Bad_DataTypeIdUnknown: its DataType ns=2;i=99 is not described by the server";
    }
    CHECK(written("7") == expected);
    CHECK(writes == 0);
}

TEST_CASE_METHOD(LyingServer, "A value that the server does not take is not written")
{
    CHECK(written("7").empty()); // without a ValueRank anything goes
    write_status = status::Bad_NotWritable;
    CHECK(written("7") == "Bad_NotWritable: the value was not written");
    CHECK(writes == 2);
}

} // namespace text_access_refusal_test
