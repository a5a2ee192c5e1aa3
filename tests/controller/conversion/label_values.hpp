#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/label_conversion.hpp>
#include <busbar/core/types.hpp>

namespace busbar::test {

using backend::LabelKind;
using backend::LabelType;
using backend::TimerPart;

/// A label of `kind` and a value of `leaf`, converted into each other.
class Mapping {
public:
    Mapping(BuiltInType leaf, LabelKind kind, controller::ConversionOptions options = {})
        : Mapping{controller::LeafType{leaf, false}, kind, options}
    {
    }
    Mapping(controller::LeafType leaf, LabelKind kind, controller::ConversionOptions options = {})
        : conversion_{*controller::LabelConversion::of(leaf, kind, options)},
          label(conversion_.label_size(), std::byte{0xEE})
    {
    }

    StatusCode write(const Variant& value)
    {
        return conversion_.write(value, std::span<std::byte>{label});
    }
    [[nodiscard]] Result<Variant> read() const
    {
        return conversion_.read(std::span<const std::byte>{label});
    }
    /// What is read of a label that has these bytes, and zeros behind them.
    [[nodiscard]] Result<Variant> read_of(std::string_view bytes)
    {
        label.assign(label.size(), std::byte{0});
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            label.at(i) = static_cast<std::byte>(bytes[i]);
        }
        return read();
    }
    /// The label's bytes as an unsigned number.
    [[nodiscard]] std::int64_t number() const
    {
        std::int64_t value = 0;
        for (std::size_t i = label.size(); i > 0; --i) {
            value = value << 8 | std::to_integer<std::int64_t>(label[i - 1]);
        }
        return value;
    }
    /// The label's bytes as text.
    [[nodiscard]] std::string bytes() const
    {
        return {reinterpret_cast<const char*>(label.data()), label.size()};
    }

private:
    controller::LabelConversion conversion_;

public:
    std::vector<std::byte> label;
};

/// A number as a label has it: `size` bytes, little endian.
inline std::string number_bytes(std::int64_t value, std::size_t size)
{
    std::string bytes;
    for (std::size_t i = 0; i < size; ++i) {
        bytes += static_cast<char>(value >> (8 * i) & 0xFF);
    }
    return bytes;
}

} // namespace busbar::test
