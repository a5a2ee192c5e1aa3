#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <sys/types.h>

namespace busbar::bench {

/// What the gateway of one's own reads, and how.
struct OwnGatewayOptions {
    /// SLMP, otherwise Modbus TCP.
    bool is_slmp{false};
    /// A request for each address.
    bool has_no_plan{false};
    std::size_t variables{0};
    std::size_t under_way{4};
    std::uint16_t plc_port{0};
};

/// A process that serves registers of a PLC as ns=2;s=R0 and so on, as `busbar-controller` does
/// with a [[backend]], to anyone and without security.
class OwnGateway {
public:
    /// Before this process has threads. Exits if there is no port or process.
    explicit OwnGateway(const OwnGatewayOptions& options);
    OwnGateway(const OwnGateway&) = delete;
    OwnGateway& operator=(const OwnGateway&) = delete;
    /// Ends the process.
    ~OwnGateway();

    [[nodiscard]] std::string url() const { return "opc.tcp://127.0.0.1:" + std::to_string(port_); }
    [[nodiscard]] pid_t process() const { return process_; }

private:
    pid_t process_{-1};
    std::uint16_t port_{0};
};

} // namespace busbar::bench
