#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <busbar/backend/modbus_pdu.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/result.hpp>

namespace busbar::backend {

/// The configuration of a ModbusClient.
struct ModbusClientOptions {
    /// Requests that are sent before the first of them is answered. Few documents say how many a
    /// device takes; 1 is safe.
    std::size_t max_under_way{1};
    /// The peer is a gateway to a serial line: one request at a time, whatever max_under_way says,
    /// and unit 0 is a broadcast, which no unit answers.
    bool is_gateway{false};
    /// The time that an answer may take from the moment at which its request is in output().
    Duration timeout{std::chrono::seconds{1}};
    /// The time for which a gateway's line is left alone after a broadcast, so that units can
    /// execute it.
    Duration broadcast_pause{std::chrono::milliseconds{100}};
    /// So many timeouts one after the other, without any byte in between, end the connection with
    /// Bad_Timeout: the peer may be gone without having said so. Of requests that were under way
    /// together one counts. 0: never.
    std::size_t max_silent{3};
    /// Requests that wait or are under way; beyond: Bad_TooManyOperations.
    std::size_t max_requests{1024};
};

/// An event of a ModbusClient.
struct ModbusEvent {
    /// The kinds of events.
    enum class Kind : std::uint8_t {
        /// The request `id` is finished.
        Answer,
        /// The connection is of no use any more and has to be closed; `reason` says why. Comes
        /// once, after the answers to all requests, and is the last event.
        Closed,
    };

    /// Says which members are set.
    Kind kind{Kind::Answer};
    /// The number of the request, as send() returned it.
    std::uint64_t id{0};
    /// Good if `answer` has what was requested. Otherwise status_of() the exception in `answer`, or
    /// Bad_Timeout, Bad_UnknownResponse for bytes that do not respond to this request, or the
    /// status with which the connection ended.
    StatusCode status{};
    /// The answer of the device, exceptions included.
    ModbusResponse answer{};
    /// Time from sending to the answer; 0 if there was none.
    Duration round_trip{};
    /// The reason in words, for a log.
    std::string reason{};
};

/// The counters of a client, which start at 0.
struct ModbusClientCounters {
    /// Requests that were sent.
    std::uint64_t requests{0};
    /// Answers to these, exceptions included.
    std::uint64_t answers{0};
    /// Those of the answers that are exceptions.
    std::uint64_t exceptions{0};
    /// Requests without an answer in time.
    std::uint64_t timeouts{0};
    /// Responses that no request waited for: late, doubled, or of a wrong transaction.
    std::uint64_t unexpected{0};
    /// Responses with the transaction of a request, but another unit, which are dropped also.
    std::uint64_t wrong_units{0};
    /// Responses whose bytes do not answer their request.
    std::uint64_t malformed{0};
};

/// The client's end of one connection to a Modbus TCP device or gateway (MODBUS Messaging on TCP/IP
/// V1.0b). It has no socket: bytes go in, bytes, events and the next deadline come out. For one
/// thread; a new connection needs a new client.
///
/// Requests are sent in the order of send(), and answered in any order: a response belongs to the
/// request with its transaction and unit. The answer to a request that has timed out is dropped
/// when it comes.
class BUSBAR_API ModbusClient {
public:
    explicit ModbusClient(ModbusClientOptions options);
    ModbusClient(ModbusClient&&) noexcept;
    ModbusClient& operator=(ModbusClient&&) noexcept;
    ~ModbusClient();

    /// Sends a request to a unit, or lets it wait until fewer are under way, and returns the id of
    /// its answer. Bad_OutOfRange for a request that the protocol does not allow, and for one that
    /// reads from all units of a gateway; Bad_TooManyOperations; Bad_ConnectionClosed after the
    /// end.
    [[nodiscard]] Result<std::uint64_t> send(ModbusRequest request, std::uint8_t unit,
                                             TimePoint now);
    /// Takes bytes of the peer. If these are not frames of Modbus TCP, it returns the status with
    /// which the connection ended, now or before; there is an event for it, too.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    /// Returns what happened next; none if there is nothing.
    [[nodiscard]] std::optional<ModbusEvent> next_event();
    /// Bytes for the peer, which consume() removes from the front; valid until the next call.
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes sent bytes from output().
    void consume(std::size_t size);
    /// When handle_deadline() has to be called; no_deadline if nothing is waited for.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Lets time pass; call it when next_deadline() is reached.
    void handle_deadline(TimePoint now);
    /// Ends the connection: every request that has no answer has this bad status.
    void close(StatusCode status, std::string reason);

    /// True once the connection has ended.
    [[nodiscard]] bool is_closed() const;
    /// Requests that have been sent and wait for their answer.
    [[nodiscard]] std::size_t under_way() const;
    /// Returns what was counted so far.
    [[nodiscard]] const ModbusClientCounters& counters() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::backend
