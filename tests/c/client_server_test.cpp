#include "server_in_c.hpp"

#include <array>
#include <cstring>
#include <filesystem>
#include <vector>

#include "support/temporary_folder.hpp"

namespace c_client_server_test {

using namespace busbar;
using test::ClientInC;
using test::ServerInC;
using test::text_of;

namespace {

constexpr busbar_status good = BUSBAR_GOOD;
constexpr busbar_status no_subscription = 0x80280000U; // Bad_SubscriptionIdInvalid

busbar_value text_value(std::uint8_t type, std::string_view text)
{
    busbar_value value{};
    value.type = type;
    value.as.text = {text.data(), text.size()};
    return value;
}

} // namespace

namespace {

using NamedValues = std::vector<std::pair<std::string, busbar_value>>;

const std::array<busbar_text, 2> texts{{{"one", 3}, {nullptr, 0}}};
const std::array<std::int16_t, 6> numbers{1, 2, 3, 4, 5, -6};
const std::array<std::uint32_t, 2> dimensions{2, 3};

NamedValues all_values()
{
    NamedValues values;
    const auto put = [&](const char* name, busbar_value value) {
        values.emplace_back(name, value);
    };
    for (std::uint8_t type = BUSBAR_BOOLEAN; type <= BUSBAR_DOUBLE; ++type) {
        busbar_value value{};
        value.type = type;
        std::memset(&value.as, 1, busbar_type_size(type));
        put("Number", value);
    }
    put("Text", text_value(BUSBAR_STRING, "Zwölf"));
    put("Empty", text_value(BUSBAR_STRING, ""));
    put("Bytes", text_value(BUSBAR_BYTE_STRING, std::string_view{"\0\1", 2}));
    put("Xml", text_value(BUSBAR_XML_ELEMENT, "<a/>"));
    put("Id", text_value(BUSBAR_NODE_ID, "ns=2;s=Pump"));
    put("FarId", text_value(BUSBAR_EXPANDED_NODE_ID, "nsu=urn:x;i=5"));
    busbar_value name{};
    name.type = BUSBAR_QUALIFIED_NAME;
    name.as.qualified_name = {3, {"Name", 4}};
    put("QualifiedName", name);
    busbar_value words{};
    words.type = BUSBAR_LOCALIZED_TEXT;
    words.as.localized_text = {{"en", 2}, {"Word", 4}};
    put("LocalizedText", words);
    busbar_value time{};
    time.type = BUSBAR_DATE_TIME;
    time.as.time = busbar_time_of_unix(1'000'000'000, 500'000'000);
    put("Time", time);
    busbar_value guid{};
    guid.type = BUSBAR_GUID;
    guid.as.guid = {1, 2, 3, {4, 5, 6, 7, 8, 9, 10, 11}};
    put("Guid", guid);
    busbar_value code{};
    code.type = BUSBAR_STATUS_CODE;
    code.as.status = BUSBAR_BAD_TIMEOUT;
    put("Code", code);
    put("Texts", busbar_value_array(BUSBAR_STRING, texts.data(), 2));
    busbar_value matrix = busbar_value_array(BUSBAR_INT16, numbers.data(), 6);
    matrix.dimension_count = 2;
    matrix.dimensions = dimensions.data();
    put("Matrix", matrix);
    return values;
}

void check_same(const busbar_data_value& got, const busbar_value& sent)
{
    if (sent.type <= BUSBAR_DOUBLE && !sent.is_array) {
        CHECK(std::memcmp(&got.value.as, &sent.as, busbar_type_size(sent.type)) == 0);
    } else if (sent.type == BUSBAR_INT16) {
        CHECK(std::memcmp(got.value.as.array, numbers.data(), sizeof numbers) == 0);
        REQUIRE(got.value.dimension_count == 2);
        CHECK(got.value.dimensions[1] == 3);
    } else if (sent.is_array) {
        const auto* const elements = static_cast<const busbar_text*>(got.value.as.array);
        CHECK(text_of(elements[0]) == "one");
        CHECK(text_of(elements[1]) == "null");
    } else if (sent.type == BUSBAR_QUALIFIED_NAME) {
        CHECK(got.value.as.qualified_name.namespace_index == 3);
        CHECK(text_of(got.value.as.qualified_name.name) == "Name");
    } else if (sent.type == BUSBAR_LOCALIZED_TEXT) {
        CHECK(text_of(got.value.as.localized_text.text) == "Word");
    } else if (sent.type == BUSBAR_DATE_TIME) {
        CHECK(got.value.as.time == sent.as.time);
    } else if (sent.type == BUSBAR_GUID) {
        CHECK(std::memcmp(&got.value.as.guid, &sent.as.guid, sizeof sent.as.guid) == 0);
    } else if (sent.type == BUSBAR_STATUS_CODE) {
        CHECK(got.value.as.status == BUSBAR_BAD_TIMEOUT);
    } else {
        CHECK(text_of(got.value.as.text) == text_of(sent.as.text));
    }
}

} // namespace

TEST_CASE("values of all types and arrays of them go through a server and a client in C", "[c]")
{
    ServerInC machine;
    const NamedValues values = all_values();
    std::vector<std::string> paths;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string id = values[i].first + std::to_string(i);
        busbar_variable variable = machine.variable(id.c_str(), values[i].second);
        INFO(id << " " << busbar_server_last_error(machine.server));
        CHECK(busbar_server_add_variable(machine.server, &variable, nullptr) == good);
        paths.push_back("/Objects/2:" + id);
    }
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    CHECK(busbar_client_state(client.client) == BUSBAR_CLIENT_READY);
    for (std::size_t i = 0; i < values.size(); ++i) {
        INFO(paths[i]);
        const busbar_value& sent = values[i].second;
        CHECK(client.write(paths[i].c_str(), sent) == good);
        const busbar_data_value got = client.read(paths[i].c_str());
        CHECK(got.status == good);
        CHECK(got.source_time != 0);
        CHECK(got.value.type == sent.type);
        CHECK(got.value.is_array == sent.is_array);
        CHECK(got.value.count == sent.count);
        check_same(got, sent);
    }
    CHECK(busbar_client_disconnect(client.client) == good);
    CHECK(busbar_client_state(client.client) == BUSBAR_CLIENT_CLOSED);
}

namespace {

struct Tank {
    double level{3};
    busbar_batch* waiting{nullptr};
    busbar_read_item* items{nullptr};
};

busbar_status read_level(void* context, const char* node, busbar_data_value* value)
{
    CHECK(std::string{node} == "ns=2;s=Level");
    value->value = busbar_value_double(static_cast<Tank*>(context)->level);
    return BUSBAR_GOOD;
}

busbar_status write_level(void* context, const char* /*node*/, const busbar_data_value* value)
{
    if (value->value.as.float64 > 10) {
        return BUSBAR_BAD_OUT_OF_RANGE;
    }
    static_cast<Tank*>(context)->level = value->value.as.float64;
    return BUSBAR_GOOD;
}

busbar_status read_bus(void* /*context*/, busbar_batch* batch, busbar_read_item* items,
                       std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        items[i].result.status = items[i].handle == 99 ? BUSBAR_BAD_NO_COMMUNICATION : BUSBAR_GOOD;
        items[i].result.value = busbar_value_uint32(static_cast<std::uint32_t>(items[i].handle));
    }
    std::thread{[batch] { busbar_batch_complete(batch, BUSBAR_GOOD); }}.detach();
    return BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY;
}

busbar_status write_bus(void* context, busbar_batch* /*batch*/, busbar_write_item* items,
                        std::size_t count)
{
    static_cast<Tank*>(context)->level = static_cast<double>(items[0].value.value.as.uint32);
    items[0].result = BUSBAR_GOOD;
    return count == 1 ? BUSBAR_GOOD : BUSBAR_BAD_INTERNAL_ERROR;
}

} // namespace

TEST_CASE("callbacks of a variable and of a source in C serve reads and writes", "[c]")
{
    ServerInC machine;
    Tank tank;
    busbar_variable level = machine.variable("Level", busbar_value_double(0));
    level.read = read_level;
    level.write = write_level;
    level.context = &tank;
    std::uint64_t handle = 7;
    REQUIRE(busbar_server_add_variable(machine.server, &level, &handle) == good);
    CHECK(handle == 0);
    busbar_source source{};
    source.size = sizeof source;
    source.context = &tank;
    source.read = read_bus;
    source.write = write_bus;
    busbar_variable on_bus = machine.variable("OnBus", busbar_value_uint32(0));
    REQUIRE(busbar_server_add_source(machine.server, &source, &on_bus.source) == good);
    for (const auto& [name, number] : {std::pair{"OnBus", 5U}, std::pair{"Lost", 99U}}) {
        on_bus.node.name = name;
        on_bus.handle = number;
        REQUIRE(busbar_server_add_variable(machine.server, &on_bus, nullptr) == good);
    }
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    CHECK(client.read("ns=2;s=Level").value.as.float64 == 3);
    CHECK(client.write("ns=2;s=Level", busbar_value_double(4)) == good);
    CHECK(client.write("ns=2;s=Level", busbar_value_double(11)) == BUSBAR_BAD_OUT_OF_RANGE);
    CHECK(client.write("ns=2;s=Level", busbar_value_int32(1)) == BUSBAR_BAD_TYPE_MISMATCH);
    CHECK(client.read("ns=2;s=Level").value.as.float64 == 4);
    CHECK(client.read("ns=2;s=OnBus").value.as.uint32 == 5);
    CHECK(client.read("ns=2;s=Lost").status == BUSBAR_BAD_NO_COMMUNICATION);
    CHECK(client.write("ns=2;s=OnBus", busbar_value_uint32(8)) == good);
    machine.stop();
    CHECK(tank.level == 8);
}

namespace {

busbar_status add_up(void* /*context*/, busbar_call* /*call*/, const busbar_value* inputs,
                     std::size_t input_count, busbar_value* outputs, std::size_t output_count)
{
    CHECK(input_count == 2);
    CHECK(output_count == 1);
    outputs[0].as.float64 = inputs[0].as.float64 + inputs[1].as.float64;
    return outputs[0].as.float64 < 0 ? BUSBAR_BAD_OUT_OF_RANGE : BUSBAR_GOOD;
}

busbar_status answer_later(void* /*context*/, busbar_call* call, const busbar_value* inputs,
                           std::size_t /*input_count*/, busbar_value* /*outputs*/,
                           std::size_t /*output_count*/)
{
    std::thread{[call, number = inputs[0].as.uint32] {
        const busbar_value output = busbar_value_uint32(number + 1);
        busbar_call_finish(call, BUSBAR_GOOD, &output, 1);
    }}.detach();
    return BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY;
}

void count_change(void* context, std::uint32_t /*item*/, const busbar_data_value* value)
{
    static_cast<std::vector<std::pair<busbar_status, std::uint32_t>>*>(context)->emplace_back(
        value->status, value->value.as.uint32);
}

} // namespace

TEST_CASE("Methods in C answer at once or later", "[c]")
{
    ServerInC machine;
    const std::array<busbar_argument, 2> terms{
        {{"A", BUSBAR_DOUBLE, false, nullptr}, {"B", BUSBAR_DOUBLE, false, "the other"}}};
    const busbar_argument sum{"Sum", BUSBAR_DOUBLE, false, nullptr};
    const busbar_argument number{"Number", BUSBAR_UINT32, false, nullptr};
    const busbar_node add = machine.node("Add");
    const busbar_node later = machine.node("Later");
    REQUIRE(busbar_server_add_method(machine.server, &add, terms.data(), 2, &sum, 1, add_up,
                                     nullptr) == good);
    REQUIRE(busbar_server_add_method(machine.server, &later, &number, 1, &number, 1, answer_later,
                                     nullptr) == good);
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    const auto call = [&](const char* method, std::vector<busbar_value> inputs) {
        const busbar_value* outputs = nullptr;
        std::size_t count = 0;
        const busbar_status status = busbar_client_call(
            client.client, "/Objects", method, inputs.data(), inputs.size(), &outputs, &count);
        return std::pair{status, count == 1 ? outputs[0] : busbar_value{}};
    };
    const auto five = call("ns=2;s=Add", {busbar_value_double(2), busbar_value_double(3)});
    CHECK(five.first == good);
    CHECK(five.second.as.float64 == 5);
    CHECK(call("ns=2;s=Add", {busbar_value_double(-2), busbar_value_double(1)}).first ==
          BUSBAR_BAD_OUT_OF_RANGE);
    CHECK(call("ns=2;s=Add", {busbar_value_double(2)}).first == 0x80760000U); // ArgumentsMissing
    CHECK(call("ns=2;s=Later", {busbar_value_uint32(6)}).second.as.uint32 == 7);
    CHECK(call("ns=2;s=None", {}).first != good);
    const busbar_reference* references = nullptr;
    std::size_t count = 0;
    REQUIRE(busbar_client_browse(client.client, "/Objects", &references, &count) == good);
    std::size_t methods = 0;
    for (std::size_t i = 0; i < count; ++i) {
        methods += references[i].node_class == 4 ? 1 : 0;
    }
    CHECK(methods == 2);
}

TEST_CASE("a client in C is told of changes, and of nodes that there are none of", "[c]")
{
    ServerInC machine;
    busbar_variable parts = machine.variable("Parts", busbar_value_uint32(1));
    std::uint64_t handle = 0;
    REQUIRE(busbar_server_add_variable(machine.server, &parts, &handle) == good);
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    std::vector<std::pair<busbar_status, std::uint32_t>> changes;
    std::uint32_t subscription = 0;
    std::uint32_t item = 0;
    REQUIRE(busbar_client_subscribe(client.client, 10, count_change, &changes, &subscription) ==
            good);
    REQUIRE(busbar_client_monitor(client.client, subscription, "ns=2;s=Parts", 5, 1, &item) ==
            good);
    REQUIRE(busbar_client_monitor(client.client, subscription, "ns=2;s=Nothing", 5, 1, &item) ==
            good);
    CHECK(busbar_client_monitor(client.client, subscription + 7, "i=1", 5, 1, &item) ==
          no_subscription);
    const auto wait_for = [&](std::size_t count) {
        for (int i = 0; i < 500 && changes.size() < count; ++i) {
            REQUIRE(busbar_client_poll(client.client, 20) == good);
        }
        REQUIRE(changes.size() >= count);
    };
    wait_for(2);
    CHECK(client.write("ns=2;s=Parts", busbar_value_uint32(2)) == good);
    wait_for(3);
    CHECK(changes.back() == std::pair{good, 2U});
    CHECK(std::count_if(changes.begin(), changes.end(),
                        [](const auto& each) { return (each.first & 0x80000000U) != 0; }) == 1);
    CHECK(busbar_client_unsubscribe(client.client, subscription) == good);
    CHECK(busbar_client_unsubscribe(client.client, subscription) == no_subscription);
    CHECK(busbar_client_interrupt(client.client) == good);
    CHECK(busbar_client_run(client.client) == good);
    busbar_server_counts counts{};
    counts.size = sizeof counts;
    machine.stop();
    CHECK(busbar_server_count(machine.server, &counts) == good);
    CHECK(counts.sessions == 1);
    busbar_data_value kept{};
    CHECK(busbar_server_get_value(machine.server, handle, &kept) == good);
    CHECK(kept.value.as.uint32 == 2);
}

TEST_CASE("a server in C is stopped from another thread, and polled to its end", "[c]")
{
    ServerInC machine;
    CHECK(busbar_server_poll(machine.server, 0) == BUSBAR_BAD_INVALID_STATE);
    REQUIRE(busbar_server_start(machine.server) == good);
    CHECK(busbar_server_start(machine.server) == BUSBAR_BAD_INVALID_STATE);
    CHECK(std::string{busbar_server_last_error(machine.server)} == "the server has started");
    CHECK(busbar_server_poll(machine.server, 0) == good);
    std::thread{[&] { busbar_server_stop(machine.server); }}.join();
    CHECK(busbar_server_run(machine.server, false) == good);
    CHECK(busbar_server_poll(machine.server, 0) == BUSBAR_BAD_SHUTDOWN);
}

namespace {

/// Does what a callback must not do, and then what it may.
busbar_status meddle(void* context, busbar_call* /*call*/, const busbar_value* /*inputs*/,
                     std::size_t /*input_count*/, busbar_value* outputs,
                     std::size_t /*output_count*/)
{
    auto* const server = static_cast<busbar_server*>(context);
    busbar_node node{};
    node.name = "Late";
    outputs[0].as.uint32 =
        (busbar_server_poll(server, 0) == BUSBAR_BAD_INVALID_STATE ? 1U : 0U) +
        (busbar_server_run(server, false) == BUSBAR_BAD_INVALID_STATE ? 1U : 0U) +
        (busbar_server_add_object(server, &node, nullptr) == BUSBAR_BAD_INVALID_STATE ? 1U : 0U) +
        (busbar_server_remove_node(server, "ns=2;s=Meddle") == BUSBAR_BAD_INVALID_STATE ? 1U : 0U);
    const busbar_value seven = busbar_value_uint32(7);
    return busbar_server_set_value(server, 1, &seven, BUSBAR_GOOD, 0);
}

} // namespace

TEST_CASE("a callback in C cannot serve or change nodes, and can set values", "[c]")
{
    ServerInC machine;
    const busbar_variable parts = machine.variable("Parts", busbar_value_uint32(1));
    std::uint64_t handle = 0;
    REQUIRE(busbar_server_add_variable(machine.server, &parts, &handle) == good);
    REQUIRE(handle == 1);
    const busbar_argument refused{"Refused", BUSBAR_UINT32, false, nullptr};
    const busbar_node node = machine.node("Meddle");
    REQUIRE(busbar_server_add_method(machine.server, &node, nullptr, 0, &refused, 1, meddle,
                                     machine.server) == good);
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    const busbar_value* outputs = nullptr;
    std::size_t count = 0;
    REQUIRE(busbar_client_call(client.client, "/Objects", "ns=2;s=Meddle", nullptr, 0, &outputs,
                               &count) == good);
    REQUIRE(count == 1);
    CHECK(outputs[0].as.uint32 == 4);
    CHECK(client.read("ns=2;s=Parts").value.as.uint32 == 7);
}

namespace {

busbar_status only_fitter(void* /*context*/, busbar_text user, busbar_text password)
{
    return text_of(user) == "fitter" && text_of(password) == "open sesame!"
               ? BUSBAR_GOOD
               : BUSBAR_BAD_USER_ACCESS_DENIED;
}

} // namespace

TEST_CASE("a folder, users with hashes and a callback for others secure a server in C", "[c]")
{
    const test::TemporaryFolder folder;
    const std::string of_server = (folder.path / "server").string();
    const std::string of_client = (folder.path / "client").string();
    std::array<char, 160> hash{};
    REQUIRE(busbar_hash_password("Press the button", 1'000, hash.data(), hash.size()) == good);
    const busbar_user user{"guest", hash.data(), true};
    busbar_server_config config;
    busbar_server_config_init(&config);
    config.application.uri = "urn:test:secured";
    config.application.folder = of_server.c_str();
    config.takes_free_port = true;
    config.users = &user;
    config.user_count = 1;
    config.login = only_fitter;
    config.limits = BUSBAR_LIMITS_SMALL;
    busbar_server* server = nullptr;
    REQUIRE(busbar_server_create(&config, &server) == good);
    busbar_variable variable;
    busbar_variable_init(&variable);
    variable.node.name = "Speed";
    variable.node.namespace_index = 1;
    variable.value = busbar_value_double(1);
    variable.is_writable = true;
    REQUIRE(busbar_server_add_variable(server, &variable, nullptr) == good);
    REQUIRE(busbar_server_start(server) == good);
    std::thread thread{[&] { busbar_server_run(server, false); }};

    const std::string url = "opc.tcp://localhost:" + std::to_string(busbar_server_port(server));
    const auto write_as = [&](const char* name, const char* password,
                              std::uint32_t timeout_ms = 10'000) {
        busbar_client_config of;
        busbar_client_config_init(&of);
        of.application.uri = "urn:test:client";
        of.application.folder = of_client.c_str();
        of.url = url.c_str();
        of.user_name = name;
        of.password = password;
        busbar_client* client = nullptr;
        busbar_status status = busbar_client_create(&of, &client);
        if (status == good) {
            status = busbar_client_connect(client, timeout_ms);
        }
        const char* const node = "ns=1;s=Speed";
        const busbar_value value = busbar_value_double(2);
        busbar_status result = status;
        if (status == good) {
            status = busbar_client_write(client, &node, &value, 1, &result);
        }
        busbar_client_destroy(client);
        return status == good ? result : status;
    };
    const busbar_status stranger = write_as("fitter", "open sesame!");
    test::trust_all(folder.path / "client");
    // Refused by the server, the client would try again.
    const busbar_status unknown = write_as("fitter", "open sesame!", 300);
    test::trust_all(folder.path / "server");
    const busbar_status fitter = write_as("fitter", "open sesame!");
    const busbar_status guest = write_as("guest", "Press the button");
    const busbar_status wrong = write_as("guest", "Press the buttons");
    const busbar_status nobody = write_as(nullptr, nullptr);
    busbar_server_stop(server);
    thread.join();
    busbar_server_destroy(server);
    CHECK(std::string{busbar_status_name(stranger)} == "Bad_CertificateUntrusted");
    CHECK(unknown != good);
    CHECK(fitter == good);
    CHECK(std::string{busbar_status_name(guest)} == "Bad_UserAccessDenied");
    CHECK(wrong != good);
    CHECK(nobody != good);
}

} // namespace c_client_server_test
