#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/clock.hpp>

/// A simulated PLC, whatever its protocol is.
namespace plc_responder {

/// The PLC's side of one connection, in the shape of the harness's responders.
class Connection {
public:
    virtual ~Connection() = default;
    virtual void feed(std::span<const std::byte> in, busbar::TimePoint now) = 0;
    [[nodiscard]] virtual std::span<const std::byte> output() const = 0;
    virtual void consume(std::size_t size) = 0;
    [[nodiscard]] virtual busbar::TimePoint next_deadline() const = 0;
    virtual void handle_deadline(busbar::TimePoint now) = 0;
    [[nodiscard]] virtual bool is_closed() const = 0;
    virtual void set_latency(busbar::Duration latency) = 0;
};

/// The memory of a PLC, and what its connections have in common. Addresses are as in the
/// configuration of a backend: "D100", "holding:0".
class Plc {
public:
    virtual ~Plc() = default;
    /// Returns a new connection; the PLC must outlive it.
    [[nodiscard]] virtual std::unique_ptr<Connection> connect() = 0;
    /// False if there is no such device.
    virtual bool set(std::string_view address, std::uint16_t value) = 0;
    [[nodiscard]] virtual std::optional<std::uint16_t> get(std::string_view address) = 0;
    /// Refuses requests for an address with an exception or end code; 0: the usual one.
    virtual bool refuse(std::string_view address, std::uint16_t code) = 0;
    virtual void refuse_none() = 0;
    /// The time of an answer on new connections.
    virtual void set_latency(busbar::Duration latency) = 0;
    virtual void set_running(bool is_running) = 0;
    [[nodiscard]] virtual bool is_running() const = 0;
    /// Adds a label of this type id; false if the PLC has none.
    virtual bool add_label(std::string_view name, std::uint8_t type,
                           std::span<const std::byte> value) = 0;
};

/// A Modbus TCP device with all tables, or a gateway to several if it has units.
[[nodiscard]] std::unique_ptr<Plc> modbus_plc(std::vector<std::uint8_t> units);

/// The families of PLCs with SLMP, which differ in what they take.
enum class Family : std::uint8_t { IqR, Q, Fx5 };
/// A PLC with SLMP. `is_3e_only`: it does not answer 4E frames.
[[nodiscard]] std::unique_ptr<Plc> slmp_plc(Family family, bool is_3e_only, bool is_datagram,
                                            std::string password);

} // namespace plc_responder
