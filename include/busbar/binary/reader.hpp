#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/binary/wire_order.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/large_memory.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/string.hpp>

namespace busbar::binary {

class TypeRegistry;

/// Limits of a decoder beyond the specification's own. Every limit is finite.
struct DecodeLimits {
    std::uint32_t max_string_length{1U << 20U};
    std::uint32_t max_byte_string_length{4U << 20U};
    std::uint32_t max_array_length{65'536};
    /// Nesting levels of Variant, ExtensionObject and DataValue (Part 6, 5.1.8).
    std::uint32_t max_depth{100};
    /// Levels of DiagnosticInfo (Part 6, 5.2.2.12).
    std::uint32_t max_diagnostic_depth{10};
    /// Limits the memory of decoded arrays and structures, so that many one-byte elements cannot
    /// take too much: bytes of C++ objects for each byte of input, and bytes that are free in
    /// addition.
    std::uint32_t max_expansion{8};
    std::uint32_t free_memory{64U << 10U};
};

/// Whether decoded strings own their bytes or point into the message (see detail::Blob).
enum class Strings : std::uint8_t { Own, Borrow };

/// Reads little-endian primitives out of one message (Part 6, 5.2).
///
/// Sticky: past the end, or after fail(), it yields zeros and keeps the first status, so that a
/// structure is checked once. It never reads past its input. The input must outlive everything that
/// was decoded with Strings::Borrow.
class BUSBAR_API Reader {
public:
    explicit Reader(std::span<const std::byte> input, Strings strings = Strings::Own,
                    const TypeRegistry* types = nullptr, const DecodeLimits& limits = {});

    [[nodiscard]] bool ok() const { return status_.is_good(); }
    [[nodiscard]] StatusCode status() const { return status_; }
    /// Good, or the status as an error.
    [[nodiscard]] Result<void> result() const;
    /// Ends the reading with this status, unless it has failed before.
    void fail(StatusCode status)
    {
        if (ok()) {
            status_ = status;
        }
        position_ = end_;
    }
    [[nodiscard]] std::size_t remaining() const
    {
        return static_cast<std::size_t>(end_ - position_);
    }
    /// Bytes consumed so far.
    [[nodiscard]] std::size_t offset() const
    {
        return static_cast<std::size_t>(position_ - begin_);
    }
    [[nodiscard]] const DecodeLimits& limits() const { return limits_; }
    [[nodiscard]] const TypeRegistry* types() const { return types_; }
    [[nodiscard]] Strings strings() const { return strings_; }
    /// Large arrays take their memory from `memory` from now on; null, as at first, is the heap.
    void keep_memory_in(busbar::detail::KeptMemory* memory) { memory_ = memory; }
    /// Returns the memory of large arrays; null is the heap.
    [[nodiscard]] busbar::detail::KeptMemory* kept_memory() const { return memory_; }

    /// An integer, enumeration or floating-point number; 0 and failed past the end.
    template <busbar::detail::WireNumber T>
    [[nodiscard]] T number()
    {
        T value{};
        if (remaining() < sizeof(T)) {
            fail(status::Bad_DecodingError);
            return value;
        }
        detail::copy_number<sizeof(T)>(&value, position_);
        position_ += sizeof(T);
        return value;
    }
    /// The next `size` bytes in place; none, and failed, past the end.
    [[nodiscard]] std::span<const std::byte> bytes(std::size_t size)
    {
        if (remaining() < size) {
            fail(status::Bad_DecodingError);
            return {};
        }
        const std::span<const std::byte> result{position_, size};
        position_ += size;
        return result;
    }
    /// Fills `values` with numbers.
    template <busbar::detail::WireNumber T>
    void numbers(std::span<T> values)
    {
        const auto from = bytes(values.size_bytes());
        detail::copy_numbers<sizeof(T)>(values.data(), from.data(), from.size() / sizeof(T));
    }
    /// Passes over `size` bytes.
    void skip(std::size_t size) { static_cast<void>(bytes(size)); }

    /// Reads the count of an array whose elements take at least `min_element_size` bytes on the
    /// wire and `object_size` bytes as C++ objects; -1 for null. Checks it against the remaining
    /// bytes and the limits before anything is allocated.
    [[nodiscard]] std::int32_t array_length(std::size_t min_element_size, std::size_t object_size);
    /// Reads the length of a String or ByteString and checks it against `limit` and the remaining
    /// bytes; -1 for null.
    [[nodiscard]] std::int32_t text_length(std::uint32_t limit)
    {
        const auto length = number<std::int32_t>();
        const auto size = static_cast<std::size_t>(length);
        const bool is_fine = length >= 0 && size <= limit && size <= remaining();
        return is_fine || length == -1 ? length : refuse_text(length, limit);
    }
    /// Charges `bytes` of C++ objects to the message. False, with Bad_EncodingLimitsExceeded, if
    /// the message is too small for them.
    [[nodiscard]] bool charge(std::uint64_t bytes);
    /// Bytes of C++ objects that were charged so far, an upper bound of what the decoded values
    /// take.
    [[nodiscard]] std::size_t charged() const { return earned_ - budget_; }

    /// Enters a nested value. False if it is too deep, which fails the Reader with
    /// Bad_EncodingLimitsExceeded.
    [[nodiscard]] bool enter();
    void leave() { --depth_; }
    [[nodiscard]] bool enter_diagnostic();
    void leave_diagnostic() { --diagnostic_depth_; }

    /// Restricts reading to the next `size` bytes. Returns the argument for close_window.
    [[nodiscard]] const std::byte* open_window(std::size_t size);
    /// Skips the rest of the window and continues after it.
    void close_window(const std::byte* outer_end);

private:
    /// Fails with the reason why the length is wrong; returns -1.
    std::int32_t refuse_text(std::int32_t length, std::uint32_t limit);

    const std::byte* begin_;
    const std::byte* position_;
    const std::byte* end_;
    const TypeRegistry* types_;
    busbar::detail::KeptMemory* memory_{nullptr};
    DecodeLimits limits_;
    /// The bytes of C++ objects that the input allows, and the rest of them.
    std::size_t earned_;
    std::size_t budget_;
    std::uint32_t depth_{0};
    std::uint32_t diagnostic_depth_{0};
    Strings strings_;
    StatusCode status_;
};

} // namespace busbar::binary
