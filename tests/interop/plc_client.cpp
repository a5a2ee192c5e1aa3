// The client engines of the backends on a real socket, for tests against foreign servers.
// usage: plc-client modbus|slmp PORT [--udp] [--3e] [--under-way COUNT] [--unit UNIT] REQUEST...
// Sends all requests, and prints a line for each, in their order: "ok VALUE...", "exception 2",
// "end 4031", or the name of a status.
// Modbus: "FUNCTION ADDRESS QUANTITY|VALUE..."; 22: "22 ADDRESS AND OR"; 23: "23 ADDRESS QUANTITY
// WRITE_ADDRESS VALUE..."; 43: "43 CODE OBJECT".
// SLMP: "read D100 3", "bits M0 5", "write D100 1 2", "set M0 1 0", "random D1 D5 D9",
// "blocks D0 3 W10 2", "type", "echo ABC", "label NAME", "stop", "run".
#include <cstdio>
#include <map>
#include <sstream>

#include <asio/buffer.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/ip/udp.hpp>
#include <asio/write.hpp>
#include <poll.h>

#include <busbar/backend/modbus_client.hpp>
#include <busbar/backend/slmp_client.hpp>
#include <busbar/core/text.hpp>

using namespace busbar;
using namespace busbar::backend;

namespace {

TimePoint now()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

std::string join(const std::vector<std::uint16_t>& values)
{
    std::string text = "ok";
    for (const std::uint16_t value : values) {
        text += ' ' + std::to_string(value);
    }
    return text;
}

std::string text_of(const ModbusEvent& event)
{
    if (event.answer.exception) {
        return "exception " + std::to_string(static_cast<unsigned>(*event.answer.exception));
    }
    std::string text =
        event.status.is_good() ? join(event.answer.values) : std::string{name(event.status)};
    for (const auto& object : event.answer.identification.objects) {
        text += ' ' + object.value;
    }
    return text;
}

std::string text_of(const SlmpEvent& event)
{
    char text[16];
    if (event.answer.end_code != 0) {
        std::snprintf(text, sizeof text, "end %04X", unsigned{event.answer.end_code});
        return text;
    }
    std::string all =
        event.status.is_good() ? join(event.answer.words) : std::string{name(event.status)};
    for (const auto& label : event.answer.labels) {
        for (const std::byte byte : label.data) {
            std::snprintf(text, sizeof text, " %02X", std::to_integer<unsigned>(byte));
            all += text;
        }
    }
    return event.answer.text.empty() ? all : all + ' ' + event.answer.text;
}

template <typename Number>
std::vector<Number> rest_of(std::istringstream& words)
{
    std::vector<Number> values;
    for (Number value{}; words >> value;) {
        values.push_back(value);
    }
    return values;
}

ModbusRequest modbus_request(const std::string& text)
{
    std::istringstream words{text};
    unsigned function = 0;
    words >> function;
    std::vector<std::uint16_t> values = rest_of<std::uint16_t>(words);
    values.resize(std::max<std::size_t>(values.size(), 3));
    ModbusRequest request;
    request.function = static_cast<ModbusFunction>(function);
    request.address = values[0];
    if (request.function == ModbusFunction::MaskWriteRegister) {
        request.and_mask = values[1];
        request.or_mask = values[2];
    } else if (request.function == ModbusFunction::ReadDeviceIdentification) {
        request.read_code = static_cast<std::uint8_t>(values[0]);
        request.object = static_cast<std::uint8_t>(values[1]);
    } else if (request.function == ModbusFunction::ReadWriteRegisters) {
        request.quantity = values[1];
        request.write_address = values[2];
        request.values.assign(values.begin() + 3, values.end());
    } else if (is_write(request.function)) {
        const auto count = std::count(text.begin(), text.end(), ' ') - 1;
        request.values.assign(values.begin() + 1, values.begin() + 1 + count);
    } else {
        request.quantity = values[1];
    }
    return request;
}

SlmpDevice device_of(const std::string& text)
{
    return parse_slmp_address(text).value().device;
}

SlmpOperation slmp_operation(const std::string& text)
{
    const std::map<std::string, SlmpCommand> commands{
        {"read", SlmpCommand::BatchRead},       {"bits", SlmpCommand::BatchRead},
        {"write", SlmpCommand::BatchWrite},     {"set", SlmpCommand::BatchWrite},
        {"random", SlmpCommand::RandomRead},    {"blocks", SlmpCommand::BlockRead},
        {"type", SlmpCommand::TypeName},        {"echo", SlmpCommand::SelfTest},
        {"stop", SlmpCommand::RemoteStop},      {"run", SlmpCommand::RemoteRun},
        {"label", SlmpCommand::LabelRandomRead}};
    std::istringstream words{text};
    std::string command;
    std::string first;
    words >> command;
    SlmpOperation operation;
    operation.command = commands.at(command);
    operation.is_bits = command == "bits" || command == "set";
    if (operation.command == SlmpCommand::BatchWrite) {
        words >> first;
        operation.words = rest_of<std::uint16_t>(words);
        operation.blocks = {{device_of(first), static_cast<std::uint16_t>(operation.words.size())}};
    } else if (command == "random") {
        while (words >> first) {
            operation.blocks.push_back({device_of(first), 1});
        }
    } else if (command == "label") {
        words >> first;
        operation.labels = {{.name = first}};
    } else if (command == "echo") {
        words >> operation.text;
    } else {
        for (std::uint16_t points = 0; words >> first >> points;) {
            operation.blocks.push_back({device_of(first), points});
        }
    }
    return operation;
}

/// Runs an engine on a connected socket until all requests are answered.
template <typename Engine, typename Socket>
int run(Engine& engine, Socket& socket, const std::vector<std::uint64_t>& ids)
{
    std::map<std::uint64_t, std::string> answers;
    std::string reason;
    std::array<std::byte, 65'536> in{};
    while (answers.size() < ids.size()) {
        while (!engine.output().empty()) {
            const auto out = engine.output();
            engine.consume(socket.send(asio::buffer(out.data(), out.size())));
        }
        while (const auto event = engine.next_event()) {
            const bool is_end =
                std::remove_reference_t<decltype(*event)>::Kind::Closed == event->kind;
            (is_end ? reason : answers[event->id]) = is_end ? event->reason : text_of(*event);
        }
        const auto wait =
            std::chrono::ceil<std::chrono::milliseconds>(engine.next_deadline() - now());
        pollfd waits{socket.native_handle(), POLLIN, 0};
        if (answers.size() == ids.size()) {
            break;
        }
        if (::poll(&waits, 1, static_cast<int>(std::max<std::int64_t>(wait.count(), 0))) == 0) {
            engine.handle_deadline(now());
            continue;
        }
        asio::error_code error;
        const std::size_t size = socket.receive(asio::buffer(in), 0, error);
        if (error) {
            engine.close(status::Bad_ConnectionClosed, error.message());
        } else {
            static_cast<void>(engine.feed(std::span{in}.first(size), now()));
        }
    }
    for (const std::uint64_t id : ids) {
        std::puts(answers[id].c_str());
    }
    std::fprintf(stderr, "%s\n", reason.c_str());
    return 0;
}

struct Arguments {
    bool is_udp{false};
    bool is_3e{false};
    std::size_t under_way{1};
    std::uint8_t unit{1};
    std::vector<std::string> requests{};
};

Arguments arguments_of(const std::vector<std::string>& all)
{
    Arguments arguments;
    for (std::size_t i = 2; i < all.size(); ++i) {
        if (all[i] == "--udp") {
            arguments.is_udp = true;
        } else if (all[i] == "--3e") {
            arguments.is_3e = true;
        } else if (all[i] == "--under-way") {
            arguments.under_way = std::stoul(all.at(++i));
        } else if (all[i] == "--unit") {
            arguments.unit = static_cast<std::uint8_t>(std::stoul(all.at(++i)));
        } else {
            arguments.requests.push_back(all[i]);
        }
    }
    return arguments;
}

template <typename Socket>
int speak(const std::string& protocol, Socket& socket, const Arguments& arguments)
{
    std::vector<std::uint64_t> ids;
    if (protocol == "modbus") {
        ModbusClientOptions options;
        options.max_under_way = arguments.under_way;
        ModbusClient client{options};
        for (const std::string& request : arguments.requests) {
            ids.push_back(client.send(modbus_request(request), arguments.unit, now()).value());
        }
        return run(client, socket, ids);
    }
    SlmpClientOptions options;
    options.frame = arguments.is_3e ? SlmpFrame::Frame3E : SlmpFrame::Frame4E;
    options.is_datagram = arguments.is_udp;
    options.max_under_way = arguments.under_way;
    options.timeout = std::chrono::seconds{1};
    SlmpClient client{options};
    for (const std::string& request : arguments.requests) {
        ids.push_back(client.send(slmp_operation(request), now()).value());
    }
    return run(client, socket, ids);
}

} // namespace

int main(int argc, char** argv)
{
    try {
        const std::vector<std::string> all{argv + 1, argv + argc};
        const Arguments arguments = arguments_of(all);
        const auto port = static_cast<std::uint16_t>(std::stoul(all.at(1)));
        asio::io_context context;
        if (arguments.is_udp) {
            asio::ip::udp::socket socket{context};
            socket.connect({asio::ip::address_v4::loopback(), port});
            return speak(all[0], socket, arguments);
        }
        asio::ip::tcp::socket socket{context};
        socket.connect({asio::ip::address_v4::loopback(), port});
        return speak(all[0], socket, arguments);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "plc-client: %s\n", error.what());
        return 1;
    }
}
