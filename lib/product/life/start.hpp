#pragma once

#include <memory>

#include "product/configuration/reading.hpp"
#include "running_controller.hpp"

namespace busbar::product {

/// A controller of what is there now. If that does not make one, then as much as is needed of what
/// the controller ran with last is used instead: a file that became bad, settings that fit no more
/// or a project that cannot be loaded keep nobody from starting. The log says what was used and
/// why; nothing that is there is lost. Settings that are not used lie beside the others as
/// "settings.json.refused".
///
/// Throws ConfigError if that makes none either, or if it never ran.
[[nodiscard]] std::unique_ptr<RunningController> start(const Configuration& configuration,
                                                       Runtime& runtime, LogSink& log,
                                                       const ControllerOptions& options);

} // namespace busbar::product
