#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <busbar/backend/slmp_message.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/result.hpp>

/// The client's side of SLMP.
namespace busbar::backend {

/// The configuration of an SlmpClient. Every limit is finite.
struct SlmpClientConfig {
    /// The form of frames; PLCs that have only 3E do not answer 4E at all.
    SlmpFrame frame{SlmpFrame::Frame4E};
    /// UDP, where each frame is a datagram, else TCP.
    bool is_datagram{false};
    /// The receiver of all requests.
    SlmpStation station{};
    /// The time after which the PLC gives up, in units of 250 ms; 0: never. FX5 expects 0.
    std::uint16_t timer{16};
    /// A request ends with Bad_Timeout after this time, counted from when it is in output(). It
    /// should be longer than `timer` is.
    Duration timeout{std::chrono::seconds{5}};
    /// Requests that the PLC has at a time; with 3E always one, since answers have no number there.
    std::size_t max_under_way{1};
    /// Requests that wait for their turn; beyond: Bad_TooManyOperations.
    std::size_t max_waiting{256};
    /// The connection ends after so many requests in a row without an answer.
    std::size_t max_silent{3};
    /// Size of the largest response; a larger one ends the connection.
    std::size_t max_response{16'384};
};

/// An occurrence on a connection to a PLC.
struct SlmpEvent {
    /// The kind of occurrence.
    enum class Kind : std::uint8_t {
        Answer, // to the request with `handle`
        Closed, // the last event
    };
    /// Its kind.
    Kind kind{Kind::Closed};
    /// The request.
    std::uint32_t handle{0};
    /// Answer: Good if `answer` is one, whatever its end code; else the reason why there is none.
    /// Closed: the reason.
    StatusCode status{};
    /// The answer of the PLC.
    SlmpAnswer answer{};
    /// Answer: the time since the request was in output().
    Duration round_trip{0};
};

/// Counts the work of an SlmpClient.
struct SlmpClientCounters {
    /// Requests in output().
    std::uint64_t requests{0};
    /// Requests with an answer.
    std::uint64_t answers{0};
    /// Requests that ended with Bad_Timeout.
    std::uint64_t timeouts{0};
    /// Responses that no request waited for: late, doubled, or of a wrong serial number.
    std::uint64_t unexpected{0};
};

/// A client on one connection to a PLC: sends operations and matches their answers. Sans-I/O, in
/// the shape of the channel; for one thread. It ends when the connection is lost, or may no longer
/// be trusted; create a new one for the next connection.
///
/// A response that cannot be told from another one is never taken for an answer: with 4E it is
/// dropped by its serial number. With 3E, where there is none, the connection ends after a timeout
/// and after a response that does not fit; over UDP use another port then. The repetition of a 3E
/// datagram that fits the next request, too, cannot be noticed: prefer 4E, or TCP.
class BUSBAR_API SlmpClient {
public:
    explicit SlmpClient(SlmpClientConfig config);
    SlmpClient(SlmpClient&&) noexcept;
    SlmpClient& operator=(SlmpClient&&) noexcept;
    ~SlmpClient();

    /// Sends an operation, or lets it wait for its turn, and returns the handle that its Answer
    /// has. `timeout` zero: as configured. Bad_TooManyOperations, Bad_ConnectionClosed, or what
    /// encode_slmp_request() refuses it with; then nothing is sent.
    [[nodiscard]] Result<std::uint32_t> send(SlmpOperation operation, TimePoint now,
                                             Duration timeout = {});
    /// Requests that may be sent without waiting for their turn.
    [[nodiscard]] std::size_t free_places() const;

    /// Takes bytes of the PLC; one datagram over UDP. An error ends the connection.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    /// Returns the next occurrence.
    [[nodiscard]] std::optional<SlmpEvent> next_event();
    /// Returns the bytes to send next, at most one frame: over UDP a datagram, which consume()
    /// takes as a whole. Empty if there is nothing.
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes the first `size` bytes of output(), which were sent.
    void consume(std::size_t size);
    /// The time at which handle_deadline() has something to do; no_deadline if it has nothing.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Ends requests whose time is over at `now`.
    void handle_deadline(TimePoint now);

    /// The connection is lost, or not wanted any more: all requests end with `reason`. With
    /// Bad_ConnectionClosed a RemoteReset under way ends as done, since a PLC does not answer it
    /// but closes the connection.
    void close(StatusCode reason);
    /// Returns whether Closed has come, or waits in next_event().
    [[nodiscard]] bool is_closed() const;
    /// The work so far.
    [[nodiscard]] const SlmpClientCounters& counters() const;

private:
    struct Impl;

    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::backend
