#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace busbar::bench {

/// What is measured at gateways: OPC UA servers in front of a simulated PLC.
struct GatewayOptions {
    /// Registers that are Variables, R0 and so on; one after the other.
    std::size_t variables{1'000};
    /// Reads of one value; a tenth as many of all values.
    std::size_t reads{500};
    /// Time of the Subscription.
    double seconds{5};
    /// Commands that start gateways of others; see the help.
    std::vector<std::string> peers;
    /// NodeId of their Variables, {} stands for the register.
    std::string peer_node{"ns=1;s=R{}"};
    /// Requests under way at our own gateways.
    std::size_t under_way{4};
};

/// Measures our own gateways, with the plan of requests and without, and then those of others, and
/// prints a row for each. Before this process has threads. Returns what main() returns.
int measure_gateways(const GatewayOptions& options);

} // namespace busbar::bench
