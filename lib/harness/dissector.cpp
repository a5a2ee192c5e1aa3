#include "dissector.hpp"

#include <array>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/security_policy.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::harness::detail {

namespace {

using channel::detail::MessageType;

constexpr std::array<std::string_view, 7> type_names{"HEL", "ACK", "ERR", "RHE",
                                                     "OPN", "MSG", "CLO"};

bool is_none(std::span<const std::byte> open)
{
    binary::Reader reader{open, binary::Strings::Borrow};
    reader.skip(12); // message header and SecureChannelId
    String uri;
    decode(reader, uri);
    return reader.ok() && uri.view() == crypto::policy_none().uri;
}

/// Returns the structure of namespace 0 with this binary encoding; null if it is unknown.
const StructureType* type_of(const NodeId& encoding_id)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    return types.find(encoding_id);
}

/// Returns the name of the structure in a body; empty if it is unknown.
std::string_view structure_of(std::span<const std::byte> body)
{
    const StructureType* const type = body.empty() ? nullptr : type_of(encoding_of(body));
    return type != nullptr ? type->name : std::string_view{};
}

} // namespace

std::span<const std::byte> DissectedFrame::body() const
{
    constexpr std::size_t header =
        channel::detail::symmetric_header_size + channel::detail::sequence_header_size;
    const std::span<const std::byte> chunk{is_plain ? bytes : opened};
    return type == MessageType::MSG && chunk.size() > header ? chunk.subspan(header)
                                                             : std::span<const std::byte>{};
}

std::optional<std::size_t> DissectedFrame::sequence_offset() const
{
    if (!is_plain) {
        return std::nullopt;
    }
    if (type == MessageType::MSG || type == MessageType::CLO) {
        constexpr std::size_t offset = channel::detail::symmetric_header_size;
        return bytes.size() >= offset + channel::detail::sequence_header_size
                   ? std::optional{offset}
                   : std::nullopt;
    }
    if (type != MessageType::OPN) {
        return std::nullopt;
    }
    // Three strings and byte strings (Part 6, 6.7.2.3).
    binary::Reader reader{bytes, binary::Strings::Borrow};
    reader.skip(12);
    for (int i = 0; i < 3; ++i) {
        const auto size = reader.number<std::int32_t>();
        reader.skip(size > 0 ? static_cast<std::size_t>(size) : 0);
    }
    return reader.ok() && reader.remaining() >= 8 ? std::optional{reader.offset()} : std::nullopt;
}

void Dissector::feed(Side from, std::span<const std::byte> bytes)
{
    Stream& stream = streams_[static_cast<std::size_t>(from)];
    stream.bytes.insert(stream.bytes.end(), bytes.begin(), bytes.end());
}

std::optional<DissectedFrame> Dissector::take(Side from)
{
    Stream& stream = streams_[static_cast<std::size_t>(from)];
    const auto rest = std::span<const std::byte>{stream.bytes}.subspan(stream.begin);
    DissectedFrame frame;
    if (!stream.is_broken && rest.size() >= channel::detail::header_size) {
        const auto header = channel::detail::parse_frame_header(rest, max_frame_size);
        if (header && rest.size() >= header->size) {
            const auto bytes = rest.first(header->size);
            frame.bytes.assign(bytes.begin(), bytes.end());
            stream.begin += header->size;
            frame.type = header->type;
            frame.is_last = header->chunk != 'C';
            describe(stream, frame);
            return frame;
        }
        stream.is_broken = !header;
    }
    if (!stream.is_broken || rest.empty()) {
        stream.bytes.erase(stream.bytes.begin(),
                           stream.bytes.begin() + static_cast<std::ptrdiff_t>(stream.begin));
        stream.begin = 0;
        return std::nullopt;
    }
    frame.bytes.assign(rest.begin(), rest.end());
    stream.bytes.clear();
    stream.begin = 0;
    return frame;
}

void Dissector::describe(Stream& stream, DissectedFrame& frame)
{
    frame.type_name = type_names.at(static_cast<std::size_t>(frame.type));
    if (frame.type == MessageType::OPN) {
        is_plain_ = is_none(frame.bytes);
    }
    frame.is_plain = is_plain_;
    frame.is_first = !stream.is_in_message;
    stream.is_in_message = !frame.is_last;
    if (tap_ != nullptr && !is_plain_) {
        frame.opened = tap_->take(frame.bytes);
    }
    if (frame.is_first) {
        stream.structure_name = structure_of(frame.body());
    }
    frame.structure_name = stream.structure_name;
}

NodeId encoding_of(std::span<const std::byte> body)
{
    binary::Reader reader{body};
    NodeId id;
    decode(reader, id);
    return reader.ok() ? id : NodeId{};
}

std::string encoding_name(const NodeId& encoding_id)
{
    const StructureType* const type = type_of(encoding_id);
    return type != nullptr ? std::string{type->name} : printable(to_string(encoding_id));
}

} // namespace busbar::harness::detail
