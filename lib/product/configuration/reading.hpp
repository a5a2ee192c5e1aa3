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

/// The effective configuration: what is in force is made by merge() and nowhere else, for a start
/// as for each change of a running controller. Later layers count more (see Layer).
struct Reading {
    /// Its config() is all of these, now and after each change.
    std::unique_ptr<Settings> settings;
    /// The same; from read() of startup.hpp with the first account, where the controller makes one.
    ControllerConfig config;
    /// Null if there is none.
    std::shared_ptr<KeptProject> project;
};

/// What of a TakenOver is used instead of what is there.
struct Substitutes {
    /// Files that count as read.
    SourceFiles files{};
    /// For a project that is there but cannot be read any more; empty: there is no other.
    std::string project{};
    /// Instead of any project that is there.
    bool takes_other_project{false};
    /// Is served: what is there as this has it need not be read again; null: none is.
    std::shared_ptr<const KeptProject> running{};
};

/// Whether anybody can log in or not. Throws ConfigError.
[[nodiscard]] Reading read_sources(const Configuration& configuration,
                                   Substitutes substitutes = {});
/// Where all values of that come from. It only reads, so that it may be asked beside a controller
/// that runs. Throws ConfigError.
[[nodiscard]] Provenance provenance_of(const Configuration& configuration);

} // namespace busbar::product
