#include <busbar/administration/server_configuration_nodes/nodes.hpp>
#include <busbar/administration/user_management_nodes/nodes.hpp>

#include "configuration_fixture.hpp"

namespace server_configuration_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE_METHOD(Configuration, "server configuration: another certificate with its key",
                 "[unit:Push Model for Global Certificate and TrustList Management]")
{
    auto admin = log_in();
    const auto next = successor();
    const auto pem = next.key.to_pem();
    REQUIRE(pem);
    CHECK(update(admin, next.certificates.front()) == "Bad_SecurityChecksFailed");
    CHECK(update(admin, next.certificates.front(), "PFX", pem->span()) == "Bad_NotSupported");
    CHECK(update(admin, client_identity().certificates.front(), "PEM", pem->span()) ==
          "Bad_SecurityChecksFailed");
    CHECK(update(admin, next.certificates.front(), "PEM", pem->span()) == "Good");
    const std::string before = certificate();
    CHECK(stored() == before);
    CHECK(apply(admin) == "Good");
    CHECK(stored() == next.certificates.front().thumbprint_text());
    CHECK(certificate() == stored());
    CHECK_FALSE(admin.is_closed());
    advance(1s);
    CHECK(admin.is_closed()); // the session stays
    CHECK(server.address_space().find(NodeId{0, id::ServerConfiguration}) != model::no_node);
    CHECK(storage.entry("own/replaced/" + before + ".pem"));
}

TEST_CASE_METHOD(Configuration, "server configuration: changes are applied once, in one Call too",
                 "[attack]")
{
    auto admin = log_in();
    const auto next = successor();
    const auto pem = next.key.to_pem();
    REQUIRE(pem);
    CallRequest all;
    all.methods_to_call.resize(4);
    for (CallMethodRequest& one : all.methods_to_call) {
        one.object_id = NodeId{0, id::ServerConfiguration};
        one.method_id = NodeId{0, id::ServerConfiguration_ApplyChanges};
    }
    all.methods_to_call[1].method_id = NodeId{0, id::ServerConfiguration_UpdateCertificate};
    all.methods_to_call[1].input_arguments = {Variant{NodeId{}},
                                              Variant{rsa},
                                              Variant{ByteString{next.certificates.front().der()}},
                                              Variant{Array<ByteString>{}},
                                              Variant{String{"PEM"}},
                                              Variant{ByteString{pem->span()}}};
    const auto sent = admin.send(all);
    complete();
    const auto response = admin.take<CallResponse>(sent);
    REQUIRE(response);
    REQUIRE(response->results.size() == 4);
    CHECK(name(response->results[0].status_code) == "Bad_NothingToDo");
    CHECK(name(response->results[1].status_code) == "Good");
    CHECK(name(response->results[2].status_code) == "Good");
    CHECK(name(response->results[3].status_code) == "Bad_NothingToDo");
    CHECK(stored() == next.certificates.front().thumbprint_text());
    advance(1s);
    CHECK(admin.is_closed()); // as its channel has the old certificate
    CHECK(certificate() == stored());
}

TEST_CASE_METHOD(Configuration, "server configuration: a request is signed by a CA")
{
    auto admin = log_in();
    CHECK(request(admin, true, "", 31).status_code == status::Bad_InvalidArgument);
    CHECK(request(admin, true, "Line 3").status_code == status::Bad_InvalidArgument);
    const auto made = request(admin, true, "CN=Press 4/O=Works");
    REQUIRE(made.status_code == status::Good);
    const auto* const der = made.output_arguments[0].get_if<ByteString>();
    REQUIRE((der != nullptr && der->size() > 500));

    const Issued ca = issue(authority("Works CA"), key_number(2));
    CertificateOptions options;
    options.names = "URI:urn:busbar:test:server,DNS:plc.example";
    const auto pending = storage_key("own/private/pending.pem");
    REQUIRE(pending);
    const Issued leaf = issue(options, *pending, &ca);
    // Its issuer has to be known.
    CHECK(update(admin, leaf.certificate) == "Bad_CertificateChainIncomplete");
    REQUIRE(applications.add(crypto::StoreList::Issuers, ca.certificate.der()));
    CHECK(update(admin, leaf.certificate) == "Good");
    CHECK(apply(admin) == "Good");
    CHECK(certificate() == leaf.certificate.thumbprint_text());
    CHECK_FALSE(storage.entry("own/private/pending.pem"));
}

TEST_CASE_METHOD(Configuration, "server configuration: a new certificate of its own")
{
    const NodeId create{0, 19342};
    const NodeId remove{0, 19345};
    auto admin = log_in();
    const std::string before = certificate();
    const auto make = [&] {
        return on_server(admin, create,
                         {Variant{NodeId{}}, Variant{rsa}, Variant{String{"CN=Press 4"}},
                          Variant{Array<String>{"plc.example"}}, Variant{Array<String>{}},
                          Variant{std::uint16_t{365}}, Variant{std::uint16_t{2048}}});
    };
    CHECK(make().status_code == status::Bad_InvalidState); // there is one
    CHECK(on_server(admin, remove, {Variant{NodeId{}}, Variant{rsa}}).status_code == status::Good);
    CHECK(apply(admin) == "Bad_InvalidState"); // and there has to be one
    CHECK(certificate() == before);
    CHECK(read(admin, id::ServerConfiguration_TransactionDiagnostics_Errors).value.array_size() ==
          1);
    CHECK(on_server(admin, remove, {Variant{NodeId{}}, Variant{rsa}}).status_code == status::Good);
    const auto made = make();
    REQUIRE(made.status_code == status::Good);
    CHECK(apply(admin) == "Good");
    CHECK(certificate() != before);
    CHECK(stored() == certificate());
    CHECK(server.config().identity->certificates.front().subject() == "CN=Press 4");
}

TEST_CASE_METHOD(Configuration, "server configuration: lists what it has and what it rejected")
{
    auto admin = log_in();
    const auto own = on_server(admin, NodeId{0, 32333}, {Variant{NodeId{}}});
    REQUIRE(own.status_code == status::Good);
    CHECK(own.output_arguments[0].array_size() == 1);
    const auto* const ders = own.output_arguments[1].array_if<ByteString>();
    REQUIRE(ders != nullptr);
    CHECK((*ders)[0] == ByteString{server_identity().certificates.front().der()});
    // Their arguments follow the Methods, as in the specification's list of NodeIds.
    for (const auto& [method, inputs, outputs] :
         {std::tuple{32333U, 32334U, 32335U}, {19342U, 19343U, 19344U}, {19345U, 19346U, 0U}}) {
        const auto& space = server.address_space();
        CHECK(space.browse_name(space.find(inputs)).name.view() == "InputArguments");
        CHECK((outputs == 0 ||
               space.browse_name(space.find(outputs)).name.view() == "OutputArguments"));
        CHECK(space.node_class(space.find(method)) == NodeClass::Method);
    }
    CHECK(on_server(admin, NodeId{0, 32333}, {Variant{rsa}}).status_code ==
          status::Bad_InvalidArgument);

    applications.reject(issue({}, key_number(1)).certificate, today);
    const auto rejected = on_server(admin, id::ServerConfiguration_GetRejectedList, {});
    REQUIRE(rejected.status_code == status::Good);
    CHECK(rejected.output_arguments[0].array_size() == 1);

    const NodeId remove{1, "ServerConfiguration/RemoveRejectedCertificate"};
    const auto status_of_removing = [&](const std::string& thumbprint) {
        return on_server(admin, remove, {Variant{String{thumbprint}}}).status_code;
    };
    const auto entries = applications.list(crypto::StoreList::Rejected);
    REQUIRE(entries.size() == 1);
    CHECK(status_of_removing("00") == status::Bad_NotFound);
    CHECK(status_of_removing("../trusted") == status::Bad_NotFound);
    CHECK(status_of_removing(entries.front().thumbprint) == status::Good);
    CHECK(status_of_removing(entries.front().thumbprint) == status::Bad_NotFound);
    CHECK(applications.list(crypto::StoreList::Rejected).empty());
}

TEST_CASE_METHOD(Configuration, "server configuration: a trust list and a certificate, or neither")
{
    auto admin = log_in();
    const auto next = successor();
    const auto pem = next.key.to_pem();
    REQUIRE(pem);
    CHECK(update(admin, next.certificates.front(), "PEM", pem->span()) == "Good");
    storage.set_protected(true);
    CHECK(apply(admin) == "Bad_ResourceUnavailable");
    storage.set_protected(false);
    CHECK(certificate() == server_identity().certificates.front().thumbprint_text());
    CHECK(stored() == certificate());
    CHECK(apply(admin) == "Bad_NothingToDo");
    CHECK(read(admin, id::ServerConfiguration_TransactionDiagnostics_Result).value ==
          Variant{StatusCode{status::Bad_ResourceUnavailable}});
}

TEST_CASE("server configuration: keys are made by the worker, one at a time")
{
    ManualWorker worker;
    Configuration fixture{&worker};
    auto admin = fixture.log_in();
    CallRequest request;
    request.methods_to_call.resize(1);
    request.methods_to_call[0].object_id = NodeId{0, id::ServerConfiguration};
    request.methods_to_call[0].method_id = NodeId{0, id::ServerConfiguration_CreateSigningRequest};
    request.methods_to_call[0].input_arguments = {Variant{NodeId{}}, Variant{rsa},
                                                  Variant{String{}}, Variant{true},
                                                  Variant{ByteString{std::vector<std::byte>(32)}}};
    const auto first = admin.send(request);
    CHECK(fixture.request(admin, true).status_code == status::Bad_InvalidState);
    CHECK(fixture.update(admin, server_identity().certificates.front()) == "Bad_InvalidState");
    worker.work();
    fixture.complete();
    const auto response = admin.take<CallResponse>(first);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Good);
}

TEST_CASE_METHOD(Configuration, "server configuration: whatever is added has something behind it")
{
    const auto& space = server.address_space();
    std::size_t count = 0;
    for (const auto& nodes : {administration::server_configuration_nodes::nodes().nodes,
                              administration::user_management_nodes::nodes().nodes}) {
        for (const model::StaticNode& each : nodes) {
            const model::NodeIndex node = space.find(NodeId{0, each.id.value});
            REQUIRE(node != model::no_node);
            const std::string browse_name = space.browse_name(node).name.str();
            INFO(browse_name << " i=" << each.id.value);
            if (browse_name == "InputArguments" || browse_name == "OutputArguments") {
                CHECK_FALSE(space.value(node).is_null());
            } else if (space.node_class(node) == NodeClass::Method) {
                CHECK(space.method(node).source != model::no_source);
                ++count;
            } else if (space.node_class(node) == NodeClass::Variable) {
                CHECK(space.variable(node).source != model::no_source);
                ++count;
            }
        }
    }
    CHECK(count > 50);
}

TEST_CASE_METHOD(Configuration, "server configuration: says what it is and what it takes")
{
    certificates.max_trust_list_size = 5'000;
    auto admin = log_in();
    const auto value = [&](std::uint32_t node) { return read(admin, node).value; };
    CHECK(value(id::ServerConfiguration_ApplicationUri) ==
          Variant{String{"urn:busbar:test:server"}});
    CHECK(value(id::ServerConfiguration_ProductUri) ==
          Variant{String{server.config().product_uri}});
    CHECK(value(id::ServerConfiguration_ApplicationType) == Variant{std::int32_t{0}});
    CHECK(value(id::ServerConfiguration_ServerCapabilities) == Variant{Array<String>{"NA"}});
    CHECK(value(id::ServerConfiguration_SupportedPrivateKeyFormats) ==
          Variant{Array<String>{"PEM"}});
    CHECK(value(id::ServerConfiguration_MaxTrustListSize) == Variant{std::uint32_t{5'000}});
    CHECK(value(id::ServerConfiguration_MulticastDnsEnabled) == Variant{false});
    CHECK(value(id::ServerConfiguration_HasSecureElement) == Variant{false});
}

TEST_CASE_METHOD(Configuration, "server configuration: says when a transaction was, and of what")
{
    auto admin = log_in();
    const auto of_last = [&](std::uint32_t node) { return read(admin, node); };
    for (const std::uint32_t node :
         {id::ServerConfiguration_TransactionDiagnostics_StartTime,
          id::ServerConfiguration_TransactionDiagnostics_EndTime,
          id::ServerConfiguration_TransactionDiagnostics_AffectedTrustLists,
          id::ServerConfiguration_TransactionDiagnostics_AffectedCertificateGroups,
          id::ServerConfiguration_TransactionDiagnostics_Errors}) {
        CHECK(of_last(node).status == status::Bad_OutOfService);
    }
    const auto next = successor();
    const auto pem = next.key.to_pem();
    REQUIRE(pem);
    REQUIRE(update(admin, next.certificates.front(), "PEM", pem->span()) == "Good");
    const DateTime begun = wall_clock.time;
    advance(1s);
    CHECK(of_last(id::ServerConfiguration_TransactionDiagnostics_EndTime).value ==
          Variant{DateTime{}});
    CHECK(on_server(admin, id::ServerConfiguration_CancelChanges, {}).status_code == status::Good);
    CHECK(of_last(id::ServerConfiguration_TransactionDiagnostics_StartTime).value ==
          Variant{begun});
    CHECK(of_last(id::ServerConfiguration_TransactionDiagnostics_EndTime).value ==
          Variant{wall_clock.time});
    CHECK(of_last(id::ServerConfiguration_TransactionDiagnostics_Result).value ==
          Variant{StatusCode{status::Bad_RequestCancelledByClient}});
    CHECK(of_last(id::ServerConfiguration_TransactionDiagnostics_AffectedTrustLists)
              .value.array_size() == 0);
    CHECK(of_last(id::ServerConfiguration_TransactionDiagnostics_AffectedCertificateGroups).value ==
          Variant{Array<NodeId>{
              NodeId{0, id::ServerConfiguration_CertificateGroups_DefaultApplicationGroup}}});
}

} // namespace server_configuration_test
