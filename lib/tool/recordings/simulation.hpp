#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/built_in_type.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/variant.hpp>

#include "expression.hpp"

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

/// An argument of a simulated Method.
struct SimulatedArgument {
    std::string name;
    BuiltInType type{BuiltInType::Double};
};

/// An output of a simulated Method: an input, a value, or the result of an expression of numbers.
struct SimulatedAnswer {
    SimulatedArgument argument;
    std::optional<std::size_t> input;
    Variant value;
    std::optional<Expression> expression;
};

/// A Method below Objects.
struct SimulatedMethod {
    /// A Variable that a call sets, and the expression of its value.
    struct Setting {
        std::string variable;
        Expression expression;
    };
    std::string name;
    std::vector<SimulatedArgument> inputs;
    std::vector<SimulatedAnswer> outputs;
    std::vector<Setting> settings;
};

/// An event of the Server object: when a condition begins to hold, or again and again.
struct SimulatedEvent {
    std::string message;
    std::uint16_t severity{1};
    std::optional<Expression> condition;
    Duration period{0};
};

/// The contents of a simulation's file.
struct SimulatedMachine {
    std::vector<SimulatedVariable> variables;
    std::vector<SimulatedMethod> methods;
    std::vector<SimulatedEvent> events;
};

/// Reads the description of a simulated server, one thing a line:
///
///     # a tank
///     Level    Double   ramp 0 100 60s
///     Heat     Float    sine 20 5 10s
///     Valve    Boolean  steps false true 5s
///     Setpoint Double   50 write
///     method Add   in a Double b Double  out sum Double "a + b"
///     method Echo  in text String        out text String text
///     method Reset in to Double          sets Setpoint to
///     event "too full" 700 when "Level > 90"
///     event heartbeat 100 every 10s
///
/// Values are written as client::parse_value() reads them; a text with spaces is in quotes. Ramp
/// and sine are for numbers. An output is the input of that name, a value, or an expression of
/// numbers: inputs and Variables. The Problem names file and line, what was found and what is
/// expected.
[[nodiscard]] Configured<SimulatedMachine> read_simulation(std::string_view text,
                                                           std::string_view file);

/// The words of a line; one in quotes may have spaces.
[[nodiscard]] std::vector<std::string> simulation_words(std::string_view line);
/// The number in a value of a numeric type or Boolean; nothing in others and in arrays.
[[nodiscard]] std::optional<double> number_in(const Variant& value);
/// A number of the same type as `model`; empty if that type has none, or not this one: integers are
/// rounded, but neither limited nor made of what is not a number.
[[nodiscard]] Variant number_like(const Variant& model, double number);
/// The null value of a type: 0, false, an empty text.
[[nodiscard]] Variant null_of(BuiltInType type);

} // namespace busbar::tool
