#pragma once

#include <cstdint>

#include <busbar/backend/plan.hpp>
#include <busbar/backend/slmp_device.hpp>

namespace busbar::backend::detail {

// An area of the plan has all of a device but its number: codes are below 100 hexadecimal, and what
// direct memory can be differs in two bits.

[[nodiscard]] std::uint32_t area_of(const SlmpDevice& device);
[[nodiscard]] SlmpDevice device_of(const PlanAddress& address);
[[nodiscard]] SlmpUnit unit_of(std::uint32_t area);
/// The area is in a module, on a link or in another CPU.
[[nodiscard]] bool is_extended(std::uint32_t area);

} // namespace busbar::backend::detail
