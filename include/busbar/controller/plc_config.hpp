#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/variant.hpp>

/// The configuration of a simulated PLC. These are plain values; Plc::create checks them.
namespace busbar::controller {

/// A variable of the simulated PLC, or a series of them.
struct PlcVariable {
    std::string name;
    /// Boolean to Double, String, DateTime, Guid, ByteString, XmlElement or StatusCode.
    BuiltInType type{BuiltInType::Int32};
    /// Empty for a scalar, one for an array, more for a matrix.
    std::vector<std::uint32_t> dimensions;
    /// If not 0, this many variables are created, named `name0`, `name1` ...
    std::uint32_t count{0};
    /// Null: zeros and empty texts. Otherwise a value of the type and dimensions above; a scalar
    /// fills all elements of an array. Int64 and Double stand for any number in the type's range,
    /// String for a ByteString, XmlElement or Guid.
    Variant initial;
    bool is_writable{true};
    /// Maximum bytes of a text.
    std::uint32_t capacity{80};

    friend bool operator==(const PlcVariable&, const PlcVariable&) = default;
};

/// The action of a program in each scan.
enum class PlcProgramKind : std::uint8_t {
    Increment, // adds `amplitude`; integers wrap around
    Sine,   // offset + amplitude * sin(2 pi t / period), elements shifted by their fraction of it
    Toggle, // inverts a Boolean
    Copy,   // gives `target` the value of `source`
    // Treats bit 0 of an integer as a request: clears it, and gives `sets` the value `to`. A
    // program that carries out Methods of model mode does the same (SH-082679, 8.3).
    Acknowledge,
    // Executes the instruction OPCUA_Shutdown as long as a Boolean is TRUE
    // (W588, A-2), and writes the result to `sets`: 0 nothing yet, 1 busy, 2 done, otherwise its
    // ErrorID.
    Shutdown,
    // Executes the instruction GetPLCError (W588, 9-1-1): gives a number the code of the
    // highest current error, 0 if there is none, and `sets` its level: 0 none, 2 partial fault, 3
    // minor fault.
    PlcError,
};

/// A program works on all elements of a variable, and on all variables if that has a `count`.
struct PlcProgram {
    PlcProgramKind kind{PlcProgramKind::Increment};
    std::string target;
    /// For Copy only: a variable of the same type and size.
    std::string source;
    /// The interval of its work; 0: every scan. For Sine the length of a wave.
    std::chrono::milliseconds period{0};
    double amplitude{1};
    double offset{0};
    /// For Acknowledge, Shutdown and PlcError: a variable of numbers; if empty, nothing is written.
    /// A value out of its type's range becomes the nearest within it.
    std::string sets{};
    double to{0};

    friend bool operator==(const PlcProgram&, const PlcProgram&) = default;
};

/// A condition in the machine that is reported to clients as an event.
struct PlcEvent {
    /// A scalar number: the event occurs in the scan in which the value rises above `limit`; or a
    /// scalar Boolean: when it becomes true.
    std::string variable;
    double limit{0};
    /// 1 to 1,000 (Part 5, 6.4.2).
    std::uint16_t severity{500};
    std::string message;

    friend bool operator==(const PlcEvent&, const PlcEvent&) = default;
};

/// The variables, programs and events of the simulated PLC.
struct PlcConfig {
    std::vector<PlcVariable> variables;
    /// Run in this order in each scan.
    std::vector<PlcProgram> programs;
    /// Evaluated after the programs.
    std::vector<PlcEvent> events;

    friend bool operator==(const PlcConfig&, const PlcConfig&) = default;
};

} // namespace busbar::controller
