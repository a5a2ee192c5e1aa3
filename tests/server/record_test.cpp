#include <catch2/catch.hpp>

#include <algorithm>
#include <utility>

#include <busbar/crypto/certificate_notices.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/session.hpp>

#include "management_fixture.hpp"

namespace record_test {

using namespace busbar;
using namespace busbar::test;

namespace {

using Lines = std::vector<std::string>;

Lines news(ServerFixture& fixture)
{
    return std::exchange(fixture.log.records, {});
}

struct Recorded : ServerFixture {
    Recorded() { log.keeps_records = true; }
};

} // namespace

TEST_CASE_METHOD(Recorded, "record: a session from its channel to its end")
{
    auto client = connect("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
    CHECK(news(*this) == Lines{"ChannelOpened Good / 192.0.2.1 RequestType SecurityPolicyUri "
                               "SecurityMode RequestedLifetime"});
    auto request = client.create_request();
    request.request_header.audit_entry_id = "audit 7";
    request.endpoint_url = "opc.tcp://localhost:4840";
    REQUIRE(client.create_session(request));
    CHECK(news(*this) == Lines{"SessionCreated Good test/ 192.0.2.1 RevisedSessionTimeout "
                               "EndpointUrl by audit 7"});
    const auto refused = client.send_activate(client.user("operator", "wrong"));
    advance(std::chrono::seconds{10}, client);
    CHECK(client.take_activate(refused) == status::Bad_UserAccessDenied);
    CHECK(news(*this) ==
          Lines{"LoginRefused Bad_UserAccessDenied test/operator 192.0.2.1 UserIdentityToken"});
    CHECK(client.activate(client.user("operator", "operator-secret")) == status::Good);
    CHECK(news(*this) ==
          Lines{"SessionActivated Good test/operator 192.0.2.1 UserTokenType IsFirst "
                "UserIdentityToken"});
    CHECK(client.status_of<CancelResponse>(CancelRequest{}) == status::Good);
    CHECK(news(*this) == Lines{"RequestCancelled Good test/operator 192.0.2.1 RequestHandle"});
    CHECK(client.close_session() == status::Good);
    CHECK(news(*this) ==
          Lines{"SessionClosed Bad_SessionClosed test/operator 192.0.2.1 WasActivated Cause"});
}

TEST_CASE_METHOD(Recorded, "record: what is refused, and the line besides")
{
    auto client = connect();
    static_cast<void>(news(*this));
    log.text.clear();
    auto request = client.create_request();
    request.server_uri = "urn:another";
    CHECK_FALSE(client.create_session(request));
    CHECK(news(*this) == Lines{"SessionRefused Bad_ServerUriInvalid test/ 192.0.2.1"});
    CHECK(log.text.find("ServerUri failed") != std::string::npos);
    CHECK(std::count(log.text.begin(), log.text.end(), '\n') == 1);

    const std::vector<std::byte> nonsense(64, std::byte{'x'});
    static_cast<void>(client.connection.feed(nonsense, now));
    CHECK(news(*this).front().find("ChannelRefused Bad_") == 0);
}

TEST_CASE_METHOD(Recorded, "record: a certificate's name is that of the URL")
{
    auto client = connect("Basic256Sha256", MessageSecurityMode::Sign);
    static_cast<void>(news(*this));
    auto request = client.create_request();
    const crypto::Certificate& own = server_identity().certificates.front();
    REQUIRE(crypto::names_host(own, "localhost"));
    for (const auto& [url, is_told] : {std::pair{"opc.tcp://localhost:4840", false},
                                       std::pair{"opc.tcp://LOCALHOST:4840", false},
                                       std::pair{"opc.tcp://plc.example:4840", true},
                                       std::pair{"no url", true}, std::pair{"", false}}) {
        INFO(url);
        request.client_nonce = client.create_request().client_nonce;
        request.endpoint_url = url;
        REQUIRE(client.create_session(request));
        const Lines lines = news(*this);
        CHECK(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
                  return line.find("UrlMismatch") == 0;
              }) == is_told);
    }
}

TEST_CASE_METHOD(Recorded, "record: Writes and Calls, done or refused")
{
    auto client = log_in();
    static_cast<void>(news(*this));
    WriteRequest write;
    write.nodes_to_write.resize(2);
    write.nodes_to_write[0].node_id = NodeId{0, id::Server_ServiceLevel};
    write.nodes_to_write[0].attribute_id = 13;
    write.nodes_to_write[1].node_id = NodeId{0, 1U << 30U};
    write.nodes_to_write[1].attribute_id = 13;
    static_cast<void>(client.call<WriteResponse>(write));
    CHECK(news(*this) == Lines{"AttributeWritten Bad_NotWritable test/ 192.0.2.1 NodeId "
                               "AttributeId IndexRange NewValue",
                               "AttributeWritten Bad_NodeIdUnknown test/ 192.0.2.1 NodeId "
                               "AttributeId IndexRange NewValue"});
    CallRequest call;
    call.request_header.audit_entry_id = "audit 9";
    call.methods_to_call.resize(1);
    call.methods_to_call[0].object_id = NodeId{0, id::Server};
    call.methods_to_call[0].method_id = NodeId{0, id::Server_ResendData};
    static_cast<void>(client.call<CallResponse>(call));
    const Lines lines = news(*this);
    REQUIRE(lines.size() == 1);
    CHECK(lines.front().find("MethodCalled Bad_") == 0);
    CHECK(lines.front().find("192.0.2.1 ObjectId MethodId InputArguments by audit 9") !=
          std::string::npos);
    log.keeps_records = false;
    static_cast<void>(client.call<WriteResponse>(write));
    CHECK(log.records.empty());
}

TEST_CASE_METHOD(Recorded, "record: a Write that ends early, with what was written by then")
{
    struct LateSource final : server::DataSource {
        void read(server::ReadBatch) override {}
        void write(server::WriteBatch batch) override { writes.push_back(std::move(batch)); }
        std::vector<server::WriteBatch> writes;
    };
    LateSource late;
    server::MemorySource quick{wall_clock};
    model::AddressSpace& space = server.address_space();
    const auto add = [&](const char* name, std::uint32_t source, std::uint64_t handle) {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = space.find(id::ObjectsFolder);
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        variable.access_level = model::Access::ReadWrite;
        variable.source = source;
        variable.handle = handle;
        REQUIRE(space.add_variable(node, variable));
    };
    users.everybody.access_level_mask = 0xFF;
    add("Late", server.add_source(late), 0);
    add("Quick", server.add_source(quick), quick.add(Variant{1}));
    auto client = log_in();
    static_cast<void>(news(*this));
    WriteRequest write;
    for (const char* name : {"Late", "Quick", "None"}) {
        WriteValue& each = write.nodes_to_write.emplace_back();
        each.node_id = NodeId{1, name};
        each.attribute_id = 13;
        each.value.value = Variant{7};
    }
    client.send(write);
    REQUIRE(late.writes.size() == 1);
    CHECK_FALSE(late.writes[0].is_abandoned());
    CHECK(client.close_session() == status::Good);
    CHECK(late.writes[0].is_abandoned());
    const Lines lines = news(*this);
    REQUIRE(lines.size() == 4); // and the end of the session
    CHECK(lines[0].find("AttributeWritten Bad_SessionClosed") == 0);
    CHECK(lines[1].find("AttributeWritten Good") == 0);
    CHECK(lines[2].find("AttributeWritten Bad_NodeIdUnknown") == 0);
    late.writes[0].finish(status::Good);
    server.handle_completions(now);
    CHECK(news(*this) == Lines{});
}

TEST_CASE("record: nodes and references that clients add and delete")
{
    ManagementFixture fixture;
    fixture.log.keeps_records = true;
    const auto added = fixture.add(ManagementFixture::item());
    CHECK(added.status_code == status::Good);
    CHECK(fixture.remove(added.added_node_id) == status::Good);
    const Lines lines = std::exchange(fixture.log.records, {});
    REQUIRE(lines.size() == 2);
    CHECK(lines[0].find("NodesAdded Good ") == 0);
    CHECK(lines[1].find("NodesDeleted Good ") == 0);
}

} // namespace record_test
