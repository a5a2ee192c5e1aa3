#pragma once

#include <cstdint>
#include <vector>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/plan.hpp>
#include <busbar/backend/slmp_device.hpp>
#include <busbar/backend/slmp_message.hpp>

#include "slmp_family.hpp"

namespace busbar::backend::detail {

// An area of the plan has all of a device but its number: codes are below 100 hexadecimal, and what
// direct memory can be differs in two bits.

[[nodiscard]] std::uint32_t area_of(const SlmpDevice& device);
[[nodiscard]] SlmpDevice device_of(const PlanAddress& address);
[[nodiscard]] SlmpUnit unit_of(std::uint32_t area);
/// The area is in a module, on a link or in another CPU.
[[nodiscard]] bool is_extended(std::uint32_t area);

// The requests of a plan as commands of SLMP: one range is a batch, several ones are a list of
// words or bits (random read and write) if that is short enough, otherwise blocks.

/// The plan's limits for an area.
[[nodiscard]] PlanRule rule_of(std::uint32_t area, const SlmpProtocolOptions& options,
                               const SlmpLimits& limits);
/// The command for a request, whose ranges are within the limits.
[[nodiscard]] SlmpOperation operation_of(const PlanRequest& request, const SlmpFindings& findings);
/// Returns the words of the request's ranges from those of the answer to `command`.
[[nodiscard]] std::vector<std::uint16_t> words_of(const PlanRequest& request, SlmpCommand command,
                                                  std::vector<std::uint16_t> answer);
/// X or Y of the own station.
[[nodiscard]] bool is_io(const PlanAddress& address);

} // namespace busbar::backend::detail
