#pragma once

#include <cstdint>

#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>

#include "product/configuration/reading.hpp"

namespace busbar::product {

// What a configuration needs before it can be served. All throw ConfigError.

/// Names that a file need not give.
void set_names(ControllerConfig& config);
/// Makes the key and the certificate if there are none, which takes seconds; `log` is told. To be
/// called before clients can connect, as they are not answered meanwhile.
void make_missing_certificate(ControllerConfig config, DateTime now, LogSink& log);
/// Certificate and URL of a controller that listens on `port`. `log` is told of a new certificate.
void set_endpoint(ControllerConfig& config, std::uint16_t port, DateTime now, LogSink& log);
/// Without a file there is no account, and a password that everybody knows is none: the controller
/// makes one of its own, for whoever has the terminal that it is first started from.
void add_first_account(ControllerConfig& config);
/// What read_sources() gives, for which somebody can log in: without a file it may make the first
/// account and print its password.
[[nodiscard]] Reading read(const Configuration& configuration, Substitutes substitutes = {});

} // namespace busbar::product
