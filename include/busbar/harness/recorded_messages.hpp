#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/harness/recording.hpp>

namespace busbar::harness {

/// One message of a recording, in words.
struct BUSBAR_API RecordedMessage {
    /// A value in it: "nodesToRead[0].nodeId" by the names of the specification, and its text,
    /// "ns=1;s=Level".
    struct Field {
        /// The names that lead to it.
        std::string path;
        /// Its value.
        std::string text;

        friend bool operator==(const Field&, const Field&) = default;
    };

    /// Its number in the recording, from 1.
    std::size_t number{0};
    /// When its last byte arrived, since the world began.
    Duration time{0};
    /// The number that the recording gives it.
    std::uint32_t connection{0};
    /// The side that has sent it.
    Side from{Side::Client};
    /// Its structure, "ReadRequest"; its type, "HEL", for those that have none or cannot be read.
    std::string name;
    /// The RequestId, which a response shares with its request; 0 without one.
    std::uint32_t request_id{0};
    /// In wire order. Fields of a DataValue are told apart; those that are null, Good or nothing
    /// are left out.
    std::vector<Field> fields;

    friend bool operator==(const RecordedMessage&, const RecordedMessage&) = default;
};

/// Reads the messages of a recording that grows. Neither copied nor moved.
class BUSBAR_API MessageReader {
public:
    /// Creates one for a recording from its beginning.
    MessageReader();
    ~MessageReader();
    MessageReader(const MessageReader&) = delete;
    MessageReader& operator=(const MessageReader&) = delete;

    /// Takes the next entry of the recording, and returns the messages that it completes.
    [[nodiscard]] std::vector<RecordedMessage> feed(const Recording::Entry& entry);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Returns the messages of a recording in the order in which they arrived. Those on secured
/// channels have only their type, such as "MSG".
[[nodiscard]] BUSBAR_API std::vector<RecordedMessage> read_messages(const Recording& recording);

/// Returns one line about a message: "0.012 s client -> ReadRequest ns=1;s=Level".
[[nodiscard]] BUSBAR_API std::string summary(const RecordedMessage& message);

/// Returns messages as text that tools for texts compare well: a line for each message and, below
/// it, one for each field. What differs from run to run has a symbol: "$token1" for the first
/// authentication token, "$time" for every time, "$nonce".
[[nodiscard]] BUSBAR_API std::string write_messages(const std::vector<RecordedMessage>& messages);

/// Says what compare_messages() looks at.
struct ComparisonOptions {
    /// Times of values and events, too; else no times.
    bool with_times{false};
    /// Numbers that differ by no more are the same.
    double tolerance{0};
    /// At most so many lines; one more says how many are left out.
    std::size_t max_lines{1'000};
};

/// Returns what differs between two recordings of the same thing, one difference a line; empty if
/// nothing does:
///
///     ReadResponse to ns=1;s=Level: results[0].value Double 1.5 -> Double 1.75 (messages 12, 12)
///
/// Requests are compared with each other, whatever came between, and responses as those of their
/// requests. Ids that servers and clients choose may be others as long as they stay the same ones;
/// handles, nonces, signatures, certificates and the servers' URLs are not compared.
[[nodiscard]] BUSBAR_API std::vector<std::string>
compare_messages(const std::vector<RecordedMessage>& before,
                 const std::vector<RecordedMessage>& after, const ComparisonOptions& options = {});

} // namespace busbar::harness
