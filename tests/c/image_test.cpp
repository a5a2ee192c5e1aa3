#include "server_in_c.hpp"

#include <cstddef>
#include <cstring>

namespace c_image_test {

using namespace busbar;
using test::ClientInC;
using test::ServerInC;
using test::text_of;

namespace {

constexpr busbar_status good = BUSBAR_GOOD;

struct Drive {
    std::uint32_t count;
    double force;
    bool is_on;
};

struct Memory {
    std::uint16_t parts;
    double positions[3];
    Drive drive;
    BUSBAR_TEXT_MEMBER(recipe, 8);
};

const busbar_field drive_fields[] = {{"Count", BUSBAR_UINT32, 0, 0, nullptr},
                                     {"Force", BUSBAR_DOUBLE, 0, 0, nullptr},
                                     {"IsOn", BUSBAR_BOOLEAN, 0, 0, nullptr}};

class ImageInC {
public:
    ImageInC()
    {
        const busbar_node node = machine.node("DriveType");
        REQUIRE(busbar_server_add_structure(machine.server, &node, drive_fields, 3, &drive) ==
                good);
    }
    [[nodiscard]] busbar_status add()
    {
        const busbar_image_variable variables[] = {
            {{"Parts", BUSBAR_UINT16, 0, 0, nullptr}, offsetof(Memory, parts), false},
            {{"Positions", BUSBAR_DOUBLE, 3, 0, nullptr}, offsetof(Memory, positions), true},
            {{"Drive", BUSBAR_EXTENSION_OBJECT, 0, 0, drive}, offsetof(Memory, drive), true},
            {{"Recipe", BUSBAR_STRING, 0, 8, nullptr}, offsetof(Memory, recipe), true}};
        busbar_image_config config{};
        config.size = sizeof config;
        config.memory = &memory;
        config.memory_size = memory_size;
        config.variables = variables;
        config.count = 4;
        config.namespace_index = machine.index;
        return busbar_server_add_image(machine.server, &config, &image);
    }
    void scan()
    {
        busbar_image_begin_scan(image);
        ++memory.parts;
        busbar_image_publish(image, busbar_now());
    }

    Memory memory{};
    std::size_t memory_size{sizeof memory};
    busbar_structure* drive{nullptr};
    busbar_image* image{nullptr};
    ServerInC machine; // first to go: it uses the memory
};

} // namespace

TEST_CASE("a structure in C has the layout of a C struct, and goes to a value and back", "[c]")
{
    ImageInC press;
    REQUIRE(busbar_structure_size(press.drive) == sizeof(Drive));
    Drive drive{};
    drive.count = 5;
    drive.force = 2.5;
    drive.is_on = true;
    busbar_value value{};
    REQUIRE(busbar_structure_pack(press.drive, &drive, sizeof drive, &value) == good);
    CHECK(value.type == BUSBAR_EXTENSION_OBJECT);
    CHECK(value.as.extension.body.size == 4 + 8 + 1);
    Drive back{};
    REQUIRE(busbar_structure_unpack(press.drive, &value, &back, sizeof back) == good);
    CHECK(back.count == 5);
    CHECK(back.force == 2.5);
    CHECK(back.is_on);

    CHECK(busbar_structure_pack(press.drive, &drive, 3, &value) == BUSBAR_BAD_OUT_OF_RANGE);
    value.as.extension.body.size = 5;
    CHECK(busbar_structure_unpack(press.drive, &value, &back, sizeof back) != good);
    const busbar_value number = busbar_value_double(1);
    CHECK(busbar_structure_unpack(press.drive, &number, &back, sizeof back) ==
          BUSBAR_BAD_TYPE_MISMATCH);
    CHECK(back.count == 5);
    busbar_variable variable = press.machine.variable("First", value);
    REQUIRE(busbar_structure_pack(press.drive, &drive, sizeof drive, &variable.value) == good);
    CHECK(busbar_server_add_variable(press.machine.server, &variable, nullptr) == good);
}

TEST_CASE("an image in C publishes memory, and stores what clients write at the scan's edge", "[c]")
{
    ImageInC press;
    REQUIRE(press.add() == good);
    press.machine.run();
    ClientInC client{press.machine.url()};
    client.connect();
    CHECK(client.read("ns=2;s=Parts").status == BUSBAR_BAD_NO_COMMUNICATION);
    std::memcpy(press.memory.recipe.data, "plate", 5);
    press.memory.recipe.size = 5;
    press.memory.drive.count = 7;
    press.scan();
    CHECK(client.read("ns=2;s=Parts").value.as.uint16 == 1);
    CHECK(text_of(client.read("ns=2;s=Recipe").value.as.text) == "plate");
    const busbar_data_value drive = client.read("ns=2;s=Drive");
    Drive unpacked{};
    REQUIRE(busbar_structure_unpack(press.drive, &drive.value, &unpacked, sizeof unpacked) == good);
    CHECK(unpacked.count == 7);

    std::atomic<bool> ends{false};
    std::thread task{[&] {
        while (!ends) {
            press.scan();
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
    }};
    const double positions[] = {1, 2, 3};
    const busbar_status written =
        client.write("ns=2;s=Positions", busbar_value_array(BUSBAR_DOUBLE, positions, 3));
    const busbar_status too_long =
        client.write("ns=2;s=Recipe", busbar_value_string("too long it is"));
    const busbar_status read_only = client.write("ns=2;s=Parts", busbar_value_uint32(1));
    ends = true;
    task.join();
    CHECK(written == good);
    CHECK(too_long == BUSBAR_BAD_OUT_OF_RANGE);
    CHECK(read_only != good);
    CHECK(press.memory.positions[2] == 3);
    busbar_image_halt(press.image);
    CHECK(client.read("ns=2;s=Parts").status == 0x40900000U); // Uncertain_LastUsableValue
    press.machine.stop();
}

TEST_CASE("an image in C that does not fit its memory is refused as a whole", "[c]")
{
    ImageInC press;
    press.memory_size = sizeof(Memory) - 8;
    CHECK(press.add() == BUSBAR_BAD_OUT_OF_RANGE);
    CHECK(press.image == nullptr);
    CHECK(std::string{busbar_server_last_error(press.machine.server)} ==
          "variables[3]: has no place in the memory");
    press.memory_size = sizeof(Memory);
    busbar_variable taken = press.machine.variable("Recipe", busbar_value_double(0));
    REQUIRE(busbar_server_add_variable(press.machine.server, &taken, nullptr) == good);
    CHECK(press.add() == 0x805E0000U); // Bad_NodeIdExists
    CHECK(busbar_server_remove_node(press.machine.server, "ns=2;s=Recipe") == good);
    CHECK(press.add() == good);
}

} // namespace c_image_test
