#include <catch2/catch.hpp>

#include <busbar/client/attributes.hpp>
#include <busbar/client/discovery.hpp>
#include <busbar/client/methods.hpp>
#include <busbar/client/node_address.hpp>
#include <busbar/client/node_management.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "scripted_requester.hpp"
#include "server_requester.hpp"

namespace busbar::client {

namespace {

using test::ScriptedRequester;

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

/// A server whose nodes have so many children each, given a few at a time.
struct BrowseFixture {
    BrowseFixture()
    {
        requester.on<BrowseRequest, BrowseResponse>([this](const BrowseRequest& request) {
            BrowseResponse response;
            for (const BrowseDescription& item : request.nodes_to_browse) {
                ++browsed;
                response.results.push_back(answer(item.node_id, 0));
            }
            return response;
        });
        requester.on<BrowseNextRequest, BrowseNextResponse>([this](const BrowseNextRequest& r) {
            BrowseNextResponse response;
            for (const ByteString& point : r.continuation_points) {
                response.results.push_back(next(point, r.release_continuation_points));
            }
            return response;
        });
    }
    BrowseResult next(const ByteString& point, bool releases)
    {
        const auto found = points.find(point);
        if (found == points.end()) {
            return {status::Bad_ContinuationPointInvalid, {}, {}};
        }
        const auto [node, from] = found->second;
        points.erase(found);
        return releases ? BrowseResult{} : answer(node, from);
    }
    BrowseResult answer(const NodeId& node, std::uint32_t from)
    {
        BrowseResult result;
        const std::uint32_t end =
            is_endless ? from + per_answer : std::min(from + per_answer, children);
        for (std::uint32_t i = from; i < end; ++i) {
            ReferenceDescription reference;
            reference.node_id = NodeId{3, node.numeric() * 1'000 + i};
            result.references.push_back(std::move(reference));
        }
        if (is_endless || end < children) {
            if (points.size() == max_points) {
                return {status::Bad_NoContinuationPoints, {}, {}};
            }
            const std::byte bytes[] = {std::byte(++last_point), std::byte(last_point >> 8U)};
            result.continuation_point = ByteString{bytes};
            points[result.continuation_point] = {node, end};
        }
        return result;
    }
    Operation browse_all(std::uint32_t count, BrowseLimits limits = {})
    {
        std::vector<BrowseDescription> nodes;
        for (std::uint32_t i = 0; i < count; ++i) {
            nodes.push_back(children_of(NodeId{2, i}));
        }
        return browse(
            requester, std::move(nodes),
            [this](std::vector<BrowseResult> r) {
                results = std::move(r);
                ++done;
            },
            limits);
    }

    ScriptedRequester requester;
    std::uint32_t children{10};
    std::uint32_t per_answer{3};
    bool is_endless{false};
    std::size_t max_points{1'000};
    std::map<ByteString, std::pair<NodeId, std::uint32_t>> points;
    unsigned last_point{0};
    int browsed{0};
    std::vector<BrowseResult> results;
    int done{0};
};

} // namespace

TEST_CASE_METHOD(ReadFixture, "A Read is split by the server's limit, a few parts under way")
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

TEST_CASE("A Write has a status for each item")
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

TEST_CASE("RegisterNodes is not repeated where the server may have done it")
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

TEST_CASE("Methods are called once, in halves only if the server has not begun")
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

TEST_CASE("Nodes are added in order, one request after the other")
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

TEST_CASE_METHOD(BrowseFixture, "Browse goes on until there is no more")
{
    browse_all(3);
    REQUIRE(requester.run());
    REQUIRE(done == 1);
    for (const BrowseResult& result : results) {
        CHECK(result.status_code == status::Good);
        CHECK(result.references.size() == 10);
        CHECK(result.continuation_point.is_null());
    }
    CHECK(results[2].references[9].node_id == ExpandedNodeId{NodeId{3, 2'009}});
    CHECK(points.empty());
}

TEST_CASE_METHOD(BrowseFixture, "Nodes wait for continuation points that others use")
{
    max_points = 2;
    browse_all(7);
    REQUIRE(requester.run());
    REQUIRE(done == 1);
    for (const BrowseResult& result : results) {
        CHECK(result.status_code == status::Good);
        CHECK(result.references.size() == 10);
    }
    CHECK(browsed <= 7 + 5 + 3 + 3);

    max_points = 0;
    browse_all(5);
    REQUIRE(requester.run());
    CHECK(done == 2);
    CHECK(results[4].status_code == status::Bad_NoContinuationPoints);
}

TEST_CASE_METHOD(BrowseFixture, "An endless Browse ends at the limits, with nothing left behind")
{
    is_endless = true;
    BrowseLimits limits;
    SECTION("of references of a node")
    {
        limits.max_references_per_node = 100;
        browse_all(2, limits);
        REQUIRE(requester.run());
        CHECK(results[1].references.size() == 100);
    }
    SECTION("of references of all")
    {
        limits.max_references = 50;
        browse_all(2, limits);
        REQUIRE(requester.run());
        CHECK(results[0].references.size() + results[1].references.size() == 50);
    }
    SECTION("of empty answers")
    {
        per_answer = 0;
        browse_all(1, limits);
        REQUIRE(requester.run());
        CHECK(results[0].references.empty());
        CHECK(requester.sent() < 20);
    }
    REQUIRE(done == 1);
    CHECK(results[0].status_code == status::Uncertain_NotAllNodesAvailable);
    CHECK(points.empty());
}

TEST_CASE_METHOD(BrowseFixture, "A node whose continuation point was freed is browsed again")
{
    browse_all(2);
    requester.step();
    points.clear();
    REQUIRE(requester.run());
    CHECK(results[1].status_code == status::Good);
    CHECK(results[1].references.size() == 10);

    // Of a server that never keeps one, there is what comes first.
    requester.on<BrowseNextRequest, BrowseNextResponse>([](const BrowseNextRequest& request) {
        BrowseNextResponse response;
        for (std::size_t i = 0; i < request.continuation_points.size(); ++i) {
            response.results.push_back({status::Bad_ContinuationPointInvalid, {}, {}});
        }
        return response;
    });
    browse_all(3);
    REQUIRE(requester.run());
    CHECK(done == 2);
    CHECK(results[1].status_code == status::Uncertain_NotAllNodesAvailable);
    CHECK(results[1].references.size() == 3);
}

TEST_CASE_METHOD(BrowseFixture, "A cancelled Browse releases its continuation points")
{
    const int steps = GENERATE(0, 1, 2, 3, 4);
    requester.info.operation_limits.max_nodes_per_browse = 2;
    Operation operation = browse_all(31);
    for (int i = 0; i < steps; ++i) {
        requester.step();
    }
    operation.cancel();
    REQUIRE(requester.run());
    CHECK(done == 0);
    CHECK(points.empty());
    CHECK(browsed < 31);
}

TEST_CASE_METHOD(BrowseFixture, "A tree is walked once around its cycles and no deeper than asked")
{
    requester.on<BrowseRequest, BrowseResponse>([](const BrowseRequest& request) {
        BrowseResponse response;
        for (const BrowseDescription& item : request.nodes_to_browse) {
            // Each node has its double and its successor below it, and all have the first.
            BrowseResult& result = response.results.emplace_back();
            const std::uint32_t n = item.node_id.numeric();
            for (const std::uint32_t child : {1U, n * 2, n + 1}) {
                result.references.emplace_back().node_id = NodeId{2, child};
            }
            result.references.emplace_back().node_id = ExpandedNodeId{NodeId{2, 1}, {}, 1};
        }
        return response;
    });
    BrowsedTree tree;
    const auto walk = [&](TreeLimits limits) {
        browse_tree(
            requester, {NodeId{2, 1}}, children_of({}), [&](BrowsedTree t) { tree = std::move(t); },
            limits);
        REQUIRE(requester.run());
    };
    TreeLimits limits;
    limits.max_depth = 3;
    walk(limits);
    CHECK_FALSE(tree.is_complete);
    REQUIRE(tree.nodes.size() == 1 + (1 + 1) + 2 + 3);
    CHECK(tree.nodes[0].parent == TreeNode::no_parent);
    CHECK(tree.nodes.back().depth == 3);
    limits.max_depth = 1'000;
    limits.max_nodes = 50;
    walk(limits);
    CHECK(tree.nodes.size() == 50);
    CHECK_FALSE(tree.is_complete);
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

TEST_CASE("Addresses are resolved with as few requests as it takes")
{
    ScriptedRequester requester;
    std::vector<BrowsePath> paths;
    requester.on<TranslateBrowsePathsToNodeIdsRequest, TranslateBrowsePathsToNodeIdsResponse>(
        [&](const TranslateBrowsePathsToNodeIdsRequest& request) {
            TranslateBrowsePathsToNodeIdsResponse response;
            for (const BrowsePath& path : request.browse_paths) {
                paths.push_back(path);
                const String& name = path.relative_path.elements.back().target_name.name;
                BrowsePathResult& result = response.results.emplace_back();
                const BrowsePathTarget target{NodeId{2, name}, UINT32_MAX};
                if (name.view() == "two") {
                    result.targets = {target, target};
                } else if (name.view() == "far") {
                    result.targets = {BrowsePathTarget{NodeId{2, name}, 1}};
                } else if (name.view() == "none") {
                    result.status_code = status::Bad_NoMatch;
                } else {
                    result.targets = {target};
                }
            }
            return response;
        });
    std::vector<Result<NodeId>> ids;
    const auto resolved = [&](const std::vector<const char*>& texts) {
        std::vector<NodeAddress> addresses;
        for (const char* text : texts) {
            addresses.push_back(NodeAddress::parse(text).value());
        }
        ids.clear();
        resolve(requester, addresses, [&](std::vector<Result<NodeId>> r) { ids = std::move(r); });
        CHECK(ids.empty());
        REQUIRE(requester.run());
        REQUIRE(ids.size() == texts.size());
    };
    resolved({"i=2258", "nsu=urn:acme;s=Pump", "nsu=urn:else;s=Pump", "svr=1;i=5"});
    CHECK(requester.sent() == 0);
    CHECK(ids[0] == NodeId{0, 2258});
    CHECK(ids[1] == NodeId{2, "Pump"});
    CHECK(ids[2] == fail(status::Bad_NodeIdUnknown));
    CHECK(ids[3] == fail(status::Bad_ServerIndexInvalid));

    resolved({"/Objects/nsu=urn:acme;Speed", "i=1", "[nsu=urn:acme;i=7]<HasComponent>two", "/none",
              "/far", "/nsu=urn:else;x"});
    CHECK(requester.sent() == 1);
    CHECK(ids[0] == NodeId{2, "Speed"});
    CHECK(ids[1] == NodeId{0, 1});
    CHECK(ids[2] == fail(status::Bad_TooManyMatches));
    CHECK(ids[3] == fail(status::Bad_NoMatch));
    CHECK(ids[4] == fail(status::Bad_NoMatch));
    CHECK(ids[5] == fail(status::Bad_NodeIdUnknown));
    REQUIRE(paths.size() == 4);
    CHECK(paths[0].starting_node == NodeId{0, id::RootFolder});
    CHECK(paths[0].relative_path.elements[1].target_name == QualifiedName{2, "Speed"});
    CHECK(paths[1].starting_node == NodeId{2, 7});

    // A ReferenceType of the server is looked up below References, once.
    requester.on<BrowseRequest, BrowseResponse>([](const BrowseRequest& request) {
        BrowseResponse response;
        response.results.resize(request.nodes_to_browse.size());
        if (request.nodes_to_browse[0].node_id.is(id::References)) {
            ReferenceDescription& type = response.results[0].references.emplace_back();
            type.node_id = NodeId{2, 50};
            type.browse_name = {2, "Feeds"};
        }
        return response;
    });
    resolved({"/a<2:Feeds>b", "/a<2:Unknown>b"});
    CHECK(ids[0] == NodeId{2, "b"});
    CHECK(ids[1] == fail(status::Bad_ReferenceTypeIdInvalid));
    CHECK(paths.back().relative_path.elements[1].reference_type_id == NodeId{2, 50});

    // Without a session so far, a request waits for it.
    requester.info = {};
    resolved({"nsu=urn:acme;s=Pump"});
    CHECK(ids[0] == fail(status::Bad_ServiceUnsupported));
    requester.on<ReadRequest, ReadResponse>([&](const ReadRequest&) {
        requester.info.namespaces = {"http://opcfoundation.org/UA/", "urn:acme"};
        ReadResponse response;
        response.results.resize(1);
        return response;
    });
    resolved({"nsu=urn:acme;s=Pump"});
    CHECK(ids[0] == NodeId{1, "Pump"});
}

TEST_CASE("The services work with a server")
{
    test::ServerFixture fixture;
    test::ServerRequester requester{fixture.log_in()};
    requester.info.operation_limits.max_nodes_per_browse = 7;
    requester.info.operation_limits.max_nodes_per_read = 50;
    BrowsedTree tree;
    TreeLimits limits;
    limits.browse.references_per_answer = 2;
    browse_tree(
        requester, {NodeId{0, id::ObjectsFolder}}, children_of({}),
        [&](BrowsedTree t) { tree = std::move(t); }, limits);
    requester.run();
    CHECK(tree.is_complete);
    CHECK(tree.nodes.size() > 20);

    std::vector<NodeAddress> nodes;
    for (const TreeNode& node : tree.nodes) {
        nodes.push_back(node.reference.node_id.node_id);
    }
    nodes.push_back(NodeAddress::parse("/Objects/Server/ServerStatus<HasComponent>State").value());
    nodes.push_back(NodeAddress::parse("/Objects/None").value());
    std::vector<DataValue> names;
    read(
        requester, nodes, [&](std::vector<DataValue> v) { names = std::move(v); },
        AttributeId::BrowseName);
    requester.run();
    REQUIRE(names.size() == nodes.size());
    CHECK(names.front().value == Variant{QualifiedName{0, "Objects"}});
    CHECK(names[names.size() - 2].value == Variant{QualifiedName{0, "State"}});
    CHECK(names.back().status == status::Bad_NoMatch);

    std::size_t endpoints = 0;
    get_endpoints(
        requester, "opc.tcp://localhost:4840",
        [&](const Result<std::vector<EndpointDescription>>& r) { endpoints = r.value().size(); });
    std::string server;
    find_servers(requester, "opc.tcp://localhost:4840",
                 [&](const Result<std::vector<ApplicationDescription>>& r) {
                     server = r.value().at(0).application_uri.str();
                 });
    requester.run();
    CHECK(endpoints > 1);
    CHECK(server == "urn:busbar:test:server");
}

} // namespace busbar::client
