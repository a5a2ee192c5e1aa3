#include "server_in_c.hpp"

#include <array>
#include <vector>

#include <busbar/client/attributes.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/net/system.hpp>

namespace c_handles_test {

// What a server keeps of nodes, and what it frees with them.

using busbar::test::ClientInC;
using busbar::test::ServerInC;

namespace {

constexpr busbar_status good = BUSBAR_GOOD;

busbar_status read_two(void*, const char*, busbar_data_value* value)
{
    value->value = busbar_value_int32(2);
    return good;
}

/// Fills an array of two, as its output begins as one.
busbar_status give_two(void*, busbar_call*, const busbar_value*, std::size_t, busbar_value* outputs,
                       std::size_t)
{
    static const std::array<double, 2> numbers{1, 2};
    outputs[0].as.array = numbers.data();
    outputs[0].count = 2;
    return good;
}

/// Answers later, without outputs but with a count of them.
busbar_status fail_later(void*, busbar_call* call, const busbar_value*, std::size_t, busbar_value*,
                         std::size_t)
{
    std::thread{[call] { busbar_call_finish(call, BUSBAR_BAD_OUT_OF_RANGE, nullptr, 1); }}.detach();
    return BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY;
}

busbar_status set(const ServerInC& machine, std::uint64_t handle, std::int32_t to)
{
    const busbar_value value = busbar_value_int32(to);
    return busbar_server_set_value(machine.server, handle, &value, good, 0);
}

busbar_status get(const ServerInC& machine, std::uint64_t handle, std::int32_t& to)
{
    busbar_data_value value{};
    const busbar_status got = busbar_server_get_value(machine.server, handle, &value);
    to = value.value.as.int32;
    return got;
}

busbar_status read_nothing(void*, busbar_batch*, busbar_read_item*, std::size_t)
{
    return good;
}

/// Keeps the handles of what it is to write.
busbar_status take_handles(void* context, busbar_batch*, busbar_write_item* items,
                           std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        static_cast<std::vector<std::uint64_t>*>(context)->push_back(items[i].handle);
        items[i].result = good;
    }
    return good;
}

struct NoLog final : busbar::LogSink {
    void write(busbar::LogLevel, std::string_view, std::string_view) override {}
};

/// Writes with a client that has values C has no form for.
std::vector<busbar::StatusCode> write_all(const std::string& url,
                                          std::vector<busbar::WriteValue> values)
{
    NoLog log;
    busbar::crypto::SystemRandom random;
    busbar::net::SystemWallClock clock;
    busbar::channel::ChannelEnvironment environment;
    environment.log = &log;
    environment.random = &random;
    environment.wall_clock = &clock;
    busbar::client::ClientConfig config;
    config.endpoint_url = url;
    config.application_uri = "urn:test:writer";
    config.security.allows_none = true;
    busbar::net::BlockingClient client{config, environment};
    REQUIRE(client.connect());
    auto written = client.wait_for<std::vector<busbar::StatusCode>>([&](auto done) {
        return busbar::client::write(client.client(), std::move(values), std::move(done));
    });
    REQUIRE(written);
    return *written;
}

/// The bytes of operator new; 0 where it is not the library's.
std::uint64_t bytes_in_use()
{
    busbar_memory memory{};
    memory.size = sizeof memory;
    return busbar_memory_in_use(&memory) == good ? memory.bytes : 0;
}

} // namespace

TEST_CASE("the handle of a variable in C ends with what it stands for", "[c]")
{
    ServerInC machine;
    busbar_variable variable = machine.variable("A", busbar_value_int32(1));
    std::uint64_t first = 0;
    std::uint64_t second = 0;
    std::int32_t value = 0;
    REQUIRE(busbar_server_add_variable(machine.server, &variable, &first) == good);
    REQUIRE(busbar_server_remove_node(machine.server, "ns=2;s=A") == good);
    CHECK(get(machine, first, value) == BUSBAR_BAD_NOT_FOUND);
    CHECK(set(machine, first, 5) == BUSBAR_BAD_NOT_FOUND);
    REQUIRE(busbar_server_add_variable(machine.server, &variable, &second) == good);
    CHECK(first != second);
    CHECK(set(machine, first, 5) == BUSBAR_BAD_NOT_FOUND);
    CHECK(set(machine, second, 6) == good);
    CHECK(get(machine, second, value) == good);
    CHECK(value == 6);

    variable.node.id = "ns=2;s=A";
    std::uint64_t third = 0;
    variable.value = busbar_value{};
    REQUIRE(busbar_server_bind_variable(machine.server, &variable, &third) == good);
    CHECK(set(machine, second, 7) == BUSBAR_BAD_NOT_FOUND);
    CHECK(set(machine, third, 7) == good);
    variable.read = read_two;
    REQUIRE(busbar_server_bind_variable(machine.server, &variable, nullptr) == good);
    CHECK(set(machine, third, 8) == BUSBAR_BAD_NOT_FOUND);
    CHECK(get(machine, third, value) == BUSBAR_BAD_NOT_FOUND);
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    CHECK(client.read("ns=2;s=A").value.as.int32 == 2);
}

TEST_CASE("a server in C frees what variables and Methods kept that are removed", "[c]")
{
    ServerInC machine;
    const std::string text(1'000'000, 'x');
    const busbar_node folder = machine.node("Folder");
    busbar_variable variable = machine.variable("Long", busbar_value_string(text.c_str()));
    variable.node.parent = "ns=2;s=Folder";
    busbar_node method = machine.node("Method");
    method.parent = "ns=2;s=Folder";
    const std::uint64_t before = bytes_in_use();
    for (int i = 0; i < 10; ++i) {
        REQUIRE(busbar_server_add_object(machine.server, &folder, nullptr) == good);
        REQUIRE(busbar_server_add_variable(machine.server, &variable, nullptr) == good);
        REQUIRE(busbar_server_add_method(machine.server, &method, nullptr, 0, nullptr, 0, give_two,
                                         nullptr) == good);
        REQUIRE(busbar_server_remove_node(machine.server, "ns=2;s=Folder") == good);
    }
    CHECK(bytes_in_use() < before + 1'000'000);
}

TEST_CASE("a server in C keeps nothing of an image that it could not add", "[c]")
{
    ServerInC machine;
    std::vector<std::uint64_t> memory(200'000);
    const busbar_variable taken = machine.variable("Taken", busbar_value_int32(1));
    REQUIRE(busbar_server_add_variable(machine.server, &taken, nullptr) == good);
    const busbar_image_variable variable{{"Taken", BUSBAR_STRING, 0, 1'000'000, nullptr}, 0, true};
    busbar_image_config config{};
    config.size = sizeof config;
    config.memory = memory.data();
    config.memory_size = memory.size() * sizeof memory[0];
    config.variables = &variable;
    config.count = 1;
    config.namespace_index = machine.index;
    busbar_image* image = nullptr;
    const std::uint64_t before = bytes_in_use();
    for (int i = 0; i < 10; ++i) {
        CHECK(busbar_server_add_image(machine.server, &config, &image) == 0x805E0000U); // exists
    }
    CHECK(bytes_in_use() < before + 1'000'000);
}

TEST_CASE("Properties of a type in C that cannot be leave no type", "[c]")
{
    ServerInC machine;
    const busbar_node type = machine.node("Type");
    const auto add = [&](const char* second) {
        const std::array<busbar_property, 2> properties{
            {{"A", BUSBAR_DOUBLE, false}, {second, BUSBAR_DOUBLE, false}}};
        return busbar_server_add_object_type(machine.server, &type, properties.data(), 2);
    };
    CHECK(add("") == 0x80600000U);  // Bad_BrowseNameInvalid
    CHECK(add("A") == 0x80610000U); // Bad_BrowseNameDuplicated
    CHECK(add(std::string(600, 'x').c_str()) == 0x80600000U);
    CHECK(add("B") == good); // the type is not there yet
}

TEST_CASE("a structure in C may have the NodeId that would be its encoding's", "[c]")
{
    ServerInC machine;
    const busbar_field field{"Member", BUSBAR_DOUBLE, 0, 0, nullptr};
    for (int i = 1; i < 20; ++i) {
        const std::string id = "ns=2;i=" + std::to_string(i);
        const std::string name = "Type" + std::to_string(i);
        busbar_node node = machine.node(name.c_str());
        node.id = id.c_str();
        busbar_structure* structure = nullptr;
        const busbar_status added =
            busbar_server_add_structure(machine.server, &node, &field, 1, &structure);
        CHECK((added == good || added == 0x805E0000U)); // Bad_NodeIdExists: an earlier encoding's
        if (added != good) {
            node.id = nullptr; // the name must be free still
            CHECK(busbar_server_add_structure(machine.server, &node, &field, 1, &structure) ==
                  good);
        }
    }
}

TEST_CASE("a source in C gets no values that C has no form for", "[c]")
{
    ServerInC machine;
    std::vector<std::uint64_t> handles;
    busbar_source source{};
    source.size = sizeof source;
    source.context = &handles;
    source.read = read_nothing;
    source.write = take_handles;
    busbar_variable variable = machine.variable("Xml", busbar_value_int32(0));
    variable.data_type = "i=24"; // BaseDataType
    variable.handle = 1;
    REQUIRE(busbar_server_add_source(machine.server, &source, &variable.source) == good);
    REQUIRE(busbar_server_add_variable(machine.server, &variable, nullptr) == good);
    variable.node.name = "Variants";
    variable.value = busbar_value_array(BUSBAR_INT32, nullptr, 0);
    variable.handle = 2;
    REQUIRE(busbar_server_add_variable(machine.server, &variable, nullptr) == good);
    variable.node.name = "Number";
    variable.value = busbar_value_int32(0);
    variable.handle = 3;
    REQUIRE(busbar_server_add_variable(machine.server, &variable, nullptr) == good);
    machine.run();

    using namespace busbar;
    std::vector<WriteValue> values;
    const auto put = [&](const char* name, Variant value) {
        values.push_back(client::value_for(NodeId{2, String{name}}, DataValue{std::move(value)}));
    };
    Array<Variant> variants;
    variants.push_back(Variant{std::int32_t{1}});
    put("Xml", Variant{ExtensionObject::from_xml(NodeId{2, 99U}, XmlElement{String{"<A/>"}})});
    put("Variants", Variant{std::move(variants)});
    put("Number", Variant{std::int32_t{1}});
    CHECK(write_all(machine.url(), values) ==
          std::vector{status::Bad_NotSupported, status::Bad_NotSupported, status::Good});
    machine.stop();
    CHECK(handles == std::vector<std::uint64_t>{3});
}

TEST_CASE("Methods in C begin with arrays as outputs, and fail without outputs", "[c]")
{
    ServerInC machine;
    const busbar_argument numbers{"Numbers", BUSBAR_DOUBLE, true, nullptr};
    const busbar_node two = machine.node("Two");
    const busbar_node late = machine.node("Late");
    REQUIRE(busbar_server_add_method(machine.server, &two, nullptr, 0, &numbers, 1, give_two,
                                     nullptr) == good);
    REQUIRE(busbar_server_add_method(machine.server, &late, nullptr, 0, &numbers, 1, fail_later,
                                     nullptr) == good);
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    const busbar_value* outputs = nullptr;
    std::size_t count = 0;
    CHECK(busbar_client_call(client.client, "/Objects", "ns=2;s=Late", nullptr, 0, &outputs,
                             &count) == BUSBAR_BAD_OUT_OF_RANGE);
    REQUIRE(busbar_client_call(client.client, "/Objects", "ns=2;s=Two", nullptr, 0, &outputs,
                               &count) == good);
    REQUIRE(count == 1);
    REQUIRE(outputs[0].is_array);
    REQUIRE(outputs[0].count == 2);
    CHECK(static_cast<const double*>(outputs[0].as.array)[1] == 2);
}

} // namespace c_handles_test
