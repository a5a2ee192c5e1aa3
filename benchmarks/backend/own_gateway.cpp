#include "own_gateway.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/device_driver.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::bench {

namespace {

using backend::DevicePoint;

TimePoint gateway_now()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

/// R0 and so on, as addresses of both protocols.
std::vector<DevicePoint> points_of(const OwnGatewayOptions& options)
{
    std::vector<DevicePoint> points;
    for (std::size_t i = 0; i < options.variables; ++i) {
        const std::string number = std::to_string(i);
        const auto point = options.is_slmp ? backend::parse_slmp_point("D" + number)
                                           : backend::parse_modbus_point("holding:" + number);
        points.push_back(point.value()); // all of them are addresses
    }
    return points;
}

std::unique_ptr<backend::DeviceProtocol> protocol_of(const OwnGatewayOptions& options,
                                                     std::span<const DevicePoint> points)
{
    if (options.is_slmp) {
        backend::SlmpProtocolOptions slmp;
        slmp.client.max_under_way = options.under_way;
        slmp.max_words = options.has_no_plan ? 1 : slmp.max_words;
        slmp.max_gap = options.has_no_plan ? 0 : slmp.max_gap;
        return make_slmp_protocol(slmp, points);
    }
    backend::ModbusProtocolOptions modbus;
    modbus.client.max_under_way = options.under_way;
    modbus.max_read = options.has_no_plan ? 1 : modbus.max_read;
    modbus.max_gap = options.has_no_plan ? 0 : modbus.max_gap;
    return make_modbus_protocol(modbus, points);
}

bool add_variables(server::Server& server, backend::DeviceSource& source)
{
    model::AddressSpace& space = server.address_space();
    const auto index = space.add_namespace("urn:busbar:bench:gateway");
    if (!index) {
        return false;
    }
    model::NewNode node;
    node.parent = space.find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::UInt16};
    variable.source = server.add_source(source);
    for (std::size_t i = 0; i < source.points().size(); ++i) {
        const std::string name = "R" + std::to_string(i);
        node.id = NodeId{*index, String{name}};
        node.browse_name = QualifiedName{*index, String{name}};
        variable.handle = i;
        if (!space.add_variable(node, variable)) {
            return false;
        }
    }
    return true;
}

/// Serves until it is killed, and writes the port to `pipe`.
int serve(int pipe, const OwnGatewayOptions& options)
{
    net::StderrLog log{LogLevel::Error};
    net::SystemWallClock wall_clock;
    crypto::SystemRandom random;
    crypto::InsecureAcceptAnyCertificate validator;
    net::ServerLoop loop{log};
    const std::uint16_t port = loop.listen("127.0.0.1", 0).value_or(0);
    server::ServerConfig config;
    config.endpoint_url = "opc.tcp://127.0.0.1:" + std::to_string(port);
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    server::PasswordUsers users;
    users.set_anonymous_access(static_cast<std::uint8_t>(model::Access::Read));
    const server::ServerEnvironment environment{
        .random = &random,
        .wall_clock = &wall_clock,
        .log = &log,
        .validator = &validator,
        .users = &users,
        .waker = &loop.waker(),
    };
    const auto points = points_of(options);
    backend::Device device{{.name = "plc", .host = "127.0.0.1", .port = options.plc_port},
                           protocol_of(options, points),
                           log};
    backend::DeviceSource source{device, points, wall_clock, gateway_now};
    auto server = server::Server::create(std::move(config), environment);
    if (port == 0 || !server || !add_variables(*server, source) ||
        ::write(pipe, &port, sizeof port) != sizeof port) {
        return 1;
    }
    const net::DeviceDriver driver{loop, device, log};
    loop.stop_on_signals();
    loop.run(*server);
    return 0;
}

} // namespace

OwnGateway::OwnGateway(const OwnGatewayOptions& options)
{
    std::array<int, 2> pipe{};
    if (::pipe(pipe.data()) == 0) {
        process_ = ::fork();
    }
    if (process_ == 0) {
        ::close(pipe[0]);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::_exit(serve(pipe[1], options));
    }
    ::close(pipe[1]);
    if (process_ < 0 || ::read(pipe[0], &port_, sizeof port_) != sizeof port_) {
        std::fprintf(stderr, "busbar-backend-bench: the gateway does not start\n");
        std::exit(1);
    }
    ::close(pipe[0]);
}

OwnGateway::~OwnGateway()
{
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}

} // namespace busbar::bench
