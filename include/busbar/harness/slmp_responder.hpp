#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <busbar/backend/slmp_message.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>

/// The PLC's side of SLMP, for tests.
namespace busbar::harness {

/// The configuration of an SlmpResponder; the default is like an iQ-R CPU. The limits are those
/// that PLCs were measured with.
struct SlmpPlcOptions {
    /// The answer to TypeName.
    std::string type_name{"R08CPU"};
    /// Its code.
    std::uint16_t model{0x4801};
    /// Each feed() is a datagram (UDP), else bytes of a stream.
    bool is_datagram{false};
    /// Frames with a serial number get an answer; else none at all.
    bool takes_4e{true};
    /// The long form of devices, as iQ-R has it.
    bool takes_long_form{true};
    /// It answers TypeName, which built-in ports of Q and L refuse.
    bool has_type_name{true};
    /// It has labels.
    bool has_labels{true};
    /// It has RegisterMonitor and ReadMonitor.
    bool has_monitor{true};
    /// It has RandomRead and RandomWrite.
    bool has_random{true};
    /// It has BlockRead and BlockWrite, which built-in ports of Q and L refuse.
    bool has_blocks{true};
    /// One BlockWrite may have blocks of words and of bits; no known PLC takes that.
    bool takes_mixed_blocks{false};
    /// It answers as FX5 does: C052 for words and C051 for bits, C056 and C05C for devices; and
    /// over TCP only the last of several requests.
    bool is_fx5{false};
    /// It may be written to in RUN.
    bool is_written_in_run{true};
    /// Unlocks the port; empty: it is not locked.
    std::string password{};
    /// The time from a request to its answer, when it is served.
    Duration latency{0};
    /// Requests that may wait for that; others are lost.
    std::size_t max_waiting{32};
    /// Words of a batch or of all blocks.
    std::size_t max_words{960};
    /// Bits of a batch.
    std::size_t max_bits{7168};
    /// Devices of a random read in the short form; half of it in the long one.
    std::size_t max_random{192};
    /// Bits of a random write in the short form; half of it in the long one.
    std::size_t max_random_bits{188};
    /// Blocks of a block read or write in the short form; half of it in the long one.
    std::size_t max_blocks{120};
};

/// A mishap of an answer.
enum class SlmpMishap : std::uint8_t {
    None,
    Refused,     // an end code is answered instead
    Silent,      // there is no answer, though the request is served
    Twice,       // the answer comes two times
    WrongSerial, // it has another serial number; with 3E another station
    TooShort,    // its last word is missing, and its length fits
    CutOff,      // half of it is sent, and the connection ends
    Closed,      // the connection ends without an answer
};

/// A simulated PLC behind one connection: devices and labels that can be read and written, limits,
/// a password, RUN and STOP, and mishaps. Sans-I/O, in the shape of an engine. Devices and labels
/// outlive reconnect(), as a PLC's do a connection, and another_connection() shares them.
class BUSBAR_API SlmpResponder {
public:
    explicit SlmpResponder(SlmpPlcOptions options = {});
    SlmpResponder(SlmpResponder&&) noexcept;
    SlmpResponder& operator=(SlmpResponder&&) noexcept;
    ~SlmpResponder();

    /// Returns another connection to the same PLC: they share devices, labels, refusals, mishaps,
    /// the time of an answer, RUN and STOP. Each has its own lock and monitor, and its own
    /// requests.
    [[nodiscard]] SlmpResponder another_connection() const;

    /// Adds devices 0 to `count` - 1 of a kind, all 0: "D", "X"; "U3E0\G" for those of a module.
    /// False for an unknown kind.
    bool add_devices(std::string_view kind, std::uint32_t count);
    /// Sets a word, or a bit to 0 or 1. The address is one of parse_slmp_address(); for a word of a
    /// device of several, `word` is its number. False if there is no such device.
    bool set(std::string_view address, std::uint16_t value, std::uint32_t word = 0);
    /// Returns a word, or a bit as 0 or 1; 0 if there is no such device.
    [[nodiscard]] std::uint16_t get(std::string_view address, std::uint32_t word = 0) const;

    /// Adds a label of type `type` (SlmpLabelValue::type) with this value; `element_size` is its
    /// size in bytes, and a longer value is an array, whose elements are named "Label[0]". A bit
    /// has one byte, 0 or 1. Labels in structures and in arrays of more dimensions are added by
    /// full name.
    void add_label(std::string_view name, std::uint8_t type, std::span<const std::byte> value,
                   std::size_t element_size);
    /// Returns the value of a label as it was added; empty if it is unknown.
    [[nodiscard]] std::span<const std::byte> label(std::string_view name) const;
    /// Forgets all labels, such as before those of another program are added.
    void clear_labels();

    /// Lets this happen to the next `count` requests after those for which something is to happen
    /// already. `end_code` is what Refused answers.
    void happen(SlmpMishap mishap, std::size_t count = 1, std::uint16_t end_code = 0);
    /// From now on, requests for this device are answered by `end_code`. False for an address that
    /// parse_slmp_address() refuses.
    bool refuse(std::string_view address, std::uint16_t end_code);
    /// Ends what refuse() began.
    void refuse_none();
    /// Sets SlmpPlcOptions::latency for the requests to come.
    void set_latency(Duration latency);
    /// A new connection: nothing waits any more, and the port is locked again.
    void reconnect();
    /// Sets RUN or STOP, which remote control changes, too. SD203 has it as PLCs do, if there are
    /// such devices.
    void set_running(bool is_running);
    /// RUN or STOP.
    [[nodiscard]] bool is_running() const;
    /// Requests that were served so far, refused ones included.
    [[nodiscard]] std::uint64_t served() const;

    /// Takes bytes of a client; one datagram over UDP.
    void feed(std::span<const std::byte> in, TimePoint now);
    /// Returns the bytes to send next, at most one frame.
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes the first `size` bytes of output(), which were sent.
    void consume(std::size_t size);
    /// The time at which handle_deadline() serves a request; no_deadline if none waits.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Serves the requests that are due at `now`.
    void handle_deadline(TimePoint now);
    /// Returns whether the PLC has ended the connection; what is in output() is sent before.
    [[nodiscard]] bool is_closed() const;

private:
    struct Impl;

    explicit SlmpResponder(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::harness
