// A Modbus device made with libmodbus, for tests of a client: 200 items in each table, in which
// register N has the value N. Prints its port and serves one connection after the other until
// SIGTERM.
#include <array>
#include <cstdint>
#include <cstdio>

#include <modbus.h>
#include <netinet/in.h>
#include <sys/socket.h>

int main()
{
    modbus_t* const device = modbus_new_tcp("127.0.0.1", 0);
    constexpr int items = 200;
    modbus_mapping_t* const memory = modbus_mapping_new(items, items, items, items);
    if (device == nullptr || memory == nullptr) {
        return 1;
    }
    for (int i = 0; i < items; ++i) {
        memory->tab_registers[i] = static_cast<std::uint16_t>(i);
        memory->tab_input_registers[i] = static_cast<std::uint16_t>(i + 1000);
        memory->tab_input_bits[i] = i % 3 == 0;
    }
    int listener = modbus_tcp_listen(device, 4);
    sockaddr_in address{};
    socklen_t size = sizeof address;
    if (listener < 0 || getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
        return 1;
    }
    std::printf("ready at 127.0.0.1:%d\n", ntohs(address.sin_port));
    std::fflush(stdout);
    std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request{};
    while (modbus_tcp_accept(device, &listener) >= 0) {
        for (int length = 0; (length = modbus_receive(device, request.data())) >= 0;) {
            if (length > 0) {
                modbus_reply(device, request.data(), length, memory);
            }
        }
        modbus_close(device);
    }
    return 1;
}
