#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/backend/modbus_pdu.hpp>

/// Bytes of Modbus, where the high byte of a number comes first (MODBUS Application Protocol, 4.2).
namespace busbar::backend::detail {

/// The parts of a function's requests.
struct ModbusForm {
    ModbusFunction function;
    bool has_bits;
    /// Maximum number of items to read and to write; 0: none.
    std::size_t max_read;
    std::size_t max_write;
    /// Exactly one item is written, and there is no quantity.
    bool is_single;
};

/// Returns the form of a function; null if it is unknown.
[[nodiscard]] const ModbusForm* modbus_form(std::uint8_t function);

/// Bit of a response's function code that says that it is an exception.
inline constexpr std::uint8_t exception_bit = 0x80;
/// MEI type of the identification (6.21).
inline constexpr std::uint8_t identification_mei = 14;
/// Value of a coil that is on in function 5 (6.5).
inline constexpr std::uint16_t coil_on = 0xFF00;
/// The first item that does not exist.
inline constexpr std::size_t end_of_modbus_items = 0x1'0000;

/// Appends to a vector, whose bytes so far it does not change.
class ModbusWriter {
public:
    explicit ModbusWriter(std::vector<std::byte>& out) : out_{out}, begin_{out.size()} {}

    void byte(std::size_t value) { out_.push_back(static_cast<std::byte>(value)); }
    void word(std::size_t value)
    {
        byte(value >> 8U);
        byte(value & 0xFFU);
    }
    void words(std::span<const std::uint16_t> values)
    {
        for (const std::uint16_t value : values) {
            word(value);
        }
    }
    /// The first value is the lowest bit of the first byte; unused bits are 0 (6.1).
    void bits(std::span<const std::uint16_t> values)
    {
        const std::size_t begin = out_.size();
        out_.resize(begin + (values.size() + 7) / 8);
        for (std::size_t i = 0; i < values.size(); ++i) {
            out_[begin + i / 8] |= static_cast<std::byte>((values[i] != 0 ? 1U : 0U) << i % 8);
        }
    }
    void text(std::string_view value)
    {
        const auto bytes = std::as_bytes(std::span{value});
        out_.insert(out_.end(), bytes.begin(), bytes.end());
    }
    /// Replaces a byte that was appended, counted from the first one.
    void replace(std::size_t at, std::size_t value)
    {
        out_[begin_ + at] = static_cast<std::byte>(value);
    }
    [[nodiscard]] std::size_t size() const { return out_.size() - begin_; }

private:
    std::vector<std::byte>& out_;
    std::size_t begin_;
};

/// Reads from front to back. Past the end it fails and yields zeros.
class ModbusReader {
public:
    explicit ModbusReader(std::span<const std::byte> bytes) : bytes_{bytes} {}

    [[nodiscard]] std::uint8_t byte()
    {
        if (bytes_.empty()) {
            has_failed_ = true;
            return 0;
        }
        const auto value = std::to_integer<std::uint8_t>(bytes_.front());
        bytes_ = bytes_.subspan(1);
        return value;
    }
    [[nodiscard]] std::uint16_t word()
    {
        const unsigned high = byte();
        const unsigned low = byte();
        return static_cast<std::uint16_t>(high << 8U | low);
    }
    [[nodiscard]] std::vector<std::uint16_t> words(std::size_t count)
    {
        std::vector<std::uint16_t> values;
        if (has(count * 2)) {
            values.reserve(count);
            for (std::size_t i = 0; i < count; ++i) {
                values.push_back(word());
            }
        }
        return values;
    }
    [[nodiscard]] std::vector<std::uint16_t> bits(std::size_t count)
    {
        std::vector<std::uint16_t> values;
        const std::size_t size = (count + 7) / 8;
        if (has(size)) {
            values.reserve(count);
            for (std::size_t i = 0; i < count; ++i) {
                values.push_back((std::to_integer<unsigned>(bytes_[i / 8]) >> i % 8 & 1U) != 0);
            }
            bytes_ = bytes_.subspan(size);
        }
        return values;
    }
    [[nodiscard]] std::string text(std::size_t size)
    {
        std::string value;
        if (has(size)) {
            value.reserve(size);
            for (const std::byte b : bytes_.first(size)) {
                value.push_back(std::to_integer<char>(b));
            }
            bytes_ = bytes_.subspan(size);
        }
        return value;
    }
    [[nodiscard]] std::size_t left() const { return bytes_.size(); }
    /// True if there was enough of everything, and nothing is left.
    [[nodiscard]] bool is_done() const { return !has_failed_ && bytes_.empty(); }

private:
    [[nodiscard]] bool has(std::size_t size)
    {
        has_failed_ = has_failed_ || size > bytes_.size();
        return !has_failed_;
    }

    std::span<const std::byte> bytes_;
    bool has_failed_{false};
};

} // namespace busbar::backend::detail
