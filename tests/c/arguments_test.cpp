#include "server_in_c.hpp"

#include <array>
#include <vector>

namespace c_arguments_test {

// Every function with null, malformed and oversized arguments: a status, and never a crash.

using namespace busbar;
using test::ClientInC;
using test::ServerInC;

namespace {

constexpr busbar_status bad = BUSBAR_BAD_INVALID_ARGUMENT;
constexpr busbar_status good = BUSBAR_GOOD;

busbar_status method(void*, busbar_call*, const busbar_value*, std::size_t, busbar_value*,
                     std::size_t)
{
    return good;
}

busbar_status read_batch(void*, busbar_batch*, busbar_read_item*, std::size_t)
{
    return good;
}

void on_data(void*, std::uint32_t, const busbar_data_value*) {}

busbar_server_config server_config()
{
    busbar_server_config config;
    busbar_server_config_init(&config);
    config.application.uri = "urn:test:arguments";
    config.address = "127.0.0.1";
    config.takes_free_port = true;
    return config;
}

/// The failure of creating a server, and its text.
std::pair<busbar_status, std::string> failure_of(const busbar_server_config& config)
{
    busbar_server* server = nullptr;
    const busbar_status status = busbar_server_create(&config, &server);
    const std::string text = busbar_server_last_error(server);
    if (status != good && server != nullptr) {
        // The handle is good for nothing else.
        CHECK(busbar_server_start(server) == status);
        CHECK(busbar_server_stop(server) == status);
        CHECK(busbar_server_remove_node(server, "i=1") == status);
        busbar_server_counts counts{};
        counts.size = sizeof counts;
        CHECK(busbar_server_count(server, &counts) == status);
        busbar_event event{};
        event.size = sizeof event;
        CHECK(busbar_server_raise_event(server, &event) == status);
        CHECK(busbar_server_last_error(server) == text);
    }
    busbar_server_destroy(server);
    return {status, text};
}

} // namespace

TEST_CASE("functions of the process in C take any argument", "[c]")
{
    CHECK(std::string{busbar_version()}.size() >= 5);
    CHECK(std::string{busbar_status_name(BUSBAR_BAD_TIMEOUT)} == "Bad_Timeout");
    CHECK(std::string{busbar_status_name(0x80FE0000U)}.empty());
    CHECK(busbar_now() > busbar_time_of_unix(1'500'000'000, 0));
    CHECK(busbar_time_of_unix(0, 100) == 116'444'736'000'000'001);
    CHECK(busbar_time_of_unix(INT64_MAX, INT32_MAX) > 0);
    CHECK(busbar_time_of_unix(INT64_MIN, INT32_MIN) < 0);
    CHECK(busbar_type_size(BUSBAR_DOUBLE) == 8);
    CHECK(busbar_type_size(0) == 0);
    CHECK(busbar_type_size(255) == 0);
    CHECK(busbar_memory_needed(BUSBAR_LIMITS_SMALL) < busbar_memory_needed(BUSBAR_LIMITS_LARGE));
    CHECK(busbar_memory_needed(9) == 0);
    CHECK(busbar_value_string(nullptr).as.text.data == nullptr);
    std::array<char, 160> hash{};
    CHECK(busbar_hash_password(nullptr, 1'000, hash.data(), hash.size()) == bad);
    CHECK(busbar_hash_password("x", 1'000, nullptr, 160) == bad);
    CHECK(busbar_hash_password("x", 1'000, hash.data(), 20) == BUSBAR_BAD_OUT_OF_RANGE);
    CHECK(busbar_hash_password("x", 1, hash.data(), hash.size()) == bad);
    CHECK(busbar_hash_password("x", 1'000, hash.data(), hash.size()) == good);
    CHECK(std::string{hash.data()}.substr(0, 9) == "$pbkdf2-s");
}

TEST_CASE("a server in C that cannot be says why", "[c]")
{
    busbar_server* server = nullptr;
    CHECK(busbar_server_create(nullptr, &server) == bad);
    busbar_server_config config = server_config();
    CHECK(busbar_server_create(&config, nullptr) == bad);
    config.size = 4;
    CHECK(busbar_server_create(&config, &server) == bad);
    CHECK(server == nullptr);
    busbar_server_config_init(nullptr);

    // By default an endpoint is secured, for which there is no certificate here.
    CHECK(failure_of(server_config()).first != good);
    config = server_config();
    config.application.uri = nullptr;
    CHECK(failure_of(config).second.find("application.uri") == 0);
    config = server_config();
    config.limits = 7;
    CHECK(failure_of(config).second.find("limits") == 0);
    config.memory_limit = 1;
    CHECK(failure_of(config).first != good);
    config = server_config();
    busbar_endpoint endpoint{"None", BUSBAR_MODE_NONE, true, false};
    config.endpoints = &endpoint;
    config.endpoint_count = 1;
    endpoint.mode = 9;
    CHECK(failure_of(config).second.find("endpoints[0]: mode") == 0);
    endpoint = {"Basic0", BUSBAR_MODE_NONE, true, false};
    CHECK(failure_of(config).second.find("endpoints[0]: policy") == 0);
    endpoint = {nullptr, BUSBAR_MODE_NONE, true, false};
    CHECK(failure_of(config).first != good);
    endpoint = {"None", BUSBAR_MODE_NONE, true, false};
    const busbar_user user{"operator", "not a hash", false};
    config.users = &user;
    config.user_count = 1;
    CHECK(failure_of(config).second.find("users[0]") == 0);
    config.users = nullptr;
    CHECK(failure_of(config).first == bad);
    config.user_count = 0;
    config.application.certificate = "no certificate";
    config.application.certificate_size = 14;
    CHECK(failure_of(config).first != good);
    config.application.certificate = nullptr;
    config.address = "256.1.1.1";
    CHECK(failure_of(config).first == 0x80050000U); // Bad_CommunicationError
}

TEST_CASE("functions of a server in C refuse null", "[c]")
{
    ServerInC machine;
    busbar_server* const servers[] = {nullptr, machine.server};
    for (busbar_server* const server : servers) {
        std::uint16_t index = 0;
        CHECK(busbar_server_add_namespace(server, nullptr, &index) == bad);
        CHECK(busbar_server_add_object(server, nullptr, nullptr) == bad);
        CHECK(busbar_server_add_object_type(server, nullptr, nullptr, 0) == bad);
        CHECK(busbar_server_add_reference(server, nullptr, nullptr, nullptr) != good);
        CHECK(busbar_server_remove_node(server, nullptr) != good);
        CHECK(busbar_server_add_nodeset(server, nullptr, nullptr, 0) == bad);
        CHECK(busbar_server_add_variable(server, nullptr, nullptr) == bad);
        CHECK(busbar_server_bind_variable(server, nullptr, nullptr) == bad);
        CHECK(busbar_server_set_value(server, 1, nullptr, 0, 0) == bad);
        CHECK(busbar_server_get_value(server, 1, nullptr) == bad);
        CHECK(busbar_server_add_source(server, nullptr, nullptr) == bad);
        CHECK(busbar_server_add_structure(server, nullptr, nullptr, 1, nullptr) == bad);
        CHECK(busbar_server_add_image(server, nullptr, nullptr) == bad);
        CHECK(busbar_server_add_method(server, nullptr, nullptr, 0, nullptr, 0, nullptr, nullptr) ==
              bad);
        CHECK(busbar_server_raise_event(server, nullptr) == bad);
        CHECK(busbar_server_count(server, nullptr) == bad);
    }
    CHECK(busbar_server_start(nullptr) == bad);
    CHECK(busbar_server_poll(nullptr, 0) == bad);
    CHECK(busbar_server_run(nullptr, false) == bad);
    CHECK(busbar_server_stop(nullptr) == bad);
    CHECK(busbar_server_port(nullptr) == 0);
    CHECK(std::string{busbar_server_last_error(nullptr)}.empty());
    busbar_server_destroy(nullptr);
    busbar_variable_init(nullptr);
    busbar_image_begin_scan(nullptr);
    busbar_image_publish(nullptr, 0);
    busbar_image_halt(nullptr);
    CHECK(busbar_batch_complete(nullptr, good) == bad);
    CHECK(busbar_call_finish(nullptr, good, nullptr, 0) == bad);
    busbar_value value{};
    CHECK(busbar_structure_size(nullptr) == 0);
    CHECK(busbar_structure_pack(nullptr, &value, 1, &value) == bad);
    CHECK(busbar_structure_unpack(nullptr, &value, &value, 1) == bad);
}

TEST_CASE("malformed values in C are refused", "[c]")
{
    ServerInC machine;
    const std::array<std::uint32_t, 3> dimensions{2, 0xFFFFFFFFU, 0xFFFFFFFFU};
    const std::array<double, 4> numbers{};
    std::vector<busbar_value> malformed(9);
    malformed[0].type = 23; // a DataValue
    malformed[1].type = 255;
    malformed[2] = busbar_value_array(BUSBAR_DOUBLE, nullptr, 3);
    malformed[3] = busbar_value_array(BUSBAR_DOUBLE, numbers.data(), 4);
    malformed[3].dimension_count = 3;
    malformed[3].dimensions = dimensions.data();
    malformed[4] = malformed[3];
    malformed[4].dimensions = nullptr;
    malformed[5] = malformed[3];
    malformed[5].dimension_count = 1;
    malformed[6].type = BUSBAR_STRING;
    malformed[6].as.text = {nullptr, 5};
    malformed[7].type = BUSBAR_BYTE_STRING;
    malformed[7].as.text = {"x", SIZE_MAX};
    malformed[8].type = BUSBAR_NODE_ID;
    malformed[8].as.text = {"nonsense", 8};
    for (const busbar_value& value : malformed) {
        const busbar_variable variable = machine.variable("Odd", value);
        CHECK(busbar_server_add_variable(machine.server, &variable, nullptr) == bad);
    }
    // Without a value a variable has no type.
    const busbar_variable untyped = machine.variable("Odd", busbar_value{});
    CHECK(busbar_server_add_variable(machine.server, &untyped, nullptr) == 0x80620000U);
    CHECK(std::string{busbar_server_last_error(machine.server)} == "Bad_NodeAttributesInvalid");
}

TEST_CASE("nodes in C that cannot be are refused", "[c]")
{
    ServerInC machine;
    busbar_server* const server = machine.server;
    busbar_variable variable = machine.variable("Speed", busbar_value_double(1));
    std::uint64_t handle = 0;
    REQUIRE(busbar_server_add_variable(server, &variable, &handle) == good);
    CHECK(busbar_server_add_variable(server, &variable, nullptr) != good); // it exists
    const auto refused = [&](const busbar_variable& each) {
        return busbar_server_add_variable(server, &each, nullptr);
    };
    variable = machine.variable(nullptr, busbar_value_double(1));
    CHECK(refused(variable) == 0x80600000U); // Bad_BrowseNameInvalid
    variable = machine.variable("Other", busbar_value_double(1));
    variable.node.parent = "ns=2;s=Nowhere";
    CHECK(refused(variable) == 0x805B0000U); // Bad_ParentNodeIdInvalid
    variable.node.parent = "no id";
    CHECK(refused(variable) == 0x805B0000U);
    variable.node.parent = nullptr;
    variable.node.id = "no id";
    CHECK(refused(variable) == 0x80330000U); // Bad_NodeIdInvalid
    variable.node.id = nullptr;
    variable.node.namespace_index = 77;
    CHECK(refused(variable) != good);
    variable.node.namespace_index = machine.index;
    variable.data_type = "i=999999";
    CHECK(refused(variable) != good);
    variable.data_type = nullptr;
    variable.source = 77;
    CHECK(refused(variable) == BUSBAR_BAD_NOT_FOUND);
    variable.source = 0;
    variable.size = 1;
    CHECK(refused(variable) == bad);

    const busbar_value text = busbar_value_string("x");
    const busbar_value number = busbar_value_double(2);
    CHECK(busbar_server_set_value(server, handle, &text, 0, 0) == BUSBAR_BAD_TYPE_MISMATCH);
    CHECK(busbar_server_set_value(server, handle, &number, 0, 0) == good);
    for (const std::uint64_t none : {std::uint64_t{0}, handle + 1, UINT64_MAX}) {
        busbar_data_value value{};
        CHECK(busbar_server_set_value(server, none, &number, 0, 0) == BUSBAR_BAD_NOT_FOUND);
        CHECK(busbar_server_get_value(server, none, &value) == BUSBAR_BAD_NOT_FOUND);
    }
    const std::string long_name(100'000, 'x');
    const busbar_node huge = machine.node(long_name.c_str());
    CHECK(busbar_server_add_object(server, &huge, nullptr) != good);
    const busbar_node node = machine.node("Node");
    CHECK(busbar_server_add_object(server, &node, "i=1") != good);
    CHECK(busbar_server_add_object(server, &node, "x") != good);
    CHECK(busbar_server_add_method(server, &node, nullptr, 3, nullptr, 0, method, nullptr) == bad);
    const busbar_argument nameless{nullptr, BUSBAR_DOUBLE, false, nullptr};
    CHECK(busbar_server_add_method(server, &node, &nameless, 1, nullptr, 0, method, nullptr) ==
          bad);
    const busbar_argument odd{"A", 99, false, nullptr};
    CHECK(busbar_server_add_method(server, &node, nullptr, 0, &odd, 1, method, nullptr) == bad);
    const busbar_property property{"P", 99, false};
    CHECK(busbar_server_add_object_type(server, &node, &property, 1) == bad);
    CHECK(busbar_server_add_reference(server, "i=85", "i=35", "ns=2;s=None") != good);
    CHECK(busbar_server_remove_node(server, "i=85") != good);
    busbar_source source{};
    source.size = sizeof source;
    std::uint32_t number_of_source = 0;
    CHECK(busbar_server_add_source(server, &source, &number_of_source) == bad);
    source.read = read_batch;
    CHECK(busbar_server_add_source(server, &source, nullptr) == bad);
    CHECK(busbar_server_add_nodeset(server, "x.xml", "<UANodeSet", 10) != good);
    CHECK(std::string{busbar_server_last_error(server)}.find("x.xml") == 0);
}

TEST_CASE("structures, images and events in C that cannot be are refused", "[c]")
{
    ServerInC machine;
    busbar_server* const server = machine.server;
    busbar_structure* structure = nullptr;
    const busbar_node node = machine.node("Type");
    const auto refused = [&](const busbar_field& field, std::size_t count = 1) {
        return busbar_server_add_structure(server, &node, &field, count, &structure);
    };
    CHECK(refused({"A", 99, 0, 0, nullptr}) != good);
    CHECK(refused({"A", BUSBAR_EXTENSION_OBJECT, 0, 0, nullptr}) != good);
    CHECK(refused({"A", BUSBAR_NODE_ID, 0, 0, nullptr}) != good);
    CHECK(refused({nullptr, BUSBAR_DOUBLE, 0, 0, nullptr}) != good);
    CHECK(refused({"A", BUSBAR_DOUBLE, 0, 0, nullptr}, 0) != good);
    CHECK(refused({"A", BUSBAR_DOUBLE, 0, 0, nullptr}, SIZE_MAX) == bad);
    CHECK(refused({"A", BUSBAR_DOUBLE, UINT32_MAX, 0, nullptr}) != good);
    CHECK(structure == nullptr);
    CHECK(refused({"A", BUSBAR_DOUBLE, 2, 0, nullptr}) == good);
    REQUIRE(structure != nullptr);
    busbar_value value{};
    CHECK(busbar_structure_pack(structure, nullptr, 16, &value) == bad);
    CHECK(busbar_structure_unpack(structure, nullptr, &value, 16) == bad);

    std::array<std::uint64_t, 4> memory{};
    busbar_image_variable variable{{"A", BUSBAR_DOUBLE, 0, 0, nullptr}, 0, true};
    busbar_image_config config{};
    config.size = sizeof config;
    config.memory = memory.data();
    config.memory_size = sizeof memory;
    config.variables = &variable;
    config.count = 1;
    config.namespace_index = machine.index;
    busbar_image* image = nullptr;
    for (const std::size_t offset : {std::size_t{1}, std::size_t{25}, std::size_t{32}, SIZE_MAX}) {
        variable.offset = offset;
        CHECK(busbar_server_add_image(server, &config, &image) != good);
    }
    variable.offset = 0;
    config.parent = "ns=2;s=Nowhere";
    CHECK(busbar_server_add_image(server, &config, &image) == 0x805B0000U);
    config.parent = nullptr;
    config.count = SIZE_MAX;
    CHECK(busbar_server_add_image(server, &config, &image) == bad);
    CHECK(image == nullptr);

    busbar_event event{};
    event.size = sizeof event;
    event.type = "nonsense";
    CHECK(busbar_server_raise_event(server, &event) == 0x80330000U);
    event.type = nullptr;
    event.field_count = 1;
    CHECK(busbar_server_raise_event(server, &event) == bad);
    event.field_count = 0;
    event.severity = 1'001;
    CHECK(busbar_server_raise_event(server, &event) == bad);
    event.severity = 1'000;
    CHECK(busbar_server_raise_event(server, &event) == good);
}

TEST_CASE("a client in C that cannot be says why", "[c]")
{
    busbar_client* client = nullptr;
    busbar_client_config config;
    busbar_client_config_init(nullptr);
    busbar_client_config_init(&config);
    CHECK(busbar_client_create(nullptr, &client) == bad);
    CHECK(busbar_client_create(&config, nullptr) == bad);
    const auto failure = [&] {
        const busbar_status status = busbar_client_create(&config, &client);
        CHECK(busbar_client_connect(client, 0) == (client != nullptr ? status : bad));
        CHECK(busbar_client_interrupt(client) == (client != nullptr ? status : bad));
        CHECK(busbar_client_state(client) == BUSBAR_CLIENT_CLOSED);
        const std::string text = busbar_client_last_error(client);
        busbar_client_destroy(client);
        return text;
    };
    CHECK(failure().find("application.uri") == 0);
    config.application.uri = "urn:test:client";
    config.least_mode = 0;
    CHECK(failure().find("least_mode") == 0);
    config.least_mode = BUSBAR_MODE_NONE;
    config.url = "http://x";
    CHECK(failure().find("endpoint_url") == 0);
    config.url = "opc.tcp://localhost";
    config.policy = "Basic0";
    CHECK(failure().find("security.policies") == 0);
    config.size = 1;
    CHECK(busbar_client_create(&config, &client) == bad);
}

TEST_CASE("services of a client in C refuse null, nonsense and what is too much", "[c]")
{
    ServerInC machine;
    machine.run();
    ClientInC peer{machine.url()};
    peer.connect();
    busbar_client* const clients[] = {nullptr, peer.client};
    const char* node = "i=2258";
    busbar_data_value result{};
    busbar_status status = 0;
    const busbar_value value{};
    std::uint32_t number = 0;
    std::size_t count = 0;
    const busbar_value* outputs = nullptr;
    for (busbar_client* const each : clients) {
        CHECK(busbar_client_read(each, nullptr, 1, &result) == bad);
        CHECK(busbar_client_read(each, &node, 1, nullptr) == bad);
        CHECK(busbar_client_read(each, &node, 0, &result) == bad);
        CHECK(busbar_client_read(each, &node, SIZE_MAX, &result) == bad);
        CHECK(busbar_client_write(each, &node, nullptr, 1, &status) == bad);
        CHECK(busbar_client_write(each, &node, &value, SIZE_MAX, &status) == bad);
        CHECK(busbar_client_call(each, "i=1", "i=2", nullptr, 1, nullptr, nullptr) == bad);
        CHECK(busbar_client_call(each, "i=1", "i=2", nullptr, 0, &outputs, nullptr) == bad);
        CHECK(busbar_client_call(each, nullptr, nullptr, nullptr, 0, &outputs, &count) != good);
        CHECK(busbar_client_browse(each, "i=85", nullptr, nullptr) == bad);
        CHECK(busbar_client_subscribe(each, 100, nullptr, nullptr, &number) == bad);
        CHECK(busbar_client_subscribe(each, -1, on_data, nullptr, &number) == bad);
        CHECK(busbar_client_subscribe(each, 1e300, on_data, nullptr, &number) == bad);
        CHECK(busbar_client_monitor(each, 1, nullptr, 0, 1, &number) == bad);
    }
    node = nullptr;
    CHECK(busbar_client_read(peer.client, &node, 1, &result) == good);
    CHECK(result.status == 0x80330000U);
    node = "nonsense";
    CHECK(busbar_client_write(peer.client, &node, &value, 1, &status) == good);
    CHECK(status != good);
    const busbar_reference* references = nullptr;
    CHECK(busbar_client_browse(peer.client, "ns=9;s=x", &references, &count) != good);
    CHECK(count == 0);
    busbar_client_destroy(nullptr);
    CHECK(std::string{busbar_client_last_error(nullptr)}.empty());
    CHECK(busbar_client_disconnect(nullptr) == bad);
    CHECK(busbar_client_poll(nullptr, 0) == bad);
    CHECK(busbar_client_run(nullptr) == bad);
    machine.stop();
}

TEST_CASE("an allocator in C comes before everything else", "[c]")
{
    busbar_allocator allocator{};
    CHECK(busbar_set_allocator(nullptr) == bad);
    CHECK(busbar_set_allocator(&allocator) == bad);
    allocator.size = sizeof allocator;
    allocator.allocate = [](void*, std::size_t, std::size_t) -> void* { return nullptr; };
    allocator.release = [](void*, void*) {};
    busbar_memory memory{};
    CHECK(busbar_memory_in_use(nullptr) == bad);
    CHECK(busbar_memory_in_use(&memory) == bad);
    memory.size = sizeof memory;
#if defined(BUSBAR_IS_SANITIZED)
    CHECK(busbar_set_allocator(&allocator) != good);
#elif defined(BUSBAR_IS_SHARED)
    CHECK(busbar_set_allocator(&allocator) == BUSBAR_BAD_NOT_SUPPORTED);
    CHECK(busbar_memory_in_use(&memory) == BUSBAR_BAD_NOT_SUPPORTED);
#else
    CHECK(busbar_set_allocator(&allocator) == BUSBAR_BAD_INVALID_STATE);
    REQUIRE(busbar_memory_in_use(&memory) == good);
    CHECK(memory.blocks > 0);
    const std::uint64_t before = memory.bytes;
    const std::string more(10'000, 'x');
    REQUIRE(busbar_memory_in_use(&memory) == good);
    CHECK(memory.bytes >= before + more.size());
#endif
}

} // namespace c_arguments_test
