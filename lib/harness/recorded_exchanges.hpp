#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/harness/recorded_messages.hpp>

namespace busbar::harness::detail {

/// A message of a recording with its bytes.
struct WholeRecordedMessage {
    RecordedMessage words;
    /// NodeId of the encoding and structure; empty if it has none, or cannot be read.
    std::vector<std::byte> body;
};

[[nodiscard]] std::vector<WholeRecordedMessage> read_whole_messages(const Recording& recording);
/// Puts the name and the fields of a body into the message; false if it cannot be read.
bool read_into(RecordedMessage& message, std::span<const std::byte> body);

/// A request of a recording and its response, which may be missing.
struct RecordedExchange {
    const WholeRecordedMessage* request{nullptr};
    const WholeRecordedMessage* response{nullptr};
};

/// The exchanges of sessions in the order of their requests, without those that make and end a
/// session or look for a server: every client has those of its own.
[[nodiscard]] std::vector<RecordedExchange>
exchanges_of(const std::vector<WholeRecordedMessage>& messages);

/// Returns what tells a request from others of its name: all fields that do not differ from run to
/// run.
[[nodiscard]] std::string content_of(const RecordedMessage& request);

} // namespace busbar::harness::detail
