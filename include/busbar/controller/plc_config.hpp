#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/variant.hpp>

/// What a simulated PLC consists of. These are plain values; Plc::create checks them.
namespace busbar::controller {

struct PlcVariable {
    std::string name;
    /// Boolean to Double, String, DateTime, Guid, ByteString, XmlElement or StatusCode.
    BuiltInType type{BuiltInType::Int32};
    /// None for a scalar, one for an array, more for a matrix.
    std::vector<std::uint32_t> dimensions;
    /// Not 0: this many variables of the kind, called <name>0, <name>1...
    std::uint32_t count{0};
    /// Null: zeros and empty texts. Otherwise a value of the type and dimensions above; a scalar
    /// fills all elements of an array. Int64 and Double stand for any number that the type can
    /// have, String for a ByteString, XmlElement or Guid.
    Variant initial;
    bool is_writable{true};
    /// The most bytes of a text.
    std::uint32_t capacity{80};

    friend bool operator==(const PlcVariable&, const PlcVariable&) = default;
};

enum class PlcProgramKind : std::uint8_t {
    Increment, // adds `amplitude`; integers start over at their other end
    Sine,      // offset + amplitude * sin(2 pi t / period), elements shifted by their part of it
    Toggle,    // inverts a Boolean
    Copy,      // gives `target` the value of `source`
    // Takes bit 0 of an integer for a call to do something: clears it, and gives `sets` the value
    // `to`. So does a program that carries out Methods of model mode (seed 001, 8.3).
    Acknowledge,
    // Executes the instruction OPCUA_Shutdown as long as a Boolean is TRUE (seed 000, A-2), and
    // gives `sets` what comes of it: 0 nothing yet, 1 busy, 2 done, else its ErrorID.
    Shutdown,
};

/// A program works on all elements of a variable, and on all variables if that has a `count`.
struct PlcProgram {
    PlcProgramKind kind{PlcProgramKind::Increment};
    std::string target;
    /// Of Copy only: a variable of the same type and size.
    std::string source;
    /// How often it does its work; 0: in every scan. For Sine the length of a wave.
    std::chrono::milliseconds period{0};
    double amplitude{1};
    double offset{0};
    /// Of Acknowledge and Shutdown: a variable of numbers; empty: nothing more happens. What its
    /// type cannot have becomes the nearest that it can.
    std::string sets{};
    double to{0};

    friend bool operator==(const PlcProgram&, const PlcProgram&) = default;
};

/// Something that happens in the machine and that clients are told of, as an event.
struct PlcEvent {
    /// A scalar number: it happens in the scan in which the value comes to lie above `limit`; or a
    /// scalar Boolean: when it becomes true.
    std::string variable;
    double limit{0};
    /// 1 to 1,000 (Part 5, 6.4.2).
    std::uint16_t severity{500};
    std::string message;

    friend bool operator==(const PlcEvent&, const PlcEvent&) = default;
};

struct PlcConfig {
    std::vector<PlcVariable> variables;
    /// Run in this order in each scan.
    std::vector<PlcProgram> programs;
    /// Looked for after the programs.
    std::vector<PlcEvent> events;

    friend bool operator==(const PlcConfig&, const PlcConfig&) = default;
};

} // namespace busbar::controller
