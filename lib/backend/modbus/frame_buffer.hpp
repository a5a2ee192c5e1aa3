#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include <busbar/backend/modbus_pdu.hpp>

namespace busbar::backend::detail {

/// Collects the bytes of one frame at a time, so that a connection never holds more of its peer's.
class ModbusFrameBuffer {
public:
    struct Frame {
        ModbusHeader header{};
        /// Valid until drop_frame().
        std::span<const std::byte> pdu{};
    };

    /// Takes the bytes that the present header, or what it announces, still needs and returns their
    /// number; 0 only if `in` is empty or a frame is complete.
    std::size_t take(std::span<const std::byte> in)
    {
        const std::size_t count = std::min(in.size(), needed_ - size_);
        std::copy_n(in.begin(), count, bytes_.begin() + static_cast<std::ptrdiff_t>(size_));
        size_ += count;
        return count;
    }

    /// Returns the frame if it is complete. Bad_DecodingError if the bytes are no header: then no
    /// frame follows any more. Call it after each take().
    [[nodiscard]] Result<std::optional<Frame>> frame()
    {
        const std::span<const std::byte> all = std::span{bytes_}.first(size_);
        const auto header = parse_modbus_header(all);
        if (!header) {
            return fail(header.error());
        }
        if (*header) {
            needed_ = modbus_header_size + (*header)->pdu_size;
        }
        if (!*header || size_ < needed_) {
            return std::optional<Frame>{};
        }
        return std::optional{Frame{**header, all.subspan(modbus_header_size)}};
    }

    void drop_frame()
    {
        size_ = 0;
        needed_ = modbus_header_size;
    }

private:
    std::array<std::byte, modbus_header_size + max_modbus_pdu_size> bytes_{};
    std::size_t size_{0};
    std::size_t needed_{modbus_header_size};
};

} // namespace busbar::backend::detail
