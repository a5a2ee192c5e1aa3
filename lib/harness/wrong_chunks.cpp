#include "chunks.hpp"

#include <algorithm>
#include <string_view>

#include <busbar/binary/codec.hpp>

namespace busbar::harness::detail {

namespace {

void put(std::span<std::byte> chunk, std::size_t offset, std::optional<std::uint32_t> number)
{
    if (number) {
        set_number(chunk, offset, *number);
    }
}

/// The body of a chunk that gives its message up (Part 6, 6.7.3).
std::vector<std::byte> abort_body(StatusCode status)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, status);
    encode(writer, String{"as the script says"});
    return sink.take(writer.written());
}

} // namespace

Result<void> WrongChunks::send(const Wrong& wrong, std::span<const std::byte> body,
                               FunctionRef<Result<void>(FunctionRef<void(binary::Writer&)>)> send)
{
    wrong_ = wrong;
    std::vector<std::byte> instead;
    if (wrong.abort) {
        instead = abort_body(*wrong.abort);
        body = instead;
        wrong_.chunk_flag = 'A';
    }
    body = body.first(body.size() - std::min(body.size(), wrong.cut_off));
    Result<void> result;
    for (std::size_t i = 0; i < wrong.copies && result; ++i) {
        is_first_ = true;
        result = send([&](binary::Writer& writer) { writer.bytes(body); });
    }
    wrong_ = {};
    return result;
}

void WrongChunks::sealing(std::span<std::byte> chunk)
{
    if (wrong_.chunk_flag && static_cast<char>(chunk[flag_offset]) == 'F') {
        chunk[flag_offset] = static_cast<std::byte>(*wrong_.chunk_flag);
    }
    token_id_ = number_at(chunk, token_offset);
    put(chunk, channel_offset, wrong_.channel_id);
    put(chunk, token_offset, wrong_.token_id);
    put(chunk, request_offset, wrong_.request_id);
    if (is_first_ && wrong_.sequence != Wrong::Sequence::Right) {
        const std::uint32_t right = number_at(chunk, sequence_offset);
        put(chunk, sequence_offset,
            wrong_.sequence == Wrong::Sequence::Again ? right - 1 : right + 1);
    }
    is_first_ = false;
    next_->sealing(chunk);
}

void WrongChunks::sealed(std::span<std::byte> chunk)
{
    if (wrong_.signature) {
        chunk.back() ^= std::byte{1};
    }
    next_->sealed(chunk);
}

} // namespace busbar::harness::detail
