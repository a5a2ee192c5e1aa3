#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <busbar/product/configuration.hpp>

#include "config.hpp"
#include "layers.hpp"
#include "product/model/kept_project.hpp"
#include "settings.hpp"

namespace busbar::product {

/// The effective configuration. Only merge() makes it, for a start as well as for changes of a
/// running controller. Later layers override earlier ones (see Layer).
struct Reading {
    /// Its config() merges all layers, now and after each change.
    std::unique_ptr<Settings> settings;
    /// The same; from read() of startup.hpp with the first account, where the controller makes one.
    ControllerConfig config;
    /// Null for none.
    std::shared_ptr<KeptProject> project;
};

/// Parts of a TakenOver that replace the present ones.
struct Substitutes {
    /// Files that are not read again.
    SourceFiles files{};
    /// Replaces a project that can no longer be read; empty for none.
    std::string project{};
    /// Replaces any present project.
    bool takes_other_project{false};
    /// The project that is served, which need not be read again if it is unchanged; null for none.
    std::shared_ptr<const KeptProject> running{};
};

/// Reads the configuration, even if no user can log in. Throws ConfigError.
[[nodiscard]] Reading read_sources(const Configuration& configuration,
                                   Substitutes substitutes = {});
/// Finds the origin of all values. Only reads files, so that it can be used beside a running
/// controller. Throws ConfigError.
[[nodiscard]] Provenance provenance_of(const Configuration& configuration);

} // namespace busbar::product
