#include <busbar/server/event.hpp>

#include "configuration_fixture.hpp"
#include "trust_list_ids.hpp"

namespace audit_once_test {

// Each Method and each node of a Write has one audit event, of AuditUpdateMethodEventType or a
// subtype and of AuditWriteUpdateEventType (Part 4, 6.5.8 and 6.5.9), also if its client leaves
// before the answer.

using namespace busbar;
using namespace busbar::test;

namespace {

using Lines = std::vector<std::string>;

struct Audited : Configuration {
    explicit Audited(server::Worker* w = nullptr) : Configuration{w}
    {
        audit.attach(queue, "urn:busbar:test:server");
    }
    /// "AuditUpdateMethod admin Good" for each event of a Method, Write or change since the last
    /// call.
    Lines events()
    {
        Lines found;
        server::Event event;
        while (queue->next(event)) {
            const std::string type = name_of(event.event_type);
            if (!type.empty()) {
                found.push_back(
                    type + " " + field(event, "ClientUserId").value_or<String>({}).str() + " " +
                    std::string{name(field(event, "StatusCodeId").value_or<StatusCode>({}))});
            }
        }
        return found;
    }
    static Variant field(const server::Event& event, std::string_view name)
    {
        for (const auto& each : event.fields) {
            if (each.path.size() == 1 && each.path[0].name == name) {
                return each.value;
            }
        }
        return {};
    }
    static std::string name_of(const NodeId& type)
    {
        for (const auto& [id, name] :
             {std::pair{id::AuditUpdateMethodEventType, "Method"},
              std::pair{id::RoleMappingRuleChangedAuditEventType, "RoleMappingRuleChanged"},
              std::pair{id::CertificateUpdateRequestedAuditEventType, "CertificateUpdateRequested"},
              std::pair{id::CertificateUpdatedAuditEventType, "CertificateUpdated"},
              std::pair{id::TrustListUpdateRequestedAuditEventType, "TrustListUpdateRequested"},
              std::pair{id::TrustListUpdatedAuditEventType, "TrustListUpdated"},
              std::pair{id::AuditWriteUpdateEventType, "Write"},
              std::pair{id::AuditSecurityEventType, "Security"}}) {
            if (type.is(id)) {
                return name;
            }
        }
        return {};
    }
    static CallMethodRequest add_user(const char* name)
    {
        CallMethodRequest call;
        call.object_id = NodeId{0, id::UserManagement};
        call.method_id = NodeId{0, id::UserManagement_AddUser};
        call.input_arguments = {Variant{String{name}}, Variant{String{"patience is all"}},
                                Variant{std::uint32_t{0}}, Variant{String{}}};
        return call;
    }
    static WriteRequest write_sessions(std::int64_t value)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = NodeId{1, String{"Settings.limits.sessions"}};
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value.value = Variant{value};
        return request;
    }

    std::shared_ptr<server::EventQueue> queue{
        std::make_shared<server::EventQueue>(wall_clock, nullptr, 64)};
};

} // namespace

TEST_CASE_METHOD(Audited, "audit once: what Methods have changed",
                 "[unit:Auditing Method][unit:Auditing Write]")
{
    auto admin = log_in();
    const auto rule = [](const char* user) {
        return Variant{ExtensionObject::from(
            IdentityMappingRuleType{IdentityCriteriaType::UserName, String{user}})};
    };
    constexpr std::uint32_t add_identity = 15672; // of Observer
    const NodeId observer{0, id::WellKnownRole_Observer};
    CHECK(call(admin, observer, NodeId{0, add_identity}, {rule("pat")}).status_code ==
          status::Good);
    CHECK(events() == Lines{"RoleMappingRuleChanged admin Good"}); // Part 18, 4.5
    CHECK(call(admin, observer, NodeId{0, add_identity}, {rule("pat")}).status_code.is_bad());
    CHECK(events() == Lines{"Method admin Bad_AlreadyExists"});
    const CallMethodRequest pat = add_user("pat");
    for (const char* result : {"Good", "Bad_AlreadyExists"}) {
        static_cast<void>(call(admin, pat.object_id, pat.method_id,
                               {pat.input_arguments.begin(), pat.input_arguments.end()}));
        CHECK(events() == Lines{"Method admin " + std::string{result}});
    }
    for (const std::int64_t sessions : {12, 13}) { // ten and luck
        const auto sent = admin.send(write_sessions(sessions));
        complete();
        REQUIRE(admin.take<WriteResponse>(sent));
    }
    CHECK(events() == Lines{"Write admin Good", "Write admin Bad_InvalidArgument"});
}

TEST_CASE_METHOD(Audited, "audit once: certificates and trust lists (Part 12, 7.8.2 and 7.10)",
                 "[unit:Auditing Method]")
{
    auto admin = log_in();
    const auto add = [&] {
        return name(
            call(admin, NodeId{0, trust_list}, NodeId{0, add_certificate},
                 {Variant{ByteString{issue({}, key_number(1)).certificate.der()}}, Variant{true}})
                .status_code);
    };
    CHECK(add() == "Good");
    CHECK(events() == Lines{"TrustListUpdated admin Good", "TrustListUpdateRequested admin Good"});
    const auto next = successor();
    const auto pem = next.key.to_pem();
    REQUIRE(pem);
    CHECK(update(admin, next.certificates.front(), "PEM", {}) == "Bad_SecurityChecksFailed");
    CHECK(events() == Lines{"CertificateUpdateRequested admin Bad_SecurityChecksFailed"});
    CHECK(update(admin, next.certificates.front(), "PEM", pem->span()) == "Good");
    CHECK(events() == Lines{"CertificateUpdateRequested admin Good"});
    CHECK(add() == "Bad_TransactionPending");
    CHECK(events() == Lines{"TrustListUpdateRequested admin Bad_TransactionPending"});
    CHECK(apply(admin) == "Good");
    auto told = events();
    std::erase(told, "Security  Good"); // the server has another certificate
    CHECK(told == Lines{"CertificateUpdated admin Good", "Method admin Good"});
    CHECK(apply(admin) == "Bad_NothingToDo");
    CHECK(events() == Lines{"Method admin Bad_NothingToDo"});
}

TEST_CASE("audit once: Methods whose client has left before the answer",
          "[attack][unit:Auditing Method]")
{
    ManualWorker worker;
    Audited fixture{&worker};
    auto admin = fixture.log_in();
    CallRequest both;
    both.methods_to_call = {Audited::add_user("ann"), Audited::add_user("bob"),
                            Audited::add_user("cat")};
    const auto sent = admin.send(both);
    fixture.complete();
    worker.work(); // ann's password is hashed
    fixture.complete();
    REQUIRE(fixture.user_list.find("ann"));
    worker.work(); // and bob's, but he is not added yet
    std::string_view end;
    SECTION("by closing its session")
    {
        CHECK(admin.close_session() == status::Good);
        end = "Bad_SessionClosed";
    }
    SECTION("by losing its connection")
    {
        static_cast<void>(TestClient{std::move(admin)});
        end = "Bad_ConnectionClosed";
    }
    SECTION("by Cancel")
    {
        CancelRequest cancel;
        cancel.request_handle = admin.last_handle;
        CHECK(admin.call<CancelResponse>(cancel)->cancel_count == 1);
        end = "Bad_RequestCancelledByClient";
    }
    const std::string left = "Method admin " + std::string{end};
    CHECK(fixture.events() == Lines{"Method admin Good", left, left});
    for (int i = 0; i < 3; ++i) {
        fixture.complete();
        worker.work();
    }
    CHECK(fixture.events() == Lines{});
    CHECK_FALSE(fixture.user_list.find("bob"));
    CHECK_FALSE(fixture.user_list.find("cat"));
    static_cast<void>(sent);
}

TEST_CASE_METHOD(Audited, "audit once: a Write whose client leaves before it is made",
                 "[attack][unit:Auditing Write]")
{
    auto admin = log_in();
    static_cast<void>(admin.send(write_sessions(12)));
    CHECK(admin.close_session() == status::Good);
    complete();
    CHECK(events() == Lines{"Write admin Bad_SessionClosed"});
    CHECK_FALSE(owner.applied.contains("limits.sessions"));
}

TEST_CASE_METHOD(Audited, "audit once: a Method that is posted, whose client leaves before it",
                 "[attack][unit:Auditing Method]")
{
    auto admin = log_in();
    CallRequest request;
    request.methods_to_call.resize(1);
    CallMethodRequest& call = request.methods_to_call[0];
    SECTION("Set")
    {
        call.object_id = NodeId{1, "Settings"};
        call.method_id = NodeId{1, "Settings.Set"};
        call.input_arguments = {Variant{Array<String>{"limits.sessions"}},
                                Variant{Array<Variant>{Variant{std::int64_t{12}}}}};
    }
    SECTION("ResetToServerDefaults")
    {
        call.object_id = NodeId{0, id::ServerConfiguration};
        call.method_id = NodeId{0, id::ServerConfiguration_ResetToServerDefaults};
    }
    static_cast<void>(admin.send(request));
    CHECK(admin.close_session() == status::Good);
    CHECK(events() == Lines{"Method admin Bad_SessionClosed"});
    complete();
    CHECK(events() == Lines{});
    CHECK_FALSE(owner.applied.contains("limits.sessions"));
    CHECK(storage.entry("users.json"));
    CHECK(restarts == 0);
}

TEST_CASE_METHOD(Audited, "audit once: Set answers Good to a refusal, which another event tells",
                 "[unit:Auditing Method]")
{
    auto admin = log_in();
    for (const std::int64_t sessions : {12, 0}) {
        const auto result = call(admin, NodeId{1, "Settings"}, NodeId{1, "Settings.Set"},
                                 {Variant{Array<String>{"limits.sessions"}},
                                  Variant{Array<Variant>{Variant{sessions}}}});
        REQUIRE(result.status_code == status::Good);
        CHECK(result.output_arguments[0] == Variant{sessions == 12});
        CHECK(events() == (sessions == 12
                               ? Lines{"Method admin Good"}
                               : Lines{"Security admin Bad_OutOfRange", "Method admin Good"}));
    }
}

} // namespace audit_once_test
