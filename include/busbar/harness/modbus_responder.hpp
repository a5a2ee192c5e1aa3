#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/backend/modbus_address.hpp>
#include <busbar/backend/modbus_pdu.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/result.hpp>

/// A Modbus TCP device for tests of what reads and writes one: its memory, its limits, and what
/// devices do that they should not.
namespace busbar::harness {

/// One fault, which happens to one response.
struct ModbusFault {
    /// The kinds of faults.
    enum class Kind : std::uint8_t {
        /// The request is executed and not answered.
        Silent,
        /// The request is not executed; `exception` answers it.
        Exception,
        /// The answer comes `delay` later than it would; other answers do not wait for it.
        Late,
        /// The answer comes after the next one.
        Overtaken,
        Twice,
        WrongTransaction,
        WrongUnit,
        WrongFunction,
        /// The header announces FFFF bytes, or none, or has another protocol.
        Oversize,
        Undersize,
        OtherProtocol,
        /// The answer's first `bytes` are sent, then the connection ends.
        Cut,
        /// The answer is `bytes` shorter or longer (`bytes` zeros follow) than it says.
        Short,
        Long,
    };

    /// Says what goes wrong.
    Kind kind{Kind::Silent};
    /// Responses that are sent as they should be before it.
    std::size_t after{0};
    /// The exception, for faults that answer with one.
    backend::ModbusException exception{backend::ModbusException::DeviceFailure};
    /// The additional delay of an answer.
    Duration delay{std::chrono::milliseconds{100}};
    /// A number of bytes, for faults of an answer's length.
    std::size_t bytes{0};
};

/// The configuration of a ModbusDevice.
struct ModbusDeviceOptions {
    /// Items of the tables, in the order of ModbusTable: 65,536 at most.
    std::array<std::size_t, 4> sizes{65536, 65536, 65536, 65536};
    /// Functions that it does not serve.
    std::vector<backend::ModbusFunction> missing_functions{};
    /// Units that it answers for, as a gateway does; none: all of them.
    std::vector<std::uint8_t> units{};
    /// Whether others are answered with exception 11, or not at all.
    bool answers_for_missing_units{true};
    /// Registers that a read or write may have, if the device takes fewer than the protocol.
    std::size_t max_registers{backend::max_modbus_read_registers};
    /// The conformity level of the identification (6.21).
    std::uint8_t conformity{0x81};
    /// Objects of its identification, by increasing id.
    std::vector<backend::ModbusIdentification::Object> objects{};
};

/// A device's memory and behaviour, which all its connections share.
class BUSBAR_API ModbusDevice {
public:
    explicit ModbusDevice(ModbusDeviceOptions options = {});

    /// Items of a table, 0 and 1 for bits; what the PLC's program would read and write.
    [[nodiscard]] std::span<std::uint16_t> table(backend::ModbusTable table);
    /// From now on, access to one of `count` items from `first` on is answered by `exception`.
    void refuse(backend::ModbusTable table, std::size_t first, std::size_t count,
                backend::ModbusException exception = backend::ModbusException::IllegalDataAddress);
    /// Ends what refuse() began.
    void refuse_none() { refused_.clear(); }
    /// Adds a fault, which waits for those before it.
    void disturb(const ModbusFault& fault) { faults_.push_back(fault); }
    /// Faults that have not happened.
    [[nodiscard]] std::size_t pending_faults() const { return faults_.size(); }

    /// Answers a request as bytes; none if it stays silent.
    [[nodiscard]] std::optional<std::vector<std::byte>> answer(std::uint8_t unit,
                                                               std::span<const std::byte> pdu);
    /// Returns the fault of the next response, and removes it, if it is its turn.
    [[nodiscard]] std::optional<ModbusFault> next_fault();

    /// Requests that were executed, broadcasts included.
    [[nodiscard]] std::uint64_t executed() const { return executed_; }

private:
    struct Refused {
        backend::ModbusTable table{};
        std::size_t first{0};
        std::size_t count{0};
        backend::ModbusException exception{};
    };

    [[nodiscard]] backend::ModbusResponse execute(const backend::ModbusRequest& request);
    [[nodiscard]] std::optional<backend::ModbusException>
    why_not(backend::ModbusTable table, std::size_t first, std::size_t count) const;
    [[nodiscard]] backend::ModbusResponse identify(const backend::ModbusRequest& request) const;

    ModbusDeviceOptions options_;
    std::array<std::vector<std::uint16_t>, 4> tables_;
    std::vector<Refused> refused_;
    std::deque<ModbusFault> faults_;
    std::uint64_t executed_{0};
};

/// The configuration of a ModbusResponder.
struct ModbusResponderOptions {
    /// Selects the treatment of a request while another one is not answered.
    enum class Overlap : std::uint8_t { Queue, Busy, Ignore };

    /// The time that a request takes; requests in a queue take it one after the other.
    Duration latency{0};
    /// Requests are executed at multiples of it only, as by a PLC between two scans; 0: at once.
    Duration scan{0};
    /// The treatment of overlapping requests.
    Overlap overlap{Overlap::Queue};
    /// Requests in the queue; others are answered with exception 6.
    std::size_t max_queue{64};
};

/// The device's end of one connection. It has no socket, as the engines: bytes go in, bytes and the
/// next deadline come out. The device must outlive it.
class BUSBAR_API ModbusResponder {
public:
    explicit ModbusResponder(ModbusDevice& device, ModbusResponderOptions options = {});
    ModbusResponder(ModbusResponder&&) noexcept;
    ModbusResponder& operator=(ModbusResponder&&) noexcept;
    ~ModbusResponder();

    /// Takes bytes of the client. Bad_DecodingError, and is_closed(), if they are not Modbus TCP.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    /// Returns the bytes to send.
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes sent bytes from output().
    void consume(std::size_t size);
    /// Returns the time at which handle_deadline() has something to do.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Lets time pass; call it when next_deadline() is reached.
    void handle_deadline(TimePoint now);
    /// Sets ModbusResponderOptions::latency for the requests to come.
    void set_latency(Duration latency);
    /// True if the connection ends when output() has been sent.
    [[nodiscard]] bool is_closed() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::harness
