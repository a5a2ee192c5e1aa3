#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>

#include "product/configuration/config.hpp"
#include "product/configuration/reading.hpp"

namespace busbar::product {

// What a configuration needs before it can be served. All throw ConfigError.

/// Fills in names that a file need not have.
void set_names(ControllerConfig& config);
/// Creates the key and the certificate if they are missing, which takes seconds; `log` is told.
/// Call it before clients can connect, because they are not answered in the meantime.
void make_missing_certificate(ControllerConfig config, DateTime now, LogSink& log);
/// Sets the certificate and the URL of a controller that listens on `port`. `log` is told of a new
/// certificate.
void set_endpoint(ControllerConfig& config, std::uint16_t port, DateTime now, LogSink& log);
/// Adds an account for a start without a file. Since a default password would be known to all, the
/// controller makes one of its own and shows it on the terminal of the first start.
void add_first_account(ControllerConfig& config);
/// Calls read_sources() and ensures that a user can log in: without a file it may create the first
/// account and print its password.
[[nodiscard]] Reading read(const Configuration& configuration, Substitutes substitutes = {});

/// The text for people when the controller is ready: how to reach it, the users that may log in,
/// what is left to do. `config` must be complete; `task_priority` is what the system granted to the
/// PLC's task; empty for a runtime's own.
[[nodiscard]] std::string welcome_text(const ControllerConfig& config, std::size_t variables,
                                       DateTime now, std::optional<int> task_priority);

/// The steps from a controller without any user to the first values.
[[nodiscard]] std::string setup_text(const std::string& url);

} // namespace busbar::product
