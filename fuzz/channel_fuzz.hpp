#pragma once

#include <cstdint>
#include <span>

#include "support/channel_pair.hpp"

namespace busbar::fuzz {

/// Reads the fuzzer's input as decisions; zeros when it is used up.
class Script {
public:
    explicit Script(std::span<const std::uint8_t> data) : data_{data} {}

    [[nodiscard]] bool is_over() const { return data_.empty(); }
    std::uint8_t byte()
    {
        if (data_.empty()) {
            return 0;
        }
        const std::uint8_t value = data_.front();
        data_ = data_.subspan(1);
        return value;
    }
    std::span<const std::byte> bytes(std::size_t size)
    {
        const auto part = std::as_bytes(data_.first(std::min(size, data_.size())));
        data_ = data_.subspan(part.size());
        return part;
    }

private:
    std::span<const std::uint8_t> data_;
};

/// Lets `script` play both a well-behaved and a hostile client on an open channel: messages are
/// sent as they are, with bytes changed, cut, repeated or replaced by raw input; time passes.
void play(test::ChannelPair& pair, Script& script);

} // namespace busbar::fuzz
