#include <busbar/harness/recorded_messages.hpp>

#include <array>
#include <map>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/harness/log_book.hpp>

#include "chunks.hpp"
#include "dissector.hpp"
#include "message_fields.hpp"
#include "recorded_exchanges.hpp"
#include "volatile_fields.hpp"

namespace busbar::harness {

namespace {

/// Puts frames together and reads them.
class Assembler {
public:
    void feed(const Recording::Entry& entry)
    {
        if (entry.kind != Recording::Kind::Bytes) {
            return;
        }
        // One dissector for both sides: only the client's OPN says the security of the channel.
        detail::Dissector& dissector = dissectors_[entry.connection];
        dissector.feed(entry.from, entry.bytes);
        while (const auto frame = dissector.take(entry.from)) {
            add(entry, *frame);
        }
    }
    [[nodiscard]] std::vector<detail::WholeRecordedMessage> take()
    {
        return std::exchange(messages_, {});
    }

private:
    void add(const Recording::Entry& entry, const detail::DissectedFrame& frame);

    std::map<std::uint32_t, detail::Dissector> dissectors_;
    std::map<std::pair<std::uint32_t, Side>, std::vector<std::byte>> bodies_;
    std::vector<detail::WholeRecordedMessage> messages_;
    std::size_t count_{0};
};

void Assembler::add(const Recording::Entry& entry, const detail::DissectedFrame& frame)
{
    std::vector<std::byte>& body = bodies_[{entry.connection, entry.from}];
    const auto part = frame.body();
    body.insert(body.end(), part.begin(), part.end());
    if (!frame.is_last) {
        return;
    }
    detail::WholeRecordedMessage& whole = messages_.emplace_back();
    RecordedMessage& message = whole.words;
    message.number = ++count_;
    message.time = entry.time;
    message.connection = entry.connection;
    message.from = entry.from;
    message.name = frame.type_name.empty() ? "bytes" : std::string{frame.type_name};
    const auto offset = frame.sequence_offset();
    if (offset && frame.bytes.size() >= *offset + 8) {
        message.request_id = detail::number_at(frame.bytes, *offset + sizeof(std::uint32_t));
    }
    if (!detail::read_into(message, body) && !frame.structure_name.empty()) {
        message.name = frame.structure_name;
    }
    whole.body = std::exchange(body, {});
}

std::vector<RecordedMessage> words_of(std::vector<detail::WholeRecordedMessage> whole_messages)
{
    std::vector<RecordedMessage> messages;
    for (detail::WholeRecordedMessage& whole : whole_messages) {
        messages.push_back(std::move(whole.words));
    }
    return messages;
}

} // namespace

namespace detail {

bool read_into(RecordedMessage& message, std::span<const std::byte> body)
{
    auto read = read_message(body, DataValues::InParts);
    if (!read) {
        return false;
    }
    message.name = read->name;
    for (MessageField& field : read->fields) {
        message.fields.push_back({std::move(field.path), std::move(field.text)});
    }
    return true;
}

std::vector<WholeRecordedMessage> read_whole_messages(const Recording& recording)
{
    Assembler assembler;
    for (const Recording::Entry& entry : recording.entries) {
        assembler.feed(entry);
    }
    return assembler.take();
}

} // namespace detail

struct MessageReader::Impl {
    Assembler assembler;
};

MessageReader::MessageReader() : impl_{std::make_unique<Impl>()} {}

MessageReader::~MessageReader() = default;

std::vector<RecordedMessage> MessageReader::feed(const Recording::Entry& entry)
{
    impl_->assembler.feed(entry);
    return words_of(impl_->assembler.take());
}

std::vector<RecordedMessage> read_messages(const Recording& recording)
{
    return words_of(detail::read_whole_messages(recording));
}

std::string summary(const RecordedMessage& message)
{
    detail::MessageFields fields{message.name, {}};
    for (const RecordedMessage::Field& field : message.fields) {
        fields.fields.push_back({field.path, field.text});
    }
    return text_of(message.time) + (message.from == Side::Client ? " client -> " : " server -> ") +
           detail::summary_of(fields);
}

std::string write_messages(const std::vector<RecordedMessage>& messages)
{
    detail::Symbols symbols;
    std::string text = "busbar-messages 1\n";
    for (const RecordedMessage& message : messages) {
        text += "\n" + std::to_string(message.connection) +
                (message.from == Side::Client ? " > " : " < ") + message.name + "\n";
        for (const RecordedMessage::Field& field : message.fields) {
            text += "  " + field.path + ": " + printable(symbols.of(field), SIZE_MAX) + "\n";
        }
    }
    return text;
}

} // namespace busbar::harness
