#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <busbar/backend/slmp_message.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/result.hpp>

/// The client's side of SLMP.
namespace busbar::backend {

/// The configuration of an SlmpClient. Every limit is finite.
struct SlmpClientOptions {
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
    /// Requests that wait or are under way; beyond: Bad_TooManyOperations.
    std::size_t max_requests{256};
    /// The connection ends after so many requests in a row without an answer.
    std::size_t max_silent{3};
    /// Size of the largest response; a larger one ends the connection.
    std::size_t max_response{16'384};
};

/// An event of an SlmpClient.
struct SlmpEvent {
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
    /// Good if `answer` is one, whatever its end code. Otherwise Bad_Timeout, Bad_DecodingError for
    /// bytes that do not answer this request, or the status with which the connection ended.
    StatusCode status{};
    /// The answer of the PLC, end codes included.
    SlmpAnswer answer{};
    /// Time from sending to the answer; 0 if there was none.
    Duration round_trip{0};
    /// The reason in words, for a log.
    std::string reason{};
};

/// The counters of a client, which start at 0.
struct SlmpClientCounters {
    /// Requests that were sent.
    std::uint64_t requests{0};
    /// Answers to these, end codes included.
    std::uint64_t answers{0};
    /// Requests without an answer in time.
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
    explicit SlmpClient(SlmpClientOptions options);
    SlmpClient(SlmpClient&&) noexcept;
    SlmpClient& operator=(SlmpClient&&) noexcept;
    ~SlmpClient();

    /// Sends an operation, or lets it wait until fewer are under way, and returns the id of its
    /// answer. `timeout` zero: as configured. Bad_TooManyOperations, Bad_ConnectionClosed, or what
    /// encode_slmp_request() refuses it with; then nothing is sent.
    [[nodiscard]] Result<std::uint64_t> send(SlmpOperation operation, TimePoint now,
                                             Duration timeout = {});
    /// Takes bytes of the PLC; one datagram over UDP. If they end the connection, or it has ended
    /// before, it returns the status of that; there is an event for it, too.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    /// Returns what happened next; none if there is nothing.
    [[nodiscard]] std::optional<SlmpEvent> next_event();
    /// Bytes for the PLC, at most one frame, which consume() removes from the front; valid until
    /// the next call. Over UDP a datagram, to be consumed as a whole.
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes sent bytes from output().
    void consume(std::size_t size);
    /// When handle_deadline() has to be called; no_deadline if nothing is waited for.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Lets time pass; call it when next_deadline() is reached.
    void handle_deadline(TimePoint now);
    /// Ends the connection: every request that has no answer has this bad status. With
    /// Bad_ConnectionClosed a RemoteReset under way ends as done, since a PLC does not answer it
    /// but closes the connection.
    void close(StatusCode status, std::string reason);

    /// True once the connection has ended.
    [[nodiscard]] bool is_closed() const;
    /// Requests that have been sent and wait for their answer.
    [[nodiscard]] std::size_t under_way() const;
    /// Returns what was counted so far.
    [[nodiscard]] const SlmpClientCounters& counters() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::backend
