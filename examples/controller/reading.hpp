#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "config.hpp"
#include "kept_project.hpp"
#include "settings.hpp"

namespace busbar::example {

/// Where a controller's configuration comes from.
struct Origin {
    /// Empty: the built-in one.
    std::string file;
    // What the command line says instead of it.
    std::optional<std::uint16_t> port;
    std::string preset;
    /// The folder of a project of model mode; empty: there is none.
    std::string project;
};

/// A configuration as it is now, with what was changed online.
struct Reading {
    std::unique_ptr<Settings> settings;
    /// The same, ready to be served: somebody can log in.
    ControllerConfig config;
    /// Null if there is none.
    std::unique_ptr<KeptProject> project;
};

/// Throws ConfigError. Without a file it may make the first account and print its password.
[[nodiscard]] Reading read(const Origin& origin);

} // namespace busbar::example
