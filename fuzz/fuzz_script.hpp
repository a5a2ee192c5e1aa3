#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

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

} // namespace busbar::fuzz
