#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/client/attributes.hpp>
#include <busbar/client/methods.hpp>
#include <busbar/client/node_address.hpp>
#include <busbar/client/node_management.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "scripted_requester.hpp"

namespace busbar::client::services_test {

namespace {

using busbar::test::ScriptedRequester;

std::vector<ReadValueId> numbered(std::uint32_t count)
{
    std::vector<ReadValueId> items;
    for (std::uint32_t i = 0; i < count; ++i) {
        items.push_back(attribute_of(NodeId{2, i}));
    }
    return items;
}

/// Answers reads with the numbers of the nodes, `at_most` in one request.
struct ReadFixture {
    void answer(std::size_t at_most, StatusCode too_many = status::Bad_TooManyOperations)
    {
        requester.on<ReadRequest, ReadResponse>([=, this](const ReadRequest& request) {
            sizes.push_back(request.nodes_to_read.size());
            most_waiting = std::max(most_waiting, requester.waiting());
            if (request.nodes_to_read.size() > at_most) {
                return Result<ReadResponse>{fail(too_many)};
            }
            ReadResponse response;
            for (const ReadValueId& item : request.nodes_to_read) {
                response.results.push_back(DataValue{Variant{item.node_id.numeric()}});
            }
            return Result<ReadResponse>{std::move(response)};
        });
    }
    [[nodiscard]] bool is_in_order() const
    {
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (values[i].value.value_or<std::uint32_t>(UINT32_MAX) != i) {
                return false;
            }
        }
        return true;
    }
    Operation read_all(std::uint32_t count, const ServiceOptions& options = {})
    {
        return read(
            requester, numbered(count),
            [this](std::vector<DataValue> v) {
                values = std::move(v);
                ++done;
            },
            {}, options);
    }

    ScriptedRequester requester;
    std::vector<std::size_t> sizes;
    std::size_t most_waiting{0};
    std::vector<DataValue> values;
    int done{0};
};

} // namespace

TEST_CASE_METHOD(ReadFixture, "A Read is split by the server's limit, a few parts under way",
                 "[unit:Attribute Client Read Base]"
                 "[unit:Base Info Client Honour Operation Limits]")
{
    requester.info.operation_limits.max_nodes_per_read = 10;
    answer(10);
    read_all(95);
    CHECK(requester.waiting() == 4);
    CHECK(done == 0);
    REQUIRE(requester.run());
    CHECK(done == 1);
    CHECK(values.size() == 95);
    CHECK(is_in_order());
    CHECK(sizes == std::vector<std::size_t>{10, 10, 10, 10, 10, 10, 10, 10, 10, 5});
    CHECK(most_waiting <= 3);
}

TEST_CASE_METHOD(ReadFixture, "A Read that is too large is halved where the server names no limit")
{
    const StatusCode why =
        GENERATE(status::Bad_TooManyOperations, status::Bad_ResponseTooLarge,
                 status::Bad_RequestTooLarge, status::Bad_EncodingLimitsExceeded);
    answer(7, why);
    read_all(100);
    REQUIRE(requester.run());
    CHECK(values.size() == 100);
    CHECK(is_in_order());
    // 100, then the halves that are under way together, and no part that is too large after 7.
    CHECK(std::count_if(sizes.begin(), sizes.end(), [](std::size_t s) { return s > 7; }) <= 12);
}

TEST_CASE_METHOD(ReadFixture, "A Read that cannot be halved, or fails otherwise, has its status")
{
    answer(0);
    read_all(3);
    REQUIRE(requester.run());
    for (const DataValue& value : values) {
        CHECK(value.status == status::Bad_TooManyOperations);
    }
    CHECK(sizes.size() <= 6);

    requester.info.operation_limits.max_nodes_per_read = 2;
    requester.on<ReadRequest, ReadResponse>([](const ReadRequest& request) {
        if (request.nodes_to_read[0].node_id.numeric() == 2) {
            return Result<ReadResponse>{fail(status::Bad_Timeout)};
        }
        ReadResponse response;
        response.results.resize(request.nodes_to_read.size());
        return Result<ReadResponse>{response};
    });
    read_all(6);
    REQUIRE(requester.run());
    CHECK(values[1].status == status::Good);
    CHECK(values[2].status == status::Bad_Timeout);
    CHECK(values[3].status == status::Bad_Timeout);
    CHECK(values[4].status == status::Good);
}

TEST_CASE_METHOD(ReadFixture, "Too few or too many results are none")
{
    const std::size_t results = GENERATE(0U, 1U, 4U, 1'000U);
    requester.on<ReadRequest, ReadResponse>([=](const ReadRequest&) {
        ReadResponse response;
        response.results.resize(results);
        return response;
    });
    read_all(3);
    REQUIRE(requester.run());
    REQUIRE(values.size() == 3);
    CHECK(values[0].status == status::Bad_UnknownResponse);
    CHECK(values[2].status == status::Bad_UnknownResponse);
}

TEST_CASE_METHOD(ReadFixture, "A cancelled Read is forgotten whole, an empty one ends later")
{
    answer(10);
    ServiceOptions options;
    options.max_items_per_request = 1;
    Operation operation = read_all(20, options);
    requester.step();
    operation.cancel();
    CHECK(requester.waiting() == 0);
    CHECK(done == 0);
    CHECK_FALSE(operation.is_under_way());

    Operation nothing = read_all(0);
    CHECK(done == 0);
    CHECK(nothing.is_under_way());
    const int sent = requester.sent();
    REQUIRE(requester.run());
    CHECK(done == 1);
    CHECK(requester.sent() == sent);
    CHECK_FALSE(nothing.is_under_way());
    nothing.cancel();
}

TEST_CASE("A Write has a status for each item", "[unit:Attribute Client Write Base]")
{
    ScriptedRequester requester;
    requester.info.operation_limits.max_nodes_per_write = 2;
    requester.on<WriteRequest, WriteResponse>([](const WriteRequest& request) {
        WriteResponse response;
        for (const WriteValue& item : request.nodes_to_write) {
            response.results.push_back(item.node_id.numeric() == 1 ? status::Bad_TypeMismatch
                                                                   : status::Good);
        }
        return response;
    });
    std::vector<StatusCode> results;
    write(requester,
          {value_for(NodeId{2, 0U}, Variant{1}), value_for(NodeId{2, 1}, Variant{1}),
           value_for(NodeId{2, 2}, Variant{1})},
          [&](std::vector<StatusCode> r) { results = std::move(r); });
    REQUIRE(requester.run());
    CHECK(results == std::vector{status::Good, status::Bad_TypeMismatch, status::Good});
}

TEST_CASE("RegisterNodes is not repeated where the server may have done it",
          "[unit:View Client RegisterNodes]")
{
    ScriptedRequester requester;
    int asked = 0;
    requester.on<RegisterNodesRequest, RegisterNodesResponse>([&](const RegisterNodesRequest&) {
        ++asked;
        return Result<RegisterNodesResponse>{fail(status::Bad_ResponseTooLarge)};
    });
    std::vector<Result<NodeId>> ids;
    register_nodes(requester, {NodeId{2, 1}, NodeId{2, 2}},
                   [&](std::vector<Result<NodeId>> r) { ids = std::move(r); });
    REQUIRE(requester.run());
    CHECK(asked == 1);
    REQUIRE(ids.size() == 2);
    CHECK(ids[0] == fail(status::Bad_ResponseTooLarge));
}

TEST_CASE("Methods are called once, in halves only if the server has not begun",
          "[unit:Method Client Call]")
{
    ScriptedRequester requester;
    std::vector<std::uint32_t> called;
    StatusCode too_large = status::Bad_TooManyOperations;
    requester.on<CallRequest, CallResponse>([&](const CallRequest& request) {
        CallResponse response;
        if (request.methods_to_call.size() > 1 && too_large == status::Bad_TooManyOperations) {
            return Result<CallResponse>{fail(too_large)};
        }
        for (const CallMethodRequest& method : request.methods_to_call) {
            called.push_back(method.method_id.numeric());
            response.results.emplace_back().output_arguments = {
                Variant{method.method_id.numeric()}};
        }
        return too_large.is_bad() && request.methods_to_call.size() > 1
                   ? Result<CallResponse>{fail(too_large)}
                   : Result<CallResponse>{std::move(response)};
    });
    std::vector<CallMethodResult> results;
    const auto call_all = [&] {
        called.clear();
        std::vector<CallMethodRequest> methods(3);
        for (std::uint32_t i = 0; i < 3; ++i) {
            methods[i].method_id = NodeId{2, i};
        }
        call(requester, methods, [&](std::vector<CallMethodResult> r) { results = std::move(r); });
        REQUIRE(requester.run());
        REQUIRE(results.size() == 3);
    };
    call_all();
    CHECK(called.size() == 3);
    CHECK(results[2].output_arguments == Array<Variant>{Variant{2U}});
    too_large = status::Bad_ResponseTooLarge;
    call_all();
    CHECK(called.size() == 3);
    CHECK(results[2].status_code == status::Bad_ResponseTooLarge);
    CHECK(results[2].output_arguments.empty());
}

TEST_CASE("Nodes are added in order, one request after the other", "[unit:Node Management Client]")
{
    ScriptedRequester requester;
    requester.info.operation_limits.max_nodes_per_node_management = 2;
    std::uint32_t added = 0;
    requester.on<AddNodesRequest, AddNodesResponse>([&](const AddNodesRequest& request) {
        CHECK(requester.waiting() == 0);
        AddNodesResponse response;
        for (std::size_t i = 0; i < request.nodes_to_add.size(); ++i) {
            response.results.emplace_back().added_node_id = NodeId{2, ++added};
        }
        return response;
    });
    std::vector<AddNodesResult> results;
    add_nodes(requester, std::vector<AddNodesItem>(5),
              [&](std::vector<AddNodesResult> r) { results = std::move(r); });
    REQUIRE(requester.run());
    REQUIRE(results.size() == 5);
    CHECK(results[4].added_node_id == NodeId{2, 5});
    std::vector<StatusCode> deleted;
    delete_nodes(requester, std::vector<DeleteNodesItem>(3),
                 [&](std::vector<StatusCode> r) { deleted = std::move(r); });
    REQUIRE(requester.run());
    CHECK(deleted == std::vector(3, status::Bad_ServiceUnsupported));
}

TEST_CASE("Addresses are read and written")
{
    for (const char* text : {"i=2258", "ns=2;s=Pump", "nsu=urn:acme;s=Pump", "svr=1;i=5",
                             "/Objects/2:Machine/2:Speed", "/Objects.2:Prop<HasChild>2:x",
                             "/Objects/nsu=http://acme.com/UA/;Machine<#!nsu=urn:a;Feeds>2:y",
                             "[ns=2;s=Line]/2:Speed", "[ns=2;s=a&]/b&&]/2:Speed"}) {
        const auto address = NodeAddress::parse(text);
        INFO(text);
        REQUIRE(address);
        CHECK(address->text() == text);
    }
    CHECK(NodeAddress::path("/2:x", NodeId{2, "a]/b&"})->text() == "[ns=2;s=a&]/b&&]/2:x");
    CHECK_FALSE(NodeAddress::parse("ns=2;s=Line")->is_path());
    for (const char* text : {"", "Pump", "ns=2", "ns=70000;i=1", "[ns=2;s=x", "nsu=;i=1", "]"}) {
        INFO(text);
        CHECK(NodeAddress::parse(text) == fail(status::Bad_NodeIdInvalid));
    }
    for (const char* text : {"//x", "/a<b", "/a<>b", "/nsu=urn:x", "[i=85]", "[i=85]x", "/&"}) {
        INFO(text);
        CHECK(NodeAddress::parse(text) == fail(status::Bad_BrowseNameInvalid));
    }
    const std::string long_text(NodeAddress::max_text_length + 1, 'x');
    CHECK_FALSE(NodeAddress::parse("/" + long_text));
    CHECK_FALSE(NodeAddress::parse("s=" + long_text));
}

} // namespace busbar::client::services_test
