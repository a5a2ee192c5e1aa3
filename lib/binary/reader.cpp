#include <busbar/binary/reader.hpp>

#include <limits>

namespace busbar::binary {

namespace {

std::size_t budget_for(std::size_t input, const DecodeLimits& limits)
{
    constexpr std::size_t most = std::numeric_limits<std::size_t>::max() / 2;
    const bool is_huge = input > most / (std::uint64_t{limits.max_expansion} + 1);
    return is_huge ? most : limits.free_memory + input * limits.max_expansion;
}

} // namespace

Reader::Reader(std::span<const std::byte> input, Strings strings, const TypeRegistry* types,
               const DecodeLimits& limits)
    : begin_{input.data()}, position_{begin_}, end_{begin_ + input.size()}, types_{types},
      limits_{limits}, earned_{budget_for(input.size(), limits)}, budget_{earned_}, strings_{
                                                                                        strings}
{
}

Result<void> Reader::result() const
{
    if (!ok()) {
        return busbar::fail(status_);
    }
    return {};
}

std::int32_t Reader::array_length(std::size_t min_element_size, std::size_t object_size)
{
    const auto count = number<std::int32_t>();
    if (count < 0) {
        if (count != -1) {
            fail(status::Bad_DecodingError); // Part 6, 5.2.5: only -1 is null
        }
        return -1;
    }
    const auto size = static_cast<std::size_t>(count);
    if (size > limits_.max_array_length) {
        fail(status::Bad_EncodingLimitsExceeded);
    } else if (min_element_size != 0 && size > remaining() / min_element_size) {
        fail(status::Bad_DecodingError);
    } else if (charge(std::uint64_t{size} * object_size)) {
        return count;
    }
    return -1;
}

std::int32_t Reader::refuse_text(std::int32_t length, std::uint32_t limit)
{
    // Part 6, 5.2.2.4: only -1 is null. A length within the limit exceeds the remaining bytes.
    const bool is_too_long = length >= 0 && static_cast<std::size_t>(length) > limit;
    fail(is_too_long ? status::Bad_EncodingLimitsExceeded : status::Bad_DecodingError);
    return -1;
}

bool Reader::charge(std::uint64_t bytes)
{
    if (bytes > budget_) {
        fail(status::Bad_EncodingLimitsExceeded);
        return false;
    }
    budget_ -= static_cast<std::size_t>(bytes);
    return true;
}

bool Reader::enter()
{
    if (depth_ > limits_.max_depth) { // the outermost one is nested in nothing
        fail(status::Bad_EncodingLimitsExceeded);
        return false;
    }
    ++depth_;
    return true;
}

bool Reader::enter_diagnostic()
{
    if (diagnostic_depth_ >= limits_.max_diagnostic_depth) {
        fail(status::Bad_EncodingLimitsExceeded);
        return false;
    }
    ++diagnostic_depth_;
    return true;
}

const std::byte* Reader::open_window(std::size_t size)
{
    const std::byte* outer_end = end_;
    if (size > remaining()) {
        fail(status::Bad_DecodingError);
    } else {
        end_ = position_ + size;
    }
    return outer_end;
}

void Reader::close_window(const std::byte* outer_end)
{
    // After a failure nothing may be read any more, neither inside nor after the window.
    position_ = ok() ? end_ : outer_end;
    end_ = outer_end;
}

} // namespace busbar::binary
