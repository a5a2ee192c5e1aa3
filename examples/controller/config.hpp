#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/plc_config.hpp>
#include <busbar/server/server_config.hpp>

#include "toml_reader.hpp"

namespace busbar::example {

struct Account {
    std::string name;
    std::string password_hash;
    bool may_write{true};
};

/// Everything a configuration file says.
struct ControllerConfig {
    server::ServerConfig server;
    /// "" is every address of the machine.
    std::string address;
    std::uint16_t port{4840};
    /// The folder of the own certificate and key, and of the trust lists.
    std::string certificates{"busbar-certificates"};
    /// Whatever certificate a client shows is accepted. For the demo and tests only.
    bool trusts_all_clients{false};
    bool anonymous_may_write{false};
    std::vector<Account> accounts;
    std::chrono::milliseconds scan{20};
    /// Of the PLC's task, 1 to 99; 0 is none.
    int realtime_priority{0};
    controller::PlcConfig plc;
};

/// Reads a configuration; `file` is its name in messages. Throws ConfigError.
[[nodiscard]] ControllerConfig parse_config(std::string_view text, const std::string& file);
[[nodiscard]] ControllerConfig read_config(const std::string& path);

} // namespace busbar::example
