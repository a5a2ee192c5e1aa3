#include <catch2/catch.hpp>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

#include <busbar/server/running_server.hpp>
#include <busbar/types/view.hpp>

#include "managed_fixture.hpp"

namespace transfer_nodes_test {

// Part 20, 4.4: temporary files as clients see them.

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

ByteString byte_string(std::string_view text)
{
    return ByteString{std::as_bytes(std::span{text})};
}

/// A file as the session that has it knows it.
struct Made {
    NodeId node;
    Variant handle;
};

struct TransferFixture : ManagedFixture {
    explicit TransferFixture(server::Worker* w = nullptr) : ManagedFixture{w}
    {
        REQUIRE(user_list.add({"eng", {}, 0, {}, {"Engineer"}}, "patience is all", random));
        REQUIRE(user_list.add({"op", {}, 0, {}, {"Operator"}}, "patience is all", random));
        REQUIRE(user_list.add({"looker", {}, 0, {}, {"Observer"}}, "patience is all", random));
        const auto bytes = std::as_bytes(std::span{std::string_view{"all of it"}});
        transfers.made.assign(bytes.begin(), bytes.end());
    }
    TestClient log_in_as(const char* name) { return log_in(name, "patience is all"); }
    static NodeId below(const NodeId& object, const char* name)
    {
        return NodeId{1, String{object.string().str() + "//" + name}};
    }
    CallMethodResult on(TestClient& client, const NodeId& object, const char* method,
                        std::vector<Variant> inputs)
    {
        return call(client, object, below(object, method), std::move(inputs));
    }
    std::string_view why(TestClient& client, const NodeId& object, const char* method,
                         std::vector<Variant> inputs)
    {
        return name(on(client, object, method, std::move(inputs)).status_code);
    }
    Made make(TestClient& client, const char* method, Variant options = {})
    {
        const auto result = on(client, root, method, {std::move(options)});
        REQUIRE(result.status_code == status::Good);
        return {*result.output_arguments[0].get_if<NodeId>(), result.output_arguments[1]};
    }
    std::string text(TestClient& client, const Made& file, std::int32_t length = 1'000)
    {
        const auto result = on(client, file.node, "Read", {file.handle, Variant{length}});
        if (result.status_code.is_bad()) {
            return std::string{name(result.status_code)};
        }
        const auto bytes = result.output_arguments[0].get_if<ByteString>()->span();
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    std::string_view write(TestClient& client, const Made& file, std::string_view bytes)
    {
        return why(client, file.node, "Write", {file.handle, Variant{byte_string(bytes)}});
    }
    std::string_view commit(TestClient& client, const Made& file)
    {
        return why(client, root, "CloseAndCommit", {file.handle});
    }
    static DataValue value(TestClient& client, const NodeId& object, const char* property)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = below(object, property);
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    /// The NodeIds of what has a reference with the node, in either direction.
    static std::vector<NodeId> around(TestClient& client, const NodeId& node)
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = node;
        request.nodes_to_browse[0].browse_direction = BrowseDirection::Both;
        request.nodes_to_browse[0].result_mask = 63;
        const auto response = client.call<BrowseResponse>(request);
        REQUIRE(response);
        std::vector<NodeId> result;
        for (const auto& each : response->results[0].references) {
            result.push_back(each.node_id.node_id);
        }
        return result;
    }

    /// Whether there is no file of anybody.
    [[nodiscard]] bool space_is_empty()
    {
        const auto& space = server.address_space();
        std::size_t nodes = 0;
        space.for_each_below(space.find(NodeId{1, "Transfers/backup/files"}),
                             [&](model::NodeIndex) { return ++nodes != 0; });
        return nodes == 1;
    }
    [[nodiscard]] std::size_t node_count() { return server.address_space().node_count(); }

    const NodeId root{1, "Transfers/backup"};
};

} // namespace

TEST_CASE_METHOD(TransferFixture, "transfer nodes: what a program makes is read, and then gone")
{
    auto client = log_in_as("op");
    const auto result = on(client, root, "GenerateFileForRead", {Variant{}});
    REQUIRE(result.status_code == status::Good);
    REQUIRE(result.output_arguments.size() == 3);
    CHECK(result.output_arguments[2] == Variant{NodeId{}}); // it is complete
    const Made file{*result.output_arguments[0].get_if<NodeId>(), result.output_arguments[1]};
    CHECK(value(client, file.node, "Size").value == Variant{std::uint64_t{9}});
    CHECK(value(client, file.node, "OpenCount").value == Variant{std::uint16_t{1}});
    CHECK(value(client, file.node, "Writable").value == Variant{false});
    CHECK(value(client, root, "x").status == status::Bad_NodeIdUnknown);
    CHECK(text(client, file, 3) == "all");
    CHECK(on(client, file.node, "GetPosition", {file.handle}).output_arguments[0] ==
          Variant{std::uint64_t{3}});
    CHECK(why(client, file.node, "SetPosition", {file.handle, Variant{std::uint64_t{4}}}) ==
          "Good");
    // Nobody has to browse for the Methods (Part 4, 5.12.2).
    CHECK(call(client, file.node, NodeId{0, id::FileType_GetPosition}, {file.handle})
              .output_arguments[0] == Variant{std::uint64_t{4}});
    CHECK(text(client, file) == "of it");
    CHECK(text(client, file).empty());
    CHECK(why(client, file.node, "Open", {Variant{std::uint8_t{1}}}) == "Bad_InvalidState");
    CHECK(why(client, file.node, "Close", {file.handle}) == "Good");
    CHECK(text(client, file) == "Bad_NodeIdUnknown");
    CHECK(value(client, file.node, "Size").status == status::Bad_NodeIdUnknown);
    CHECK(space_is_empty());
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: a program takes what is committed")
{
    auto client = log_in_as("eng");
    const Made file = make(client, "GenerateFileForWrite", Variant{String{"project 4"}});
    CHECK(value(client, file.node, "Writable").value == Variant{true});
    CHECK(write(client, file, "half") == "Good");
    CHECK(text(client, file) == "Bad_InvalidState");
    transfers.answer = status::Bad_ResourceUnavailable;
    CHECK(commit(client, file) == "Bad_ResourceUnavailable"); // and is not lost
    transfers.answer = status::Good;
    CHECK(write(client, file, " and half") == "Good");
    CHECK(commit(client, file) == "Good");
    REQUIRE(transfers.taken.size() == 1);
    CHECK(ByteString{transfers.taken[0]} == byte_string("half and half"));
    CHECK(transfers.options == Variant{String{"project 4"}});
    CHECK(transfers.user == "eng");
    CHECK_FALSE(transfers.session.is_null());
    CHECK(commit(client, file) == "Bad_InvalidArgument");

    const Made closed = make(client, "GenerateFileForWrite");
    CHECK(write(client, closed, "never mind") == "Good");
    CHECK(why(client, closed.node, "Close", {closed.handle}) == "Good");
    CHECK(commit(client, closed) == "Bad_InvalidArgument");
    const Made read = make(client, "GenerateFileForRead");
    CHECK(commit(client, read) == "Bad_InvalidState");
    CHECK(transfers.taken.size() == 1);
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: work while the server does not (Part 5, 12.6)")
{
    auto client = log_in_as("eng");
    const ServerState state = GENERATE(ServerState::Suspended, ServerState::Failed);
    REQUIRE(server::RunningServer{server}.change_state(state, "halted", {}));
    CHECK(text(client, make(client, "GenerateFileForRead")) == "all of it");
    const Made file = make(client, "GenerateFileForWrite");
    CHECK(write(client, file, "what mends it") == "Good");
    CHECK(commit(client, file) == "Good");
    CHECK(transfers.taken.size() == 1);
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: files are of one session alone")
{
    auto client = log_in_as("eng");
    auto other = log_in_as("eng");
    const Made file = make(client, "GenerateFileForRead");
    const Made written = make(client, "GenerateFileForWrite");
    CHECK(text(other, file) == "Bad_InvalidArgument");
    CHECK(write(other, written, "x") == "Bad_InvalidArgument");
    CHECK(why(other, file.node, "Close", {file.handle}) == "Bad_InvalidArgument");
    CHECK(commit(other, written) == "Bad_InvalidArgument");
    // Nor is a handle of one file that of another, or what was never one.
    CHECK(text(client, {file.node, written.handle}) == "Bad_InvalidArgument");
    CHECK(text(client, {file.node, Variant{std::uint32_t{0}}}) == "Bad_InvalidArgument");
    CHECK(text(client, {file.node, Variant{UINT32_MAX}}) == "Bad_InvalidArgument");
    CHECK(text(client, file) == "all of it");
    // Nothing leads to them.
    std::vector<NodeId> seen{root};
    for (std::size_t i = 0; i < seen.size(); ++i) {
        for (const NodeId& each : around(other, seen[i])) {
            const bool is_ours = each.namespace_index() == 1 &&
                                 std::find(seen.begin(), seen.end(), each) == seen.end();
            if (is_ours) {
                seen.push_back(each);
            }
            CHECK_FALSE(each == file.node);
            CHECK_FALSE(each == written.node);
        }
    }
    CHECK(around(other, NodeId{1, "Transfers/backup/files"}).empty());
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: readers get, writers send, others see nothing")
{
    auto reader = log_in_as("op");
    CHECK(why(reader, root, "GenerateFileForWrite", {Variant{}}) == "Bad_NodeIdUnknown");
    CHECK(why(reader, root, "CloseAndCommit", {Variant{std::uint32_t{1}}}) == "Bad_NodeIdUnknown");
    const Made file = make(reader, "GenerateFileForRead");
    CHECK(write(reader, file, "x") == "Bad_NodeIdUnknown");
    auto looker = log_in_as("looker");
    CHECK(why(looker, root, "GenerateFileForRead", {Variant{}}) == "Bad_NodeIdUnknown");
    CHECK(value(looker, file.node, "Size").status == status::Bad_NodeIdUnknown);
    auto signed_only = log_in("eng", "patience is all", MessageSecurityMode::Sign);
    CHECK(why(signed_only, root, "GenerateFileForRead", {Variant{}}) ==
          "Bad_SecurityModeInsufficient");
    auto writer = log_in_as("eng");
    CHECK(why(writer, root, "GenerateFileForWrite", {Variant{true}}) == "Bad_InvalidArgument");
    CHECK(why(writer, root, "GenerateFileForRead", {Variant{true}}) == "Bad_InvalidArgument");
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: how many and how large is limited")
{
    auto client = log_in_as("eng");
    const auto generate = [&](TestClient& who, std::uint32_t size) {
        return why(who, root, "GenerateFileForRead", {Variant{size}});
    };
    CHECK(generate(client, 100'001) == "Bad_EncodingLimitsExceeded");
    CHECK(generate(client, 100'000) == "Good");
    auto other = log_in_as("eng");
    CHECK(generate(other, 50'001) == "Bad_EncodingLimitsExceeded");
    CHECK(transfers.last_max_size == 50'000);
    CHECK(generate(other, 49'990) == "Good");
    const Made file = make(other, "GenerateFileForWrite");
    CHECK(write(other, file, std::string(11, 'x')) == "Bad_OutOfMemory");
    CHECK(write(other, file, std::string(10, 'x')) == "Good");
    CHECK(generate(other, 0) == "Bad_TooManyOperations");
    CHECK(generate(client, 0) == "Bad_TooManyOperations"); // three of all
    CHECK(commit(other, file) == "Good");
    CHECK(generate(client, 10) == "Good");
    CHECK(generate(client, 0) == "Bad_TooManyOperations"); // two of its own
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: files go with their time and their session")
{
    auto client = log_in_as("eng");
    CHECK(value(client, root, "ClientProcessingTimeout").value == Variant{20'000.0});
    const Made file = make(client, "GenerateFileForWrite");
    advance(15s);
    CHECK(write(client, file, "x") == "Good"); // and its time begins anew
    advance(15s);
    CHECK(value(client, file.node, "Size").status == status::Good);
    advance(5s);
    CHECK(value(client, file.node, "Size").status == status::Bad_NodeIdUnknown);
    CHECK(commit(client, file) == "Bad_InvalidArgument");
    CHECK(transfers.taken.empty());
    CHECK(space_is_empty());
    {
        auto other = log_in_as("eng");
        static_cast<void>(make(other, "GenerateFileForWrite"));
        static_cast<void>(make(other, "GenerateFileForRead", Variant{std::uint32_t{100'000}}));
        CHECK_FALSE(space_is_empty());
        other.close_session();
    }
    static_cast<void>(make(client, "GenerateFileForRead", Variant{std::uint32_t{100'000}}));
    CHECK(transfers.last_max_size == 100'000);
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: many files after each other leave nothing")
{
    auto client = log_in_as("eng");
    const std::size_t before = node_count();
    for (int i = 0; i < 50; ++i) {
        const Made file = make(client, i % 2 == 0 ? "GenerateFileForRead" : "GenerateFileForWrite");
        CHECK(why(client, file.node, "Close", {file.handle}) == "Good");
    }
    CHECK(node_count() == before);
}

TEST_CASE("transfer nodes: one that cannot work is refused")
{
    FixedWallClock clock;
    LogBook log;
    PlainTransfers owner;
    SeededRandom random;
    ManagedFixture machine;
    const auto problem = [&](const administration::TemporaryFileTransfer& transfer,
                             crypto::Random* source) {
        administration::Administration other{
            {.wall_clock = &clock, .log = &log, .random = source, .file_transfers = {transfer}}};
        const auto attached = other.attach(machine.server);
        REQUIRE_FALSE(attached);
        return attached.error().where;
    };
    CHECK(problem({.name = "b", .owner = &owner}, nullptr) == "random");
    CHECK(problem({.name = "b"}, &random) == "transfer \"b\"");
    CHECK(problem({.name = "a/b", .owner = &owner}, &random) == "transfer \"a/b\"");
    CHECK(problem({.name = "b", .owner = &owner, .client_processing_timeout = 0ms}, &random) ==
          "transfer \"b\"");
    CHECK(problem({.name = "backup", .owner = &owner}, &random) == "transfer backup");
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: a handle that is void is refused by all Methods")
{
    auto client = log_in_as("eng");
    const Made file = make(client, "GenerateFileForWrite");
    const Made other = make(client, "GenerateFileForRead");
    for (const Variant& handle : {Variant{std::uint32_t{0}}, other.handle}) {
        const Made wrong{file.node, handle};
        CHECK(text(client, wrong) == "Bad_InvalidArgument");
        CHECK(write(client, wrong, "x") == "Bad_InvalidArgument");
        CHECK(why(client, file.node, "GetPosition", {handle}) == "Bad_InvalidArgument");
        CHECK(why(client, file.node, "SetPosition", {handle, Variant{std::uint64_t{0}}}) ==
              "Bad_InvalidArgument");
        CHECK(why(client, file.node, "Close", {handle}) == "Bad_InvalidArgument");
    }
    CHECK(text(client, other, -1) == "Bad_InvalidArgument");
    CHECK(why(client, root, "GenerateFileForWrite", {Variant{}}) == "Bad_TooManyOperations");
    CHECK(write(client, file, "x") == "Good");
}

TEST_CASE_METHOD(TransferFixture,
                 "transfer nodes: a file says when it was written, and by how much")
{
    auto client = log_in_as("eng");
    const Made file = make(client, "GenerateFileForWrite");
    CHECK(value(client, file.node, "LastModifiedTime").value == Variant{wall_clock.time});
    advance(1s);
    REQUIRE(write(client, file, "x") == "Good");
    CHECK(value(client, file.node, "LastModifiedTime").value == Variant{wall_clock.time});
    CHECK(value(client, file.node, "Size").value == Variant{std::uint64_t{1}});
    CHECK(value(client, file.node, "UserWritable").value == Variant{true});
    CHECK(value(client, file.node, "MaxByteStringLength").value == Variant{std::uint32_t{65'536}});
}

TEST_CASE_METHOD(TransferFixture, "transfer nodes: one Call that closes a file and goes on with it")
{
    auto client = log_in_as("eng");
    const Made file = make(client, "GenerateFileForWrite");
    CallRequest request;
    request.methods_to_call.resize(3);
    for (CallMethodRequest& one : request.methods_to_call) {
        one.object_id = file.node;
        one.method_id = below(file.node, "Close");
        one.input_arguments = {file.handle};
    }
    request.methods_to_call[1].method_id = below(file.node, "Write");
    request.methods_to_call[1].input_arguments = {file.handle, Variant{byte_string("x")}};
    const auto sent = client.send(request);
    complete();
    const auto response = client.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Good");
    CHECK(response->results[1].status_code.is_bad());
    CHECK(response->results[2].status_code.is_bad());
    CHECK(space_is_empty());
}

namespace {

/// A file that is being taken on a worker, which works when it is told to.
struct SlowTransfer {
    SlowTransfer()
    {
        fixture.transfers.is_slow = true;
        REQUIRE(fixture.write(client, file, "a project") == "Good");
    }
    void begin()
    {
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = fixture.root;
        request.methods_to_call[0].method_id = fixture.below(fixture.root, "CloseAndCommit");
        request.methods_to_call[0].input_arguments = {file.handle};
        sent = client.send(request);
        fixture.complete();
    }
    std::string_view finish()
    {
        worker.work();
        fixture.complete();
        const auto response = client.take<CallResponse>(sent);
        REQUIRE(response);
        return name(response->results[0].status_code);
    }

    ManualWorker worker;
    TransferFixture fixture{&worker};
    TestClient client{fixture.log_in_as("eng")};
    Made file{fixture.make(client, "GenerateFileForWrite")};
    decltype(client.send(CallRequest{})) sent{};
};

} // namespace

TEST_CASE_METHOD(SlowTransfer, "transfer nodes: others are served while a file is taken")
{
    auto other = fixture.log_in_as("op");
    begin();
    CHECK(fixture.transfers.prepared.empty());
    for (int i = 0; i < 3; ++i) {
        CHECK(fixture.value(other, fixture.root, "ClientProcessingTimeout").status == status::Good);
        fixture.now += 10ms;
        fixture.server.handle_deadline(fixture.now);
    }
    CHECK(fixture.value(client, fixture.root, "ClientProcessingTimeout").status == status::Good);
    // What is being taken stays as it is.
    CHECK(fixture.write(client, file, "more") == "Bad_InvalidState");
    CHECK(fixture.commit(client, file) == "Bad_InvalidState");
    CHECK(fixture.transfers.taken.empty());
    CHECK(finish() == "Good");
    CHECK(fixture.transfers.taken.size() == 1);
    REQUIRE(fixture.transfers.prepared.size() == 1);
    CHECK(fixture.transfers.prepared[0].size() == 9);
    CHECK(fixture.space_is_empty());
}

TEST_CASE_METHOD(SlowTransfer, "transfer nodes: what a worker refuses the client has still")
{
    fixture.transfers.answer = status::Bad_ConfigurationError;
    begin();
    CHECK(finish() == "Bad_ConfigurationError");
    CHECK(fixture.write(client, file, ", again") == "Good");
    worker.has_room = false;
    begin();
    CHECK(finish() == "Bad_TooManyOperations");
    CHECK(fixture.transfers.taken.empty());
    CHECK(fixture.transfers.prepared.size() == 1); // and nothing is done
    worker.has_room = true;
    fixture.transfers.answer = status::Good;
    begin();
    CHECK(finish() == "Good");
    CHECK(fixture.transfers.prepared.back().size() == 16);
}

TEST_CASE_METHOD(SlowTransfer, "transfer nodes: a file is not taken if its session ends before")
{
    begin();
    auto other = fixture.log_in_as("eng");
    REQUIRE(client.close_session() == status::Good);
    CHECK(fixture.why(other, fixture.root, "GenerateFileForRead", {Variant{}}) == "Good");
    worker.work();
    fixture.complete();
    CHECK(fixture.transfers.taken.empty());
    REQUIRE(fixture.transfers.prepared.size() == 1); // which nobody stops
    CHECK(fixture.transfers.prepared[0].size() == 9);
}

TEST_CASE_METHOD(SlowTransfer, "transfer nodes: a file is not taken once its client was told that "
                               "the server stops")
{
    begin();
    fixture.server.begin_shutdown(fixture.now, "another one takes its place");
    const auto response = client.take<CallResponse>(sent);
    REQUIRE_FALSE(response);
    CHECK(name(response.error()) == "Bad_Shutdown");
    worker.work();
    fixture.complete();
    CHECK(fixture.transfers.prepared.size() == 1);
    CHECK(fixture.transfers.taken.empty());
}

} // namespace transfer_nodes_test
