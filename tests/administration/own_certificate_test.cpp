#include <chrono>
#include <functional>
#include <stdexcept>

#include <busbar/server/running_server.hpp>

#include "configuration_fixture.hpp"

namespace own_certificate_test {

// Part 12, 7.10.5 to 7.10.10: Methods of the server's own certificate that are called wrongly, by
// two sessions or at a bad moment.

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::uint32_t application_group =
    id::ServerConfiguration_CertificateGroups_DefaultApplicationGroup;
constexpr std::uint32_t user_group =
    id::ServerConfiguration_CertificateGroups_DefaultUserTokenGroup;

struct OwnCertificate : Configuration {
    using Configuration::Configuration;

    static NodeId method(std::string_view name)
    {
        return NodeId{0, name == "GetCertificates"     ? 32333U
                         : name == "DeleteCertificate" ? 19345U
                                                       : 19342U};
    }
    std::string_view remove(TestClient& client, const NodeId& group = {}, const NodeId& type = rsa)
    {
        return name(on_server(client, method("DeleteCertificate"), {Variant{group}, Variant{type}})
                        .status_code);
    }
    /// CreateSelfSignedCertificate.
    std::string_view make(TestClient& client, const char* subject = "CN=Press 4",
                          std::uint16_t days = 0, std::uint16_t bits = 0, const NodeId& group = {})
    {
        return name(on_server(client, method("CreateSelfSignedCertificate"),
                              {Variant{group}, Variant{rsa}, Variant{String{subject}},
                               Variant{Array<String>{"plc.example"}},
                               Variant{Array<String>{"192.0.2.7"}}, Variant{days}, Variant{bits}})
                        .status_code);
    }
    std::string_view update_chain(TestClient& client, std::span<const std::byte> leaf,
                                  Array<ByteString> issuers, std::span<const std::byte> key,
                                  const NodeId& group = {}, const NodeId& type = rsa)
    {
        return name(on_server(client, id::ServerConfiguration_UpdateCertificate,
                              {Variant{group}, Variant{type}, Variant{ByteString{leaf}},
                               Variant{std::move(issuers)}, Variant{String{"PEM"}},
                               Variant{ByteString{key}}})
                        .status_code);
    }
    std::string_view ask(TestClient& client, const NodeId& group, const NodeId& type)
    {
        return name(on_server(client, id::ServerConfiguration_CreateSigningRequest,
                              {Variant{group}, Variant{type}, Variant{String{}}, Variant{false},
                               Variant{ByteString{}}})
                        .status_code);
    }
    static CallRequest slow(const NodeId& method, std::vector<Variant> inputs)
    {
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = NodeId{0, id::ServerConfiguration};
        request.methods_to_call[0].method_id = method;
        request.methods_to_call[0].input_arguments = Array<Variant>{inputs};
        return request;
    }
    static CallRequest slow_make()
    {
        return slow(method("CreateSelfSignedCertificate"),
                    {Variant{NodeId{}}, Variant{rsa}, Variant{String{"CN=Press 4"}},
                     Variant{Array<String>{"plc.example"}}, Variant{Array<String>{}},
                     Variant{std::uint16_t{0}}, Variant{std::uint16_t{0}}});
    }
    static CallRequest slow_request()
    {
        return slow(NodeId{0, id::ServerConfiguration_CreateSigningRequest},
                    {Variant{NodeId{}}, Variant{rsa}, Variant{String{}}, Variant{true},
                     Variant{ByteString{std::vector<std::byte>(32)}}});
    }
    std::string_view cancel(TestClient& client)
    {
        return name(on_server(client, id::ServerConfiguration_CancelChanges, {}).status_code);
    }
    DataValue fact(TestClient& client, const char* fact_name)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id =
            NodeId{1, String{"ServerConfiguration/OwnCertificate/" + std::string{fact_name}}};
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
};

} // namespace

TEST_CASE_METHOD(OwnCertificate, "own certificate: groups and types that have none are refused")
{
    auto admin = log_in();
    const auto der = client_identity().certificates.front().der();
    const NodeId applications_id{0, application_group};
    const NodeId elliptic{0, id::EccNistP256ApplicationCertificateType};
    for (const auto& [group, type] :
         {std::pair{NodeId{0, user_group}, rsa}, std::pair{NodeId{1, "none"}, rsa},
          std::pair{applications_id, elliptic}, std::pair{NodeId{}, NodeId{}}}) {
        CHECK(ask(admin, group, type) == "Bad_InvalidArgument");
        CHECK(remove(admin, group, type) == "Bad_InvalidArgument");
        CHECK(update_chain(admin, der, {}, {}, group, type) == "Bad_InvalidArgument");
    }
    CHECK(make(admin, "CN=Press 4", 0, 0, NodeId{0, user_group}) == "Bad_InvalidArgument");
    CHECK(apply(admin) == "Bad_NothingToDo");
    CHECK(ask(admin, applications_id, rsa) == "Good"); // for the key that there is
}

TEST_CASE_METHOD(OwnCertificate, "own certificate: bytes that are no certificate are refused")
{
    auto admin = log_in();
    log.keeps_records = true;
    const auto next = successor();
    const auto pem = next.key.to_pem();
    REQUIRE(pem);
    const auto der = next.certificates.front().der();
    const auto half = der.subspan(0, der.size() / 2);
    CHECK(update_chain(admin, {}, {}, pem->span()) == "Bad_CertificateInvalid");
    CHECK(update_chain(admin, half, {}, pem->span()) == "Bad_CertificateInvalid");
    CHECK(update_chain(admin, der, {ByteString{half}}, pem->span()) == "Bad_CertificateInvalid");
    // Two where one is expected, and none where there is a key.
    std::vector<std::byte> two{der.begin(), der.end()};
    two.insert(two.end(), der.begin(), der.end());
    CHECK(update_chain(admin, two, {}, pem->span()) == "Bad_CertificateInvalid");
    CHECK(update_chain(admin, der, {}, half) == "Bad_SecurityChecksFailed");
    const auto other = key_number(1).to_pem();
    REQUIRE(other);
    CHECK(update_chain(admin, der, {}, other->span()) == "Bad_SecurityChecksFailed");
    CHECK(apply(admin) == "Bad_NothingToDo");
    CHECK(std::count(log.records.begin(), log.records.end(),
                     "CertificateUpdated Bad_CertificateInvalid /admin 192.0.2.1 ObjectId "
                     "MethodId") == 4);
    CHECK(certificate() == server_identity().certificates.front().thumbprint_text());
}

TEST_CASE_METHOD(OwnCertificate, "own certificate: comes with its issuers, and the program is told")
{
    std::string told;
    certificates.renewed = [&](const crypto::OwnCertificate& own) {
        told = own.certificates.front().thumbprint_text();
    };
    auto admin = log_in();
    const Issued ca = issue(authority("Works CA"), key_number(2));
    CertificateOptions options;
    options.names = "URI:urn:busbar:test:server,DNS:plc.example";
    const Issued leaf = issue(options, key_number(5), &ca);
    const auto pem = leaf.key.to_pem();
    REQUIRE(pem);
    REQUIRE(applications.add(crypto::StoreList::Issuers, ca.certificate.der()));
    CHECK(update_chain(admin, leaf.certificate.der(), {ByteString{ca.certificate.der()}},
                       pem->span(), NodeId{0, application_group}) == "Good");
    CHECK(told.empty());
    CHECK(apply(admin) == "Good");
    CHECK(told == leaf.certificate.thumbprint_text());
    CHECK(certificate() == told);
    CHECK(server.config().identity->certificates.size() == 2);
}

TEST_CASE_METHOD(OwnCertificate, "own certificate: is one session's while it changes it")
{
    auto one = log_in();
    auto other = log_in();
    const auto next = successor();
    const auto pem = next.key.to_pem();
    REQUIRE(pem);
    CHECK(remove(one) == "Good");
    CHECK(remove(other) == "Bad_TransactionPending");
    CHECK(make(other) == "Bad_TransactionPending");
    CHECK(update(other, next.certificates.front(), "PEM", pem->span()) == "Bad_TransactionPending");
    CHECK(cancel(one) == "Good");
    CHECK(make(one) == "Bad_InvalidState"); // it is there again
    CHECK(remove(other) == "Good");
    CHECK(make(other) == "Good");
    CHECK(make(other) == "Bad_InvalidState"); // there is a new one
}

TEST_CASE_METHOD(OwnCertificate, "own certificate: numbers and names of a new one are checked")
{
    auto admin = log_in();
    REQUIRE(remove(admin) == "Good");
    for (const unsigned bits : {1U, 1024U, 2047U, 4097U, 65535U}) {
        CHECK(make(admin, "CN=Press 4", 0, static_cast<std::uint16_t>(bits)) == "Bad_OutOfRange");
    }
    CHECK(make(admin, "Press 4") == "Bad_InvalidArgument");
    CHECK(make(admin, "CN=Press 4", 10, 2048) == "Good");
    CHECK(apply(admin) == "Good");
    const crypto::Certificate& own = server.config().identity->certificates.front();
    constexpr std::int64_t day = 86'400 * DateTime::ticks_per_second;
    CHECK(own.valid_from().ticks == wall_clock.time.ticks - day);
    CHECK(own.valid_to().ticks == wall_clock.time.ticks + 10 * day);
    CHECK(own.host_names() == std::vector<std::string>{"plc.example", "192.0.2.7"});
}

TEST_CASE_METHOD(OwnCertificate, "own certificate: a request that cannot be kept changes nothing")
{
    auto admin = log_in();
    log.keeps_records = true;
    storage.set_protected(true);
    CHECK(request(admin, true).status_code == status::Bad_ResourceUnavailable);
    storage.set_protected(false);
    CHECK_FALSE(storage.entry("own/private/pending.pem"));
    CHECK(std::count(log.records.begin(), log.records.end(),
                     "CertificateUpdated Bad_ResourceUnavailable /admin 192.0.2.1 ObjectId "
                     "MethodId") == 1);
    CHECK(request(admin, true).status_code == status::Good);
    CHECK(storage.entry("own/private/pending.pem"));
}

TEST_CASE_METHOD(OwnCertificate, "own certificate: certificates are listed by group")
{
    auto admin = log_in();
    const auto get = [&](const NodeId& group) {
        return on_server(admin, method("GetCertificates"), {Variant{group}});
    };
    const auto own = get(NodeId{0, application_group});
    REQUIRE(own.status_code == status::Good);
    CHECK(own.output_arguments == get(NodeId{}).output_arguments);
    const auto none = get(NodeId{0, user_group});
    REQUIRE(none.status_code == status::Good);
    CHECK(none.output_arguments[0].array_size() == 0);
    CHECK(none.output_arguments[1].array_size() == 0);
    constexpr std::uint32_t types_of_applications = 14161;
    constexpr std::uint32_t types_of_users = 14155;
    CHECK(read(admin, types_of_users).value.array_size() == 0);
    CHECK(read(admin, types_of_applications).value == own.output_arguments[0]);
}

TEST_CASE_METHOD(OwnCertificate, "own certificate: its facts are those of the one in force")
{
    auto admin = log_in();
    const auto& first = server_identity().certificates.front();
    CHECK(fact(admin, "Thumbprint").value == Variant{String{first.thumbprint_text()}});
    CHECK(fact(admin, "ValidFrom").value == Variant{first.valid_from()});
    CHECK(fact(admin, "ValidTo").value == Variant{first.valid_to()});
    REQUIRE(remove(admin) == "Good");
    REQUIRE(make(admin, "CN=Press 4/O=Works") == "Good");
    CHECK(fact(admin, "Thumbprint").value == Variant{String{first.thumbprint_text()}});
    REQUIRE(apply(admin) == "Good");
    CHECK(fact(admin, "Thumbprint").value == Variant{String{certificate()}});
    CHECK(fact(admin, "CommonName").value == Variant{"Press 4"});
    CHECK(fact(admin, "Organization").value == Variant{"Works"});
    CHECK(fact(admin, "HostNames").value == Variant{Array<String>{"plc.example", "192.0.2.7"}});
}

TEST_CASE("own certificate: while a key is made nothing is applied, and a late one is dropped")
{
    ManualWorker worker;
    OwnCertificate fixture{&worker};
    auto admin = fixture.log_in();
    REQUIRE(fixture.remove(admin) == "Good");
    const auto made = admin.send(OwnCertificate::slow_make());
    CHECK(fixture.make(admin) == "Bad_InvalidState");
    CHECK(fixture.apply(admin) == "Bad_InvalidState");
    CHECK(fixture.cancel(admin) == "Good");
    worker.work();
    fixture.complete();
    auto late = admin.take<CallResponse>(made);
    REQUIRE(late);
    CHECK(name(late->results[0].status_code) == "Bad_InvalidState");
    // Nor is it put into another session's transaction.
    REQUIRE(fixture.remove(admin) == "Good");
    const auto again = admin.send(OwnCertificate::slow_make());
    CHECK(fixture.cancel(admin) == "Good");
    auto other = fixture.log_in();
    REQUIRE(fixture.remove(other) == "Good");
    worker.work();
    fixture.complete();
    late = admin.take<CallResponse>(again);
    REQUIRE(late);
    CHECK(name(late->results[0].status_code) == "Bad_InvalidState");
    CHECK(fixture.apply(other) == "Bad_InvalidState"); // it is deleted still
}

TEST_CASE("own certificate: a key whose client gave up, or lost the right, is not taken",
          "[attack]")
{
    constexpr const char* patience = "patience is all";
    const bool gives_up = GENERATE(true, false);
    ManualWorker worker;
    OwnCertificate fixture{&worker};
    REQUIRE(fixture.user_list.add({"pat", {}, 0, {}, {}}, patience, fixture.random));
    fixture.configured.replace({{.name = "chief", .roles = {"SecurityAdmin"}}});
    const IdentityMappingRuleType rule{IdentityCriteriaType::UserName, "pat"};
    REQUIRE(fixture.roles.add_identity("SecurityAdmin", rule));
    auto pat = fixture.log_in("pat", patience);
    REQUIRE(fixture.remove(pat) == "Good");
    pat.timeout_hint = gives_up ? 1'000 : 0;
    const auto made = pat.send(OwnCertificate::slow_make());
    if (gives_up) {
        fixture.advance(std::chrono::seconds{2});
        pat.connection.handle_deadline(fixture.now);
    } else {
        REQUIRE(fixture.roles.remove_identity("SecurityAdmin", rule));
        server::RunningServer{fixture.server}.roles_changed();
    }
    worker.work();
    fixture.complete();
    const auto answer = pat.take<CallResponse>(made);
    CHECK(name(answer ? answer->results[0].status_code : answer.error()) ==
          (gives_up ? "Bad_Timeout" : "Bad_NodeIdUnknown"));
    if (!gives_up) { // the same user, later
        REQUIRE(fixture.roles.add_identity("SecurityAdmin", rule));
        server::RunningServer{fixture.server}.roles_changed();
    }
    pat.timeout_hint = 0;
    CHECK(fixture.apply(pat) != "Good"); // nothing takes the place of the one that was deleted
    CHECK(fixture.certificate() == server_identity().certificates.front().thumbprint_text());
}

TEST_CASE("own certificate: a request that its client gave up leaves the pending key as it is",
          "[attack]")
{
    enum class End : std::uint8_t { Timeout, SessionClosed, RightLost };
    const End end = GENERATE(End::Timeout, End::SessionClosed, End::RightLost);
    const bool is_made = GENERATE(false, true); // the key, when that happens
    constexpr const char* patience = "patience is all";
    ManualWorker worker;
    OwnCertificate fixture{&worker};
    REQUIRE(fixture.user_list.add({"pat", {}, 0, {}, {}}, patience, fixture.random));
    fixture.configured.replace({{.name = "chief", .roles = {"SecurityAdmin"}}});
    const IdentityMappingRuleType rule{IdentityCriteriaType::UserName, "pat"};
    REQUIRE(fixture.roles.add_identity("SecurityAdmin", rule));
    auto pat = fixture.log_in("pat", patience);
    const auto first = pat.send(OwnCertificate::slow_request());
    worker.work();
    fixture.complete();
    REQUIRE(pat.take<CallResponse>(first));
    const auto pending = read_file(fixture.storage, "own/private/pending.pem", 10'000);
    REQUIRE(pending);
    pat.timeout_hint = 1'000;
    const auto second = pat.send(OwnCertificate::slow_request());
    if (is_made) {
        worker.work();
    }
    switch (end) {
    case End::Timeout:
        fixture.advance(std::chrono::seconds{2});
        pat.connection.handle_deadline(fixture.now);
        CHECK(pat.take<CallResponse>(second).error() == status::Bad_Timeout);
        break;
    case End::SessionClosed:
        pat.timeout_hint = 0;
        CHECK(pat.close_session() == status::Good);
        break;
    case End::RightLost:
        REQUIRE(fixture.roles.remove_identity("SecurityAdmin", rule));
        server::RunningServer{fixture.server}.roles_changed();
    }
    worker.work();
    fixture.complete();
    CHECK(read_file(fixture.storage, "own/private/pending.pem", 10'000) == pending);
}

TEST_CASE("own certificate: a worker that is busy is no state that lasts")
{
    ManualWorker worker;
    OwnCertificate fixture{&worker};
    auto admin = fixture.log_in();
    worker.has_room = false;
    CHECK(fixture.request(admin, true).status_code == status::Bad_TooManyOperations);
    worker.jobs.clear();
    worker.has_room = true;
    const auto sent = admin.send(OwnCertificate::slow_request());
    worker.work();
    fixture.complete();
    const auto response = admin.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Good");
}

TEST_CASE("own certificate: a worker that loses a key, or throws, leaves no state that lasts")
{
    struct ThrowingWorker final : server::Worker {
        [[nodiscard]] bool run(std::function<void()> /*job*/) override
        {
            throw std::runtime_error{"no thread"};
        }
    };
    ManualWorker losing;
    ThrowingWorker throwing;
    const bool is_lost = GENERATE(true, false);
    OwnCertificate fixture{is_lost ? static_cast<server::Worker*>(&losing) : &throwing};
    auto admin = fixture.log_in();
    const auto sent = admin.send(OwnCertificate::slow_request());
    losing.jobs.clear(); // as an exception in it would end it
    fixture.complete();
    const auto response = admin.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Bad_InternalError");
    const auto again = admin.send(OwnCertificate::slow_request());
    losing.work();
    fixture.complete();
    const auto second = admin.take<CallResponse>(again);
    REQUIRE(second);
    CHECK(name(second->results[0].status_code) == (is_lost ? "Good" : "Bad_InternalError"));
}

TEST_CASE("own certificate: a key that takes long is waited for as long as the client waits")
{
    ManualWorker worker;
    OwnCertificate fixture{&worker};
    auto admin = fixture.log_in();
    REQUIRE(fixture.remove(admin) == "Good");
    const auto made = admin.send(OwnCertificate::slow_make());
    fixture.advance(std::chrono::seconds{50});
    admin.connection.handle_deadline(fixture.now);
    admin.run();
    CHECK_FALSE(admin.take<CallResponse>(made));
    worker.work();
    fixture.complete();
    const auto late = admin.take<CallResponse>(made);
    REQUIRE(late);
    CHECK(name(late->results[0].status_code) == "Good");
}

} // namespace own_certificate_test
