#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "config.hpp"
#include "product/model/kept_project.hpp"
#include "settings.hpp"

namespace busbar::product {

/// Where a controller's configuration comes from.
struct Origin {
    /// Empty: the built-in one.
    std::string file;
    // What the command line says instead of it, and of a project.
    std::optional<std::uint16_t> port;
    std::string preset;
    /// The folder of a project of model mode; empty: there is none.
    std::string project;
};

/// A configuration as it is now, with what was changed online.
struct Reading {
    std::unique_ptr<Settings> settings;
    /// The same with what the project says; from read() of startup.hpp, ready to be served:
    /// somebody can log in.
    ControllerConfig config;
    /// Null if there is none.
    std::unique_ptr<KeptProject> project;
};

/// Whether anybody can log in or not. A project's preset counts instead of the file's. Throws
/// ConfigError.
[[nodiscard]] Reading read_sources(const Origin& origin);

} // namespace busbar::product
