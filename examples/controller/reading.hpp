#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "config.hpp"
#include "settings.hpp"

namespace busbar::example {

/// Where a controller's configuration comes from.
struct Origin {
    /// Empty: the built-in one.
    std::string file;
    // What the command line says instead of it.
    std::optional<std::uint16_t> port;
    std::string preset;
};

/// A configuration as it is now, with what was changed online.
struct Reading {
    std::unique_ptr<Settings> settings;
    /// The same, ready to be served: somebody can log in.
    ControllerConfig config;
};

/// Throws ConfigError. Without a file it may make the first account and print its password.
[[nodiscard]] Reading read(const Origin& origin);

} // namespace busbar::example
