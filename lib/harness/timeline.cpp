#include "timeline.hpp"

#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/harness/log_book.hpp>
#include <busbar/harness/text.hpp>

#include "message_fields.hpp"

namespace busbar::harness::detail {

namespace {

using channel::detail::MessageType;

/// ERR (Part 6, 7.1.2.5): a status and a reason.
std::string error_text(std::span<const std::byte> frame)
{
    binary::Reader reader{frame};
    reader.skip(channel::detail::header_size);
    StatusCode status;
    String reason;
    decode(reader, status);
    decode(reader, reason);
    return reader.ok() ? " " + harness::text_of(status) + " " + printable(reason.view()) : "";
}

std::string frame_text(const DissectedFrame& frame)
{
    if (frame.type_name.empty()) {
        return "bytes that are not a message";
    }
    std::string text{frame.type_name};
    if (frame.type == MessageType::ERR) {
        return text + error_text(frame.bytes);
    }
    if (frame.type != MessageType::MSG) {
        return text;
    }
    const auto body = frame.body();
    if (!frame.is_plain && body.empty()) {
        return text + ", encrypted or signed";
    }
    if (const auto message = read_message(body)) {
        return summary_of(*message);
    }
    return frame.structure_name.empty() ? text : std::string{frame.structure_name};
}

} // namespace

Timeline::Entry& Timeline::next()
{
    if (entries_.size() < max_entries) {
        entries_.emplace_back();
    }
    Entry& entry = entries_[count_++ % max_entries];
    entry.time = scheduler_->now();
    entry.what.clear();
    return entry;
}

void Timeline::name_client(std::size_t connection, std::string_view name)
{
    // As many as there are lines, which is enough for all but a crowd.
    while (client_names_.size() >= max_entries) {
        client_names_.erase(client_names_.begin());
    }
    client_names_.insert_or_assign(connection, std::string{name});
}

void Timeline::sent(std::size_t connection, Side from, const DissectedFrame& frame)
{
    connections_ = std::max(connections_, connection);
    Entry& entry = next();
    entry.connection = connection;
    entry.from = from;
    const auto keep = [](std::vector<std::byte>& to, std::span<const std::byte> from_bytes) {
        const auto kept = from_bytes.first(std::min(from_bytes.size(), max_bytes));
        to.assign(kept.begin(), kept.end());
    };
    keep(entry.frame.bytes, frame.bytes);
    keep(entry.frame.opened, frame.opened);
    entry.frame.type = frame.type;
    entry.frame.type_name = frame.type_name;
    entry.frame.structure_name = frame.structure_name;
    entry.frame.is_plain = frame.is_plain;
}

void Timeline::happened(std::size_t connection, std::string_view what)
{
    Entry& entry = next();
    entry.connection = connection;
    entry.what = what;
}

std::string Timeline::text_of(const Entry& entry) const
{
    std::string text = harness::text_of(entry.time.time_since_epoch());
    if (connections_ > 1 && entry.connection != 0) {
        text += " [" + std::to_string(entry.connection) + "]";
    }
    if (!entry.what.empty()) {
        return text + " network: " + entry.what + "\n";
    }
    const auto name = client_names_.find(entry.connection);
    const std::string client = name == client_names_.end() ? "client" : name->second;
    return text + " " + (entry.from == Side::Client ? client : "server") + " -> " +
           frame_text(entry.frame) + "\n";
}

std::string Timeline::last(std::size_t lines) const
{
    const std::size_t known = std::min(entries_.size(), lines);
    std::string text;
    for (std::size_t i = count_ - known; i < count_; ++i) {
        text += text_of(entries_[i % max_entries]);
    }
    return text;
}

} // namespace busbar::harness::detail
