#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/backend/slmp_device.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/expected.hpp>
#include <busbar/core/result.hpp>

/// Messages of SLMP (MC protocol) in binary, in both directions: frames 3E and 4E, and the commands
/// in them (SH-080956ENG).
namespace busbar::backend {

/// The form of a frame: only 4E has serial numbers, by which answers find their requests.
enum class SlmpFrame : std::uint8_t { Frame3E, Frame4E };

/// The station that a request goes to; the default is the CPU that the port belongs to.
struct SlmpStation {
    /// Network number, 0 for the own one.
    std::uint8_t network{0};
    /// Station number, FF for the own one.
    std::uint8_t station{0xFF};
    /// The module's I/O number: 03FF the own CPU, 03E0 to 03E3 those of a rack.
    std::uint16_t module{0x3FF};
    /// Station of a multidrop connection, 0 for none.
    std::uint8_t multidrop{0};

    // NOLINTNEXTLINE(modernize-use-nullptr): the compiler's own comparison has a 0
    friend auto operator<=>(const SlmpStation&, const SlmpStation&) = default;
};

/// The head of a frame.
struct SlmpHead {
    /// Its form.
    SlmpFrame frame{SlmpFrame::Frame3E};
    /// Whether it has a response or a request.
    bool is_response{false};
    /// 4E only.
    std::uint16_t serial{0};
    /// The receiver, also in a response.
    SlmpStation station{};
    /// Size of the whole frame.
    std::size_t size{0};
    /// Size of the head, which ends before the monitoring timer or the end code.
    std::size_t head_size{0};
};

/// Reads the head of the first frame in `bytes`; nothing if they are too few. Bad_DecodingError if
/// they do not begin a frame in binary, or its size cannot be right.
[[nodiscard]] BUSBAR_API Result<std::optional<SlmpHead>>
read_slmp_head(std::span<const std::byte> bytes);

/// The commands that are known here.
enum class SlmpCommand : std::uint16_t {
    BatchRead = 0x0401,
    BatchWrite = 0x1401,
    RandomRead = 0x0403,
    RandomWrite = 0x1402,
    RegisterMonitor = 0x0801, // names the devices of ReadMonitor
    ReadMonitor = 0x0802,
    BlockRead = 0x0406,
    BlockWrite = 0x1406,
    LabelArrayRead = 0x041A,
    LabelArrayWrite = 0x141A,
    LabelRandomRead = 0x041C,
    LabelRandomWrite = 0x141B,
    TypeName = 0x0101,
    SelfTest = 0x0619,
    Unlock = 0x1630,
    Lock = 0x1631,
    RemoteRun = 0x1001,
    RemoteStop = 0x1002,
    RemotePause = 0x1003,
    RemoteLatchClear = 0x1005,
    RemoteReset = 0x1006, // has no answer if it is done
    ClearError = 0x1617,
};

/// Devices that follow one another.
struct SlmpBlock {
    /// The first one.
    SlmpDevice device;
    /// Their number, in bits or words.
    std::uint16_t points{1};

    friend bool operator==(const SlmpBlock&, const SlmpBlock&) = default;
};

/// A label in a request.
struct SlmpLabel {
    /// In UTF-8: "Station[2].Count"; with "%1" for the first abbreviation.
    std::string name{};
    /// Arrays: `length` counts bits, which are packed 16 to a word, else bytes.
    bool is_in_bits{false};
    /// Arrays: what is read or written from the named element on. Not used by LabelRandomRead;
    /// LabelRandomWrite has it from `data`.
    std::uint16_t length{0};
    /// Writes: the value.
    std::vector<std::byte> data{};

    friend bool operator==(const SlmpLabel&, const SlmpLabel&) = default;
};

/// A command and what belongs to it.
struct SlmpOperation {
    /// The command, which says which of the other members are used.
    SlmpCommand command{SlmpCommand::BatchRead};
    /// BatchRead, BatchWrite, RandomWrite: in bits instead of words.
    bool is_bits{false};
    /// Devices have the long form, that of iQ-R.
    bool has_long_form{false};
    /// Batch: one block. Random, RegisterMonitor: a word, or bit, each. Block: blocks of words.
    std::vector<SlmpBlock> blocks{};
    /// Random, RegisterMonitor: a double word each. Block: blocks of bits, whose points are words
    /// of 16 bits.
    std::vector<SlmpBlock> more_blocks{};
    /// The values to write: a word each, 0 or 1 for a bit, two for a double word, low one first; in
    /// the order of `blocks` and `more_blocks`.
    std::vector<std::uint16_t> words{};
    /// Names that labels have as "%1", "%2".
    std::vector<std::string> abbreviations{};
    /// The labels of a label command.
    std::vector<SlmpLabel> labels{};
    /// SelfTest: what the PLC is to send back. Unlock, Lock: the password.
    std::string text{};
    /// RemoteRun, RemotePause: 1, or 3 to overrule another station; others: 1.
    std::uint16_t mode{1};
    /// RemoteRun: 0 keeps the devices, 1 clears those that are not latched, 2 clears all.
    std::uint8_t clear{0};

    friend bool operator==(const SlmpOperation&, const SlmpOperation&) = default;
};

/// The value of a label in a response.
struct SlmpLabelValue {
    /// Id of the data type: 1 bit, 2 word, 3 double word, 4 and 5 the same with sign, 6 and 7
    /// floating-point number single and double, 8 time, 9 string, 10 Unicode string.
    std::uint8_t type{0};
    /// LabelArrayRead: 0 if the length counts bits, 1 for bytes. LabelRandomRead: no meaning.
    std::uint8_t unit{0};
    /// Length of the value in these units, always bytes for LabelRandomRead.
    std::uint16_t length{0};
    /// The value in the PLC's byte order, low byte first.
    std::vector<std::byte> data{};

    friend bool operator==(const SlmpLabelValue&, const SlmpLabelValue&) = default;
};

/// The origin of an error.
struct SlmpErrorInformation {
    /// The station that answers.
    SlmpStation station{};
    /// Command of the request.
    std::uint16_t command{0};
    /// Subcommand of the request.
    std::uint16_t subcommand{0};

    friend bool operator==(const SlmpErrorInformation&, const SlmpErrorInformation&) = default;
};

/// The answer to an operation.
struct SlmpAnswer {
    /// 0 if it is done; slmp_end_code.hpp has the others.
    std::uint16_t end_code{0};
    /// The information that comes with another end code than 0.
    std::optional<SlmpErrorInformation> error{};
    /// Reads of devices: the values, like SlmpOperation::words.
    std::vector<std::uint16_t> words{};
    /// Reads of labels: one for each label.
    std::vector<SlmpLabelValue> labels{};
    /// TypeName, without blanks at its end, and SelfTest.
    std::string text{};
    /// TypeName: the code of the model.
    std::uint16_t model{0};

    friend bool operator==(const SlmpAnswer&, const SlmpAnswer&) = default;
};

/// The part of a request after its head.
struct SlmpRequestBody {
    /// The time after which the PLC gives up, in units of 250 ms; 0: never.
    std::uint16_t timer{0};
    /// An SlmpCommand, or another one.
    std::uint16_t command{0};
    /// Its variant.
    std::uint16_t subcommand{0};
    /// The rest, which points into the frame.
    std::span<const std::byte> data{};
};

/// The subcommand of an operation.
[[nodiscard]] BUSBAR_API std::uint16_t slmp_subcommand(const SlmpOperation& operation);

/// Returns the frame of a request. Bad_InvalidArgument for an operation that no request can have:
/// numbers and devices that are not in the short form, words and blocks that do not match, names
/// that are not UTF-8; Bad_RequestTooLarge if it is too long for a frame. What a PLC takes of it is
/// the PLC's.
[[nodiscard]] BUSBAR_API Result<std::vector<std::byte>>
encode_slmp_request(const SlmpHead& head, std::uint16_t timer, const SlmpOperation& operation);

/// Reads what follows the head of a whole frame.
[[nodiscard]] BUSBAR_API Result<SlmpRequestBody>
read_slmp_request(const SlmpHead& head, std::span<const std::byte> frame);

/// Reads the operation of a request, or returns the end code that refuses it: C059 for unknown
/// commands, C061 for data that is too short or too long, C05C for what has no meaning.
[[nodiscard]] BUSBAR_API Expected<SlmpOperation, std::uint16_t>
decode_slmp_request(const SlmpRequestBody& body);

/// Returns the frame of an answer. The error information of an `answer` with an end code is sent
/// as given; without it the frame has none.
[[nodiscard]] BUSBAR_API Result<std::vector<std::byte>>
encode_slmp_answer(const SlmpHead& request, const SlmpOperation& operation,
                   const SlmpAnswer& answer);

/// Reads the whole frame of the answer to `operation`. Bad_DecodingError if it does not fit.
[[nodiscard]] BUSBAR_API Result<SlmpAnswer> decode_slmp_answer(const SlmpOperation& operation,
                                                               const SlmpHead& head,
                                                               std::span<const std::byte> frame);

} // namespace busbar::backend
