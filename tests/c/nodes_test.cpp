#include "server_in_c.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/temporary_folder.hpp"

namespace c_nodes_test {

using namespace busbar;
using test::ClientInC;
using test::ServerInC;
using test::text_of;

namespace {

constexpr busbar_status good = BUSBAR_GOOD;

const std::string nodeset = R"(<?xml version="1.0" encoding="utf-8"?>
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd"
    xmlns:uax="http://opcfoundation.org/UA/2008/02/Types.xsd">
  <NamespaceUris><Uri>urn:test:model</Uri></NamespaceUris>
  <UAObject NodeId="ns=1;i=1" BrowseName="1:Press">
    <DisplayName>Press</DisplayName>
    <References>
      <Reference ReferenceType="i=40">i=58</Reference>
      <Reference ReferenceType="i=35" IsForward="false">i=85</Reference>
    </References>
  </UAObject>
  <UAVariable NodeId="ns=1;i=2" BrowseName="1:Force" DataType="i=11" ParentNodeId="ns=1;i=1">
    <DisplayName>Force</DisplayName>
    <References>
      <Reference ReferenceType="i=40">i=63</Reference>
      <Reference ReferenceType="i=47" IsForward="false">ns=1;i=1</Reference>
    </References>
    <Value><uax:Double>2.5</uax:Double></Value>
  </UAVariable>
</UANodeSet>)";

std::vector<std::string> names_below(ClientInC& client, const char* node)
{
    const busbar_reference* references = nullptr;
    std::size_t count = 0;
    REQUIRE(busbar_client_browse(client.client, node, &references, &count) == good);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) {
        names.push_back(text_of(references[i].browse_name.name));
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string contents(const std::filesystem::path& path)
{
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

} // namespace

TEST_CASE("a NodeSet in memory is loaded in C, and its variable is bound", "[c]")
{
    ServerInC machine;
    REQUIRE(busbar_server_add_nodeset(machine.server, "press.xml", nodeset.data(),
                                      nodeset.size()) == good);
    std::uint16_t model = 0;
    REQUIRE(busbar_server_add_namespace(machine.server, "urn:test:model", &model) == good);
    const std::string id = "ns=" + std::to_string(model) + ";i=2";
    busbar_variable force;
    busbar_variable_init(&force);
    force.node.id = id.c_str();
    force.is_writable = true;
    std::uint64_t handle = 0;
    const busbar_value text = busbar_value_string("x");
    force.value = text;
    CHECK(busbar_server_bind_variable(machine.server, &force, &handle) == BUSBAR_BAD_TYPE_MISMATCH);
    force.value = busbar_value{};
    REQUIRE(busbar_server_bind_variable(machine.server, &force, &handle) == good);
    busbar_data_value value{};
    REQUIRE(busbar_server_get_value(machine.server, handle, &value) == good);
    CHECK(value.value.as.float64 == 2.5);
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    CHECK(client.write(id.c_str(), busbar_value_double(4)) == good);
    CHECK(client.read("nsu=urn:test:model;i=2").value.as.float64 == 4);
}

TEST_CASE("objects, types and references are added in C, and removed", "[c]")
{
    ServerInC machine;
    busbar_server* const server = machine.server;
    const busbar_node line = machine.node("Line");
    REQUIRE(busbar_server_add_object(server, &line, nullptr) == good);
    busbar_variable speed = machine.variable("Speed", busbar_value_double(1));
    speed.node.parent = "ns=2;s=Line";
    speed.node.display_name = "How fast";
    REQUIRE(busbar_server_add_variable(server, &speed, nullptr) == good);
    speed.node.name = "Unit";
    speed.is_property = true;
    REQUIRE(busbar_server_add_variable(server, &speed, nullptr) == good);
    busbar_node type = machine.node("PressureType");
    type.parent = "i=2041"; // BaseEventType
    const busbar_property property{"Pressure", BUSBAR_DOUBLE, false};
    REQUIRE(busbar_server_add_object_type(server, &type, &property, 1) == good);
    const busbar_node far = machine.node("Far");
    REQUIRE(busbar_server_add_object(server, &far, "i=58") == good);
    REQUIRE(busbar_server_add_reference(server, "ns=2;s=Line", "i=35", "ns=2;s=Far") == good);
    const busbar_event_field field{machine.index, "Pressure", busbar_value_double(8)};
    busbar_event event{};
    event.size = sizeof event;
    event.type = "ns=2;s=PressureType";
    event.source_node = "ns=2;s=Line";
    event.message = "Pressure is high";
    event.severity = 700;
    event.fields = &field;
    event.field_count = 1;
    CHECK(busbar_server_raise_event(server, &event) == good);
    machine.run();
    {
        ClientInC client{machine.url()};
        client.connect();
        CHECK(names_below(client, "ns=2;s=Line") ==
              std::vector<std::string>{"Far", "Speed", "Unit"});
        CHECK(client.read("/Objects/2:Line/2:Speed").status == good);
    }
    machine.stop();
    CHECK(busbar_server_remove_node(server, "ns=2;s=Line") == good);
    CHECK(busbar_server_remove_node(server, "ns=2;s=Line/Speed") != good);
}

namespace {

/// A device whose certificate and key a factory has made.
struct Device {
    explicit Device(const char* uri_of) : uri{uri_of}
    {
        const test::TemporaryFolder folder;
        const std::string path = (folder.path / "pki").string();
        busbar_client_config config;
        busbar_client_config_init(&config);
        config.application.uri = uri;
        config.application.folder = path.c_str();
        config.url = "opc.tcp://localhost:1";
        busbar_client* maker = nullptr;
        REQUIRE(busbar_client_create(&config, &maker) == good);
        busbar_client_destroy(maker);
        certificate = contents(folder.path / "pki/own/certs/own.der");
        key = contents(folder.path / "pki/own/private/own.pem");
        REQUIRE_FALSE(key.empty());
    }
    /// The application in memory, which trusts one peer.
    [[nodiscard]] busbar_application application(const busbar_text& peer) const
    {
        busbar_application application{};
        application.uri = uri;
        application.certificate = certificate.data();
        application.certificate_size = certificate.size();
        application.key = key.data();
        application.key_size = key.size();
        application.trusted = &peer;
        application.trusted_count = 1;
        return application;
    }
    [[nodiscard]] busbar_text text() const { return {certificate.data(), certificate.size()}; }

    const char* uri;
    std::string certificate;
    std::string key;
};

} // namespace

TEST_CASE("certificates in memory secure a server and a client in C, without a folder", "[c]")
{
    const Device of_server{"urn:test:device"};
    const Device of_client{"urn:test:panel"};
    const busbar_text server_text = of_server.text();
    const busbar_text client_text = of_client.text();
    const busbar_endpoint endpoint{"Aes256_Sha256_RsaPss", BUSBAR_MODE_SIGN_AND_ENCRYPT, true,
                                   false};
    busbar_server_config config;
    busbar_server_config_init(&config);
    config.application = of_server.application(client_text);
    config.takes_free_port = true;
    config.endpoints = &endpoint;
    config.endpoint_count = 1;
    config.memory_limit = busbar_memory_needed(BUSBAR_LIMITS_LARGE) / 2;
    busbar_server* server = nullptr;
    const busbar_status created = busbar_server_create(&config, &server);
    INFO(busbar_server_last_error(server));
    REQUIRE(created == good);
    REQUIRE(busbar_server_start(server) == good);
    std::thread thread{[&] { busbar_server_run(server, false); }};
    const std::string url = "opc.tcp://localhost:" + std::to_string(busbar_server_port(server));
    busbar_client_config panel;
    busbar_client_config_init(&panel);
    panel.application = of_client.application(server_text);
    panel.url = url.c_str();
    panel.policy = "Aes256_Sha256_RsaPss";
    busbar_client* client = nullptr;
    const busbar_status made = busbar_client_create(&panel, &client);
    const busbar_status connected = busbar_client_connect(client, 10'000);
    const std::string why = busbar_client_last_error(client);
    const char* const state = "i=2259";
    busbar_data_value value{};
    const busbar_status read = busbar_client_read(client, &state, 1, &value);
    busbar_client_destroy(client);
    busbar_server_stop(server);
    thread.join();
    busbar_server_destroy(server);
    INFO(why);
    CHECK(made == good);
    CHECK(connected == good);
    CHECK(read == good);
    CHECK(value.status == good);
    CHECK(value.value.type == BUSBAR_INT32);
}

} // namespace c_nodes_test
