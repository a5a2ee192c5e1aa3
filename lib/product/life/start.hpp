#pragma once

#include <memory>

#include "product/configuration/reading.hpp"
#include "running_controller.hpp"

namespace busbar::product {

/// Starts a controller from the present files. If these are not valid, it replaces as much as
/// necessary by what the controller last ran with: a damaged file, settings that are no longer
/// valid or a project that cannot be loaded do not prevent the start. The log tells what was
/// replaced and why; nothing present is lost. Settings that are not used are kept beside the others
/// as "settings.json.refused".
///
/// `threads` makes those of PLCs. Throws ConfigError if that fails as well, or if the controller
/// never ran.
[[nodiscard]] std::unique_ptr<RunningController> start(const Configuration& configuration,
                                                       Runtime& runtime, LogSink& log,
                                                       const ControllerOptions& options,
                                                       controller::ThreadMaker& threads);

} // namespace busbar::product
