#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/backend/plan.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>

/// A PLC behind a connection that comes and goes: its protocol, its plan of requests, and when to
/// connect again.
namespace busbar::backend {

/// The outcome of a request on a DeviceLine.
struct DeviceAnswer {
    /// The kinds of answers.
    enum class Kind : std::uint8_t {
        Done,
        /// The PLC refuses what is in the request: RequestPlan::refuse.
        Refused,
        /// There is no answer, or a reason that is not in the request: RequestPlan::fail.
        Failed,
        /// The PLC does not have requests of this kind, and has done nothing: the protocol's plan()
        /// is another one by now, and RequestPlan::plan_again.
        Unknown,
    };

    /// Its kind.
    Kind kind{Kind::Failed};
    /// PlanRequest::id.
    std::uint64_t request{0};
    /// Good for Done.
    StatusCode status;
    /// Refused: the protocol's own code, which DeviceProtocol::text_of() knows.
    std::uint16_t code{0};
    /// Done, of a read: the words of all ranges.
    std::vector<std::uint16_t> words{};
    /// Time from sending to the answer; 0 if there is none.
    Duration round_trip{0};
};

/// The description that a PLC gives of itself, as far as its protocol has it.
struct DeviceIdentity {
    /// Its maker.
    std::string vendor{};
    /// Its type.
    std::string product{};
    /// Its version.
    std::string revision{};
    /// The family of PLCs that it is of, as the protocol calls it, if that makes a difference.
    std::string family{};

    friend bool operator==(const DeviceIdentity&, const DeviceIdentity&) = default;
};

/// The mode that a PLC says to be in.
enum class DeviceMode : std::uint8_t {
    Unknown, // the protocol does not say, or the PLC does not
    Run,
    Stop,
    Pause,
};

/// Returns "unknown", "RUN", "STOP" or "PAUSE".
[[nodiscard]] BUSBAR_API const char* name_of(DeviceMode mode);

/// One connection to a PLC in its protocol: an engine without a socket, for one thread.
class BUSBAR_API DeviceLine {
public:
    DeviceLine() = default;
    DeviceLine(const DeviceLine&) = delete;
    DeviceLine& operator=(const DeviceLine&) = delete;
    virtual ~DeviceLine() = default;

    /// True once requests can be sent, after what the protocol begins a connection with.
    [[nodiscard]] virtual bool is_ready() const = 0;
    /// True once the PLC has answered anything. Some take a connection only to close it.
    [[nodiscard]] virtual bool has_answered() const = 0;
    /// Sends a request. An error is the answer to it: no other one comes.
    virtual Result<void> send(const PlanRequest& request, TimePoint now) = 0;
    /// Returns the next answer.
    [[nodiscard]] virtual std::optional<DeviceAnswer> next_answer() = 0;
    /// Takes bytes of the PLC.
    virtual Result<void> feed(std::span<const std::byte> in, TimePoint now) = 0;
    /// Returns bytes for the PLC, which consume() removes from the front.
    [[nodiscard]] virtual std::span<const std::byte> output() const = 0;
    /// Removes sent bytes.
    virtual void consume(std::size_t size) = 0;
    /// When handle_deadline() has to be called; no_deadline if nothing is waited for.
    [[nodiscard]] virtual TimePoint next_deadline() const = 0;
    /// Lets time pass.
    virtual void handle_deadline(TimePoint now) = 0;
    /// True once the connection is of no use any more. Requests without an answer have none then.
    [[nodiscard]] virtual bool is_closed() const = 0;
    /// The reason, as a sentence without a full stop; empty if the other side closed it.
    [[nodiscard]] virtual std::string reason() const = 0;
    /// True if the PLC has refused the password of this connection. The Device connects again only
    /// after a long pause, because some PLCs count wrong passwords and stay locked.
    [[nodiscard]] virtual bool is_denied() const { return false; }
    /// Returns what the PLC says of itself; empty if it was not asked or does not say.
    [[nodiscard]] virtual DeviceIdentity identity() const { return {}; }
};

/// A protocol with its settings for one PLC.
class BUSBAR_API DeviceProtocol {
public:
    DeviceProtocol() = default;
    DeviceProtocol(const DeviceProtocol&) = delete;
    DeviceProtocol& operator=(const DeviceProtocol&) = delete;
    virtual ~DeviceProtocol() = default;

    /// The rules and limits of the plan, by what is known of the PLC.
    [[nodiscard]] virtual PlanConfig plan() const = 0;
    /// Returns another number than before once plan() may be another one.
    [[nodiscard]] virtual std::uint64_t plan_version() const { return 0; }
    /// Returns the text of DeviceAnswer::code for people, such as "exception 2 (...)".
    [[nodiscard]] virtual std::string text_of(std::uint16_t /*code*/) const { return {}; }
    /// The place in which the PLC has its mode; nothing if the protocol knows of none. The plan has
    /// a rule for its area.
    [[nodiscard]] virtual std::optional<PlanAddress> mode_place() const { return std::nullopt; }
    /// Reads the mode from the words of that place.
    [[nodiscard]] virtual DeviceMode mode_of(std::span<const std::uint16_t> /*words*/) const
    {
        return DeviceMode::Unknown;
    }
    /// Creates the line for a new connection.
    [[nodiscard]] virtual std::unique_ptr<DeviceLine> connect(TimePoint now) = 0;
};

/// The configuration of a Device.
struct DeviceConfig {
    /// The name in the log.
    std::string name{};
    /// Host of the PLC, or of its gateway; empty if its driver knows how to reach it.
    std::string host{};
    /// Its port.
    std::uint16_t port{0};
    /// Over UDP, where each frame is a datagram, else over TCP.
    bool is_datagram{false};
    /// Time that a connection may take until requests can be sent.
    Duration connect_timeout{std::chrono::seconds{5}};
    /// Pause after the first failed connection; it doubles with each further one.
    Duration first_pause{std::chrono::milliseconds{500}};
    /// The longest pause. Each one is shortened by up to a quarter, differently for each name and
    /// attempt, so that PLCs behind one switch are not asked all at once. After a refused password
    /// the pause is at least 10 minutes.
    Duration longest_pause{std::chrono::seconds{30}};
};

/// The state of a Device.
enum class DeviceState : std::uint8_t {
    Waiting,    // until it connects again
    Connecting, // until requests can be sent
    Online,
};

/// Counts the work of a Device since its construction.
struct DeviceCounters {
    /// Connections that were begun.
    std::uint64_t attempts{0};
    /// Connections on which requests could be sent.
    std::uint64_t connections{0};
    /// Requests with an answer, a refusal included.
    std::uint64_t answers{0};
    /// Requests that the PLC refused.
    std::uint64_t refusals{0};
    /// Requests without an answer.
    std::uint64_t failures{0};
    /// Round trip of the last answer.
    Duration round_trip{0};
    /// The longest round trip.
    Duration worst_round_trip{0};
};

/// A PLC: batches go in, requests of its plan go over whatever connection there is, and results
/// come out. It has no socket: net::DeviceDriver connects it. While there is no connection, batches
/// fail with Bad_NoCommunication at once. For one thread.
class BUSBAR_API Device {
public:
    /// `log` must outlive the object.
    Device(DeviceConfig config, std::unique_ptr<DeviceProtocol> protocol, LogSink& log);
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device();

    /// Its configuration.
    [[nodiscard]] const DeviceConfig& config() const;

    // For who reads and writes; like RequestPlan.

    /// Begins a batch. Bad_NoCommunication if the device is not Online; errors of RequestPlan.
    [[nodiscard]] Result<std::uint64_t> read(std::span<const PlanAddress> addresses, TimePoint now);
    /// Likewise for writes.
    [[nodiscard]] Result<std::uint64_t> write(std::span<const PlanWrite> writes, TimePoint now);
    /// Returns the next finished batch.
    [[nodiscard]] std::optional<PlanResult> next_result();
    /// Calls `handler` whenever there may be results, or the state has changed: within connected(),
    /// feed(), handle_deadline() and lost().
    void on_change(std::function<void()> handler);
    /// The state.
    [[nodiscard]] DeviceState state() const;
    /// The reason for not being Online, for people; empty while it is.
    [[nodiscard]] const std::string& trouble() const;
    /// True while it waits because the PLC has refused the password.
    [[nodiscard]] bool is_denied() const;
    /// Returns what the PLC said of itself when it was last Online, without what cannot be shown.
    [[nodiscard]] const DeviceIdentity& identity() const;
    /// The same in one line: "Maker Type 1.0"; empty if it said nothing.
    [[nodiscard]] std::string identity_text() const;
    /// The protocol, whose mode_place() can be read like any address.
    [[nodiscard]] const DeviceProtocol& protocol() const;
    /// The last refusal in words; empty if there was none with a code.
    [[nodiscard]] const std::string& last_refusal() const;
    /// The work so far.
    [[nodiscard]] const DeviceCounters& counters() const;
    /// The work of its plan so far.
    [[nodiscard]] const PlanCounters& plan_counters() const;

    /// Sends what the owner of a line has given to it besides the plan.
    void flush(TimePoint now);

    // For the driver of its connection.

    /// Calls `handler` when output() or next_deadline() have changed within read() or write().
    void on_output(std::function<void()> handler);
    /// True if a connection is to be made now; connected() or lost() must follow.
    [[nodiscard]] bool wants_connection(TimePoint now) const;
    /// The driver has begun to connect.
    void connecting(TimePoint now);
    /// There is a connection.
    void connected(TimePoint now);
    /// There is none any more, or it could not be made.
    void lost(const std::string& reason, TimePoint now);
    /// Takes bytes of the PLC.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    /// Returns bytes for the PLC.
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes sent bytes.
    void consume(std::size_t size);
    /// When handle_deadline() or wants_connection() has to be called.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Lets time pass.
    void handle_deadline(TimePoint now);
    /// True if the connection is to be closed; lost() must follow.
    [[nodiscard]] bool is_closed() const;

private:
    struct Impl;

    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::backend
