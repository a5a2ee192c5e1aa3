#include "whole_message.hpp"

#include <algorithm>
#include <iterator>

#include "chunks.hpp"

namespace busbar::harness::detail {

namespace {

constexpr std::size_t headers_size =
    channel::detail::symmetric_header_size + channel::detail::sequence_header_size;

/// The number of chunks that have sequence numbers which may be changed.
std::uint32_t numbered(std::span<const DissectedFrame> chunks)
{
    return static_cast<std::uint32_t>(
        std::count_if(chunks.begin(), chunks.end(), [](const DissectedFrame& chunk) {
            return chunk.sequence_offset().has_value();
        }));
}

/// Returns a chunk with the headers of `model`.
DissectedFrame chunk_of(const DissectedFrame& model, std::span<const std::byte> body, bool is_last)
{
    DissectedFrame chunk = model;
    chunk.bytes.resize(headers_size);
    chunk.bytes.insert(chunk.bytes.end(), body.begin(), body.end());
    chunk.bytes[flag_offset] = static_cast<std::byte>(is_last ? 'F' : 'C');
    set_number(chunk.bytes, size_offset, static_cast<std::uint32_t>(chunk.bytes.size()));
    chunk.is_last = is_last;
    return chunk;
}

} // namespace

std::uint32_t WholeMessage::drop()
{
    return 0 - numbered(take());
}

std::uint32_t WholeMessage::duplicate()
{
    const auto copy = chunks_;
    const auto offset = copy.front().sequence_offset();
    chunks_.insert(chunks_.end(), copy.begin(), copy.end());
    if (offset) {
        number_from(number_at(copy.front().bytes, *offset));
    }
    return numbered(copy);
}

std::uint32_t WholeMessage::change(const Fault::Edit& edit, std::string& flaw)
{
    if (chunks_.front().body().empty() || !chunks_.front().is_plain) {
        flaw = "only a MSG on a channel with policy None can be changed";
        return 0;
    }
    std::vector<std::byte> body;
    for (const DissectedFrame& chunk : chunks_) {
        const auto part = chunk.body();
        body.insert(body.end(), part.begin(), part.end());
    }
    flaw = edit(body);
    if (!flaw.empty()) {
        return 0;
    }
    const auto earlier = take();
    const bool was_one = earlier.size() == 1;
    const std::size_t most =
        was_one ? std::max<std::size_t>(body.size(), 1) : earlier.front().body().size();
    std::span<const std::byte> rest{body};
    do {
        const auto part = rest.first(std::min(rest.size(), most));
        rest = rest.subspan(part.size());
        chunks_.push_back(chunk_of(earlier.front(), part, rest.empty()));
    } while (!rest.empty());
    number_from(number_at(earlier.front().bytes, sequence_offset));
    return numbered(chunks_) - numbered(earlier);
}

std::uint32_t WholeMessage::wait(std::vector<DissectedFrame>& overtaken)
{
    overtaken = take();
    return 0 - numbered(overtaken);
}

std::uint32_t WholeMessage::overtake(std::vector<DissectedFrame> earlier)
{
    const std::uint32_t more = numbered(earlier);
    const auto offset = chunks_.front().sequence_offset();
    const std::uint32_t first = offset ? number_at(chunks_.front().bytes, *offset) : 0;
    std::move(earlier.begin(), earlier.end(), std::back_inserter(chunks_));
    if (offset) {
        number_from(first);
    }
    return more;
}

void WholeMessage::number_from(std::uint32_t number)
{
    for (DissectedFrame& chunk : chunks_) {
        if (const auto offset = chunk.sequence_offset()) {
            set_number(chunk.bytes, *offset, number++);
        }
    }
}

} // namespace busbar::harness::detail
