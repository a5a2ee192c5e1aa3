#include <busbar/binary/writer.hpp>

#include <algorithm>
#include <limits>

namespace busbar::binary {

namespace {

constexpr std::uint32_t max_depth = 100; // Part 6, 5.1.5

} // namespace

void Writer::length(std::size_t count)
{
    if (count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
        fail(status::Bad_EncodingLimitsExceeded);
        return;
    }
    number(static_cast<std::int32_t>(count));
}

bool Writer::enter()
{
    if (depth_ > max_depth) { // the outermost one is nested in nothing
        fail(status::Bad_EncodingLimitsExceeded);
        return false;
    }
    ++depth_;
    return ok();
}

void Writer::slow(std::span<const std::byte> data)
{
    while (ok() && !data.empty()) {
        const std::size_t part = std::min(data.size(), static_cast<std::size_t>(end_ - position_));
        if (part != 0) {
            std::memcpy(position_, data.data(), part);
            position_ += part;
            data = data.subspan(part);
            continue;
        }
        before_ += filled();
        const std::span<std::byte> block = sink_->next();
        begin_ = position_ = block.data();
        end_ = begin_ + block.size();
        if (block.empty()) {
            fail(sink_->status());
        }
    }
}

std::span<std::byte> VectorSink::next()
{
    constexpr std::size_t smallest_block = 256;
    const std::size_t filled = bytes_.size();
    const std::size_t wanted = filled + std::max(filled, smallest_block);
    bytes_.resize(std::min(wanted, std::max(limit_, filled)));
    return std::span{bytes_}.subspan(filled);
}

std::vector<std::byte> VectorSink::take(std::size_t size)
{
    bytes_.resize(size);
    return std::exchange(bytes_, {});
}

} // namespace busbar::binary
