#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>
#include <busbar/harness/link.hpp>
#include <busbar/harness/message_body.hpp>

namespace busbar::harness {

/// The `number`th message of a connection with this name, from 1: a message type ("HEL", "ACK",
/// "OPN", "MSG", "CLO", "ERR") or, where it can be read (with policy None, or from a host of this
/// world), the name of
/// the structure it carries ("ReadRequest", "PublishResponse"). Each name is counted separately, on
/// each connection, from the time when the script was played.
struct Message {
    std::string name;
    std::size_t number{1};
};

/// One fault, and when it happens; created by the functions in `fault` and narrowed by its members:
///
///     fault::cut().after(Message{"PublishResponse", 3})
///     fault::corrupt(40).at(Message{"OPN"}).sent_by(Side::Server)
///     fault::answer(status::Bad_Timeout).at(Message{"ReadRequest"}).times(2)
///     fault::jump_clock(6h).after(10s)
///
/// Acts once, on the first connection where its time comes, unless times() says otherwise. Without
/// a time it acts on the present connections or, if there are none, on the next one.
struct BUSBAR_API Fault {
    /// The effect of the fault; the functions below create one of each kind.
    enum class Kind : std::uint8_t {
        Delay,
        Hold,
        Cut,
        HalfOpen,
        Corrupt,
        Split,
        Answer,
        JumpClock,
        Refuse,
        Drop,
        Duplicate,
        Overtake,
        Change
    };
    /// Changes the body of a message; returns why it cannot, empty if it has.
    using Edit = std::function<std::string(std::vector<std::byte>& body)>;
    /// The moment at which the fault acts, relative to its message.
    enum class Moment : std::uint8_t { Before, At, After };

    // Time of the fault.

    /// Before the message's first byte is sent.
    [[nodiscard]] Fault before(const Message& which) const { return on(Moment::Before, which); }
    /// To the message itself; the same as before() for faults that act between messages.
    [[nodiscard]] Fault at(const Message& which) const { return on(Moment::At, which); }
    /// When the message's last byte has been sent.
    [[nodiscard]] Fault after(const Message& which) const { return on(Moment::After, which); }
    /// When a side, the client unless sent_by() says otherwise, has sent this many bytes since the
    /// connection began. Not for Answer.
    [[nodiscard]] Fault at_byte(std::uint64_t offset) const;
    /// This long after the script was played. Not for Corrupt, Delay and Answer.
    [[nodiscard]] Fault after(Duration delay) const;
    /// Only on the network's `number`th connection, from 1.
    [[nodiscard]] Fault on_connection(std::size_t which) const;
    /// Only what this side sends. For Hold and HalfOpen, the side whose bytes are held, or that
    /// notices.
    [[nodiscard]] Fault sent_by(Side sender) const;
    /// Number of times it acts, on its message and following ones of the same name; 0: always.
    [[nodiscard]] Fault times(std::size_t number) const;

    Kind kind{Kind::Cut};
    Moment moment{Moment::At};
    std::optional<Message> message{};
    std::optional<std::uint64_t> byte_offset{};
    std::optional<Duration> time{};
    std::optional<Side> side{};
    std::size_t connection{0};
    std::size_t count{1};
    /// For Delay, JumpClock and Hold; for Hold 0 means for ever.
    Duration duration{0};
    /// For Corrupt the bit of the message's first chunk, for Split the size of pieces.
    std::size_t position{0};
    unsigned bit{0};
    /// For Answer.
    StatusCode status{};
    /// For Change.
    Edit edit{};
    /// Says what changes, for describe().
    std::string edit_text{};

private:
    [[nodiscard]] Fault on(Moment when, const Message& what) const;
};

/// The faults that can happen.
namespace fault {

/// The connection is reset; what is under way is lost.
[[nodiscard]] BUSBAR_API Fault cut();
/// The message, and everything after it, arrives later.
[[nodiscard]] BUSBAR_API Fault delay(Duration by);
/// Bytes are held for this long, or for ever, and no side is told; from both sides unless sent_by()
/// says otherwise. The connection stays: what TCP does when a cable is pulled.
[[nodiscard]] BUSBAR_API Fault hold(Duration time = {});
/// The connection is gone, but only the client notices it, or the side that sent_by() names.
[[nodiscard]] BUSBAR_API Fault half_open();
/// Flips a bit of byte `position` of the message's first chunk, or of its last byte if that is
/// shorter. With at_byte() it is a bit of that byte.
[[nodiscard]] BUSBAR_API Fault corrupt(std::size_t position, unsigned bit = 0);
/// From then on bytes arrive one by one, or in pieces of this size.
[[nodiscard]] BUSBAR_API Fault split(std::size_t size = 1);
/// The request does not reach the server; it is answered by a ServiceFault with this status. Only
/// on a channel with policy None, where requests can be read on their way; the sequence numbers of
/// the following chunks are adjusted, so that neither side notices anything else.
[[nodiscard]] BUSBAR_API Fault answer(StatusCode status);
/// The message does not arrive. On a channel with policy None the sequence numbers of the following
/// chunks are adjusted, so that the receiver notices nothing else; on a secured one it finds the
/// gap.
[[nodiscard]] BUSBAR_API Fault drop();
/// The message arrives twice; the sequence numbers likewise.
[[nodiscard]] BUSBAR_API Fault duplicate();
/// The sender's next message overtakes this one, which does not arrive if there is none; the
/// sequence numbers likewise.
[[nodiscard]] BUSBAR_API Fault overtake();
/// Gives the message another body. It is sent in one chunk if it came in one, else in chunks as
/// large as its first one. Needs a channel with policy None, as do edit() and truncate();
/// Network::play() refuses it without an edit.
[[nodiscard]] BUSBAR_API Fault change(Fault::Edit edit, std::string text = "change");
/// The structure of the message is changed; those of other types stay as they are:
///
///     fault::change<ReadResponse>([](ReadResponse& response) { response.results.clear(); })
///         .at(Message{"ReadResponse"})
template <typename Structure, typename Work>
[[nodiscard]] Fault change(Work work)
{
    return change([work = std::move(work)](std::vector<std::byte>& body) -> std::string {
        auto structure = decode_body<Structure>(body);
        if (!structure) {
            return "it is another structure";
        }
        work(*structure);
        auto changed = encode_body(*structure);
        if (!changed) {
            return std::string{name(changed.error())};
        }
        body = *std::move(changed);
        return {};
    });
}
/// A field, by the names of the specification, gets another value: ("results[0].status",
/// "Bad_Timeout"), ("results[0].value", "Double:1.75"). Texts are read as client::parse_value()
/// reads them. Does not act if there is no such field, or if it cannot have the value; the log says
/// why.
[[nodiscard]] BUSBAR_API Fault edit(std::string path, std::string text);
/// The body of the message lacks so many bytes at its end, and its header's size says so.
[[nodiscard]] BUSBAR_API Fault truncate(std::size_t bytes);
/// The time of day jumps by this much, for all actors of the world.
[[nodiscard]] BUSBAR_API Fault jump_clock(Duration by);
/// The next connections are refused; the fault's times() is their number.
[[nodiscard]] BUSBAR_API Fault refuse();

} // namespace fault

/// Describes the fault in a line of text, for reports: "delay 2 s at ReadResponse 3 times 2".
[[nodiscard]] BUSBAR_API std::string describe(const Fault& fault);
/// Reads what describe() writes, but for changes that are a test's code: what happens, "before",
/// "at" or "after" which message (1 if no number follows) or time, or "at byte" N, then "of the
/// client" or "server", "on connection" N, "times" N or "always". Times have a unit: ms, s, min, h.
/// An edit has a text that is not empty.
/// The Problem says what was found and what is expected, or why the fault could never act.
[[nodiscard]] BUSBAR_API Configured<Fault> parse_fault(std::string_view text);

/// The faults of a run. Network::play() makes them happen.
using FaultScript = std::vector<Fault>;

/// Reads a file of faults, one a line; empty lines and those that begin with # are for people. The
/// Problem names the line: "bad.faults:3".
[[nodiscard]] BUSBAR_API Configured<FaultScript> read_faults(std::string_view text,
                                                             std::string_view file_name);

} // namespace busbar::harness
