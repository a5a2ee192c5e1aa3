#include "fault_filter.hpp"

#include <algorithm>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/types/common.hpp>

#include "chunks.hpp"
#include "whole_message.hpp"

namespace busbar::harness::detail {

namespace {

void flip(std::span<std::byte> bytes, std::size_t position, unsigned bit)
{
    bytes[std::min(position, bytes.size() - 1)] ^= static_cast<std::byte>(1U << bit);
}

/// For Hold and HalfOpen the side is the affected one, not the sender of the message.
bool is_sender(const Fault& fault, Side from)
{
    return fault.kind == Fault::Kind::Hold || fault.kind == Fault::Kind::HalfOpen || !fault.side ||
           *fault.side == from;
}

/// Returns a MSG chunk of the same channel with a ServiceFault (Part 6, 6.7.2).
std::vector<std::byte> make_fault(std::span<const std::byte> request, std::uint32_t number,
                                  StatusCode status, DateTime now)
{
    binary::Reader reader{request};
    reader.skip(8);
    const auto channel_id = reader.number<std::uint32_t>();
    const auto token_id = reader.number<std::uint32_t>();
    reader.skip(sizeof(std::uint32_t));
    const auto request_id = reader.number<std::uint32_t>();
    NodeId id;
    RequestHeader header;
    decode(reader, id);
    decode(reader, header);

    ServiceFault fault;
    fault.response_header.timestamp = now;
    fault.response_header.request_handle = header.request_handle;
    fault.response_header.service_result = status;
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.bytes(std::as_bytes(std::span{"MSGF", 4}));
    for (const std::uint32_t field : {0U, channel_id, token_id, number, request_id}) {
        writer.number(field);
    }
    encode(writer, NodeId{0, ServiceFault::binary_encoding_id});
    encode(writer, fault);
    auto bytes = sink.take(writer.written());
    set_number(bytes, size_offset, static_cast<std::uint32_t>(bytes.size()));
    return bytes;
}

} // namespace

void FaultFilter::pass(Link& link, Side from, std::span<const std::byte> bytes)
{
    dissector_.feed(from, bytes);
    while (auto frame = dissector_.take(from)) {
        pass(link, from, *std::move(frame));
    }
}

void FaultFilter::pass(Link& link, Side from, DissectedFrame frame)
{
    Stream& stream = streams_[static_cast<std::size_t>(from)];
    renumber(from, frame);
    if (frame.is_first) {
        stream.delay = Duration{0};
        stream.is_swallowed = false;
        faults_->timeline().sent(connection_, from, frame);
        begin_message(link, from, frame);
    }
    const bool is_last = frame.is_last;
    if (stream.is_swallowed) {
        --shift_[static_cast<std::size_t>(from)];
    } else if (!stream.on_message.empty() || !stream.overtaken.empty()) {
        stream.frames.push_back(std::move(frame));
        let_go_of_endless(link, from);
    } else {
        send(link, from, frame.bytes);
    }
    if (is_last) {
        act_on_message(link, from);
        end_message(link, from);
    }
}

/// A message that does not end is not kept.
void FaultFilter::let_go_of_endless(Link& link, Side from)
{
    constexpr std::size_t most = 1'000; // chunks
    Stream& stream = streams_[static_cast<std::size_t>(from)];
    if (stream.frames.size() < most) {
        return;
    }
    faults_->timeline().happened(connection_, "a message is too long for the faults on it");
    stream.on_message.clear();
    for (DissectedFrame& frame : std::exchange(stream.frames, {})) {
        send(link, from, frame.bytes);
    }
    for (DissectedFrame& frame : std::exchange(stream.overtaken, {})) {
        send(link, from, frame.bytes);
    }
}

void FaultFilter::renumber(Side from, DissectedFrame& frame)
{
    const auto offset = frame.sequence_offset();
    if (!offset || frame.bytes.size() < *offset + sizeof(std::uint32_t)) {
        return;
    }
    const std::uint32_t number =
        number_at(frame.bytes, *offset) + shift_[static_cast<std::size_t>(from)];
    set_number(frame.bytes, *offset, number);
    if (from == Side::Server) {
        server_number_ = number;
    }
}

void FaultFilter::begin_message(Link& link, Side from, DissectedFrame& frame)
{
    Stream& stream = streams_[static_cast<std::size_t>(from)];
    auto& entries = faults_->entries();
    stream.matches.resize(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        Entry& entry = entries[i];
        const auto& message = entry.fault.message;
        const bool is_it =
            message && is_sender(entry.fault, from) &&
            (message->name == frame.type_name ||
             (!frame.structure_name.empty() && message->name == frame.structure_name));
        if (!is_it) {
            continue;
        }
        const std::size_t number = ++stream.matches[i];
        // A fault that acts more than once continues with the following messages.
        const bool is_due =
            number == message->number || (entry.fault.count != 1 && number > message->number);
        if (is_due && entry.is_for(connection_)) {
            meet(link, from, frame, entry);
        }
    }
}

void FaultFilter::meet(Link& link, Side from, DissectedFrame& frame, Entry& entry)
{
    Stream& stream = streams_[static_cast<std::size_t>(from)];
    const Fault& fault = entry.fault;
    if (fault.moment == Fault::Moment::After) {
        stream.at_end.push_back(&entry);
        return;
    }
    if (fault.kind == Fault::Kind::Answer && (from == Side::Server || !frame.is_plain)) {
        return;
    }
    if (acts_on_messages(fault.kind)) {
        stream.on_message.push_back(&entry);
        return;
    }
    faults_->count(entry, connection_);
    if (!acts_on_bytes(fault.kind)) {
        faults_->act(fault, link, from);
    } else if (fault.kind == Fault::Kind::Delay) {
        stream.delay += fault.duration;
    } else if (fault.kind == Fault::Kind::Corrupt) {
        flip(frame.bytes, fault.position, fault.bit);
    } else {
        stream.is_swallowed = true;
        answer(link, frame, fault.status);
    }
}

void FaultFilter::act_on_message(Link& link, Side from)
{
    Stream& stream = streams_[static_cast<std::size_t>(from)];
    std::uint32_t& shift = shift_[static_cast<std::size_t>(from)];
    const std::uint32_t shift_before = shift;
    WholeMessage message{std::exchange(stream.frames, {})};
    for (Entry* const entry : std::exchange(stream.on_message, {})) {
        if (message.is_empty() || !entry->is_for(connection_)) {
            continue;
        }
        std::string flaw;
        switch (entry->fault.kind) {
        case Fault::Kind::Drop:
            shift += message.drop();
            break;
        case Fault::Kind::Duplicate:
            shift += message.duplicate();
            break;
        case Fault::Kind::Overtake:
            shift += message.wait(stream.overtaken);
            break;
        default:
            shift += message.change(entry->fault.edit, flaw);
            break;
        }
        if (flaw.empty()) {
            faults_->count(*entry, connection_);
        } else {
            faults_->timeline().happened(connection_, "no " + describe(entry->fault) + ": " + flaw);
        }
    }
    if (!message.is_empty()) {
        shift += message.overtake(std::exchange(stream.overtaken, {}));
    }
    if (from == Side::Server) {
        server_number_ += shift - shift_before;
    }
    for (DissectedFrame& chunk : message.chunks()) {
        send(link, from, chunk.bytes);
    }
}

void FaultFilter::end_message(Link& link, Side from)
{
    for (Entry* const entry : std::exchange(streams_[static_cast<std::size_t>(from)].at_end, {})) {
        if (!acts_on_bytes(entry->fault.kind) && entry->is_for(connection_)) {
            faults_->count(*entry, connection_);
            faults_->act(entry->fault, link, from);
        }
    }
}

FaultFilter::Entry* FaultFilter::next_at_byte(Side from, std::size_t size)
{
    const std::uint64_t sent = streams_[static_cast<std::size_t>(from)].sent;
    Entry* next = nullptr;
    for (Entry& entry : faults_->entries()) {
        const auto& offset = entry.fault.byte_offset;
        if (offset && *offset >= sent && *offset < sent + size && entry.is_for(connection_) &&
            entry.fault.kind != Fault::Kind::Answer &&
            entry.fault.side.value_or(Side::Client) == from &&
            (next == nullptr || *offset < *next->fault.byte_offset)) {
            next = &entry;
        }
    }
    return next;
}

void FaultFilter::send(Link& link, Side from, std::span<std::byte> bytes)
{
    Stream& stream = streams_[static_cast<std::size_t>(from)];
    while (!bytes.empty()) {
        Entry* const entry = next_at_byte(from, bytes.size());
        const std::size_t size =
            entry == nullptr ? bytes.size()
                             : static_cast<std::size_t>(*entry->fault.byte_offset - stream.sent);
        if (size > 0) {
            link.send(from, bytes.first(size), stream.delay);
            stream.sent += size;
            bytes = bytes.subspan(size);
        }
        if (entry == nullptr) {
            return;
        }
        faults_->count(*entry, connection_);
        if (!acts_on_bytes(entry->fault.kind)) {
            faults_->act(entry->fault, link, from);
        } else if (entry->fault.kind == Fault::Kind::Corrupt) {
            flip(bytes, 0, entry->fault.bit);
        } else {
            stream.delay += entry->fault.duration;
        }
        link.send(from, bytes.first(1), stream.delay);
        ++stream.sent;
        bytes = bytes.subspan(1);
    }
}

void FaultFilter::answer(Link& link, const DissectedFrame& request, StatusCode status)
{
    ++shift_[static_cast<std::size_t>(Side::Server)];
    link.send(Side::Server, make_fault(request.bytes, ++server_number_, status, faults_->now()));
}

} // namespace busbar::harness::detail
