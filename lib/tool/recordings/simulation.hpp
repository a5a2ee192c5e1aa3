#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/variant.hpp>

namespace busbar::tool {

/// Says how the value of a simulated Variable passes with time.
struct SimulatedSignal {
    /// The kind of signal.
    enum class Kind : std::uint8_t {
        /// The value, until a client writes another one.
        Constant,
        /// It goes from the first value to the second one, and again.
        Ramp,
        /// It goes around the first value, at most by the second one.
        Sine,
        /// The values in turn, each for one period.
        Steps
    };
    Kind kind{Kind::Constant};
    std::vector<Variant> values;
    Duration period{0};

    /// Returns the value at this time since the beginning.
    [[nodiscard]] Variant at(Duration time) const;
};

/// One line of a simulation: a Variable below Objects.
struct SimulatedVariable {
    std::string name;
    SimulatedSignal signal;
    bool is_writable{false};
};

/// Reads the description of a simulated server, one Variable a line:
///
///     # a tank
///     Level    Double   ramp 0 100 60s
///     Heat     Float    sine 20 5 10s
///     Valve    Boolean  steps false true 5s
///     Setpoint Double   50 write
///
/// Values are written as client::parse_value() reads them; a text with spaces is in quotes. Ramp
/// and sine are for numbers. The Problem names file and line, what was found and what is expected.
[[nodiscard]] Configured<std::vector<SimulatedVariable>> read_simulation(std::string_view text,
                                                                         std::string_view file);

} // namespace busbar::tool
