#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include <busbar/binary/wire_order.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar::binary {

/// Supplies the memory blocks that a Writer fills, such as the bodies of a message's chunks.
class BUSBAR_API Sink {
public:
    Sink() = default;
    Sink(const Sink&) = delete;
    Sink& operator=(const Sink&) = delete;
    virtual ~Sink() = default;

    /// Takes the last block back, which the Writer has filled, and returns the next one. An empty
    /// block means that there are no more, and fails the Writer with `status()`.
    [[nodiscard]] virtual std::span<std::byte> next() = 0;
    /// The reason why next() returned nothing.
    [[nodiscard]] virtual StatusCode status() const = 0;
};

/// Writes little-endian primitives into the blocks of a Sink (Part 6, 5.2).
///
/// Sticky: after a failure it writes nothing and keeps the first status. A value may lie across
/// two blocks. Only this class and Reader touch wire bytes.
class BUSBAR_API Writer {
public:
    explicit Writer(Sink& sink) : sink_{&sink} {}
    /// Constructs a Writer that only counts, as deep in the message as `outer`: it measures a part
    /// before that is written.
    struct Measure {
        const Writer& outer;
    };
    Writer(Sink& sink, Measure measure)
        : sink_{&sink}, depth_{measure.outer.depth_}, is_measuring_{true},
          checks_texts_{measure.outer.checks_texts_}
    {
    }

    [[nodiscard]] bool ok() const { return status_.is_good(); }
    [[nodiscard]] StatusCode status() const { return status_; }
    /// Keeps the first status that is given; it must be bad.
    void fail(StatusCode status)
    {
        if (ok()) {
            status_ = status;
        }
        begin_ = position_ = end_ = nullptr;
    }
    /// Bytes written since construction.
    [[nodiscard]] std::size_t written() const
    {
        return before_ + static_cast<std::size_t>(position_ - begin_);
    }
    /// Number of bytes of the current block that are filled.
    [[nodiscard]] std::size_t filled() const
    {
        return static_cast<std::size_t>(position_ - begin_);
    }

    /// Writes an integer, enumeration or floating-point number.
    template <busbar::detail::WireNumber T>
    void number(T value)
    {
        if (static_cast<std::size_t>(end_ - position_) >= sizeof(T)) {
            detail::copy_number<sizeof(T)>(position_, &value);
            position_ += sizeof(T);
        } else {
            std::array<std::byte, sizeof(T)> on_wire;
            detail::copy_number<sizeof(T)>(on_wire.data(), &value);
            slow(on_wire);
        }
    }
    /// Writes the bytes as they are.
    void bytes(std::span<const std::byte> data)
    {
        if (static_cast<std::size_t>(end_ - position_) >= data.size()) {
            if (!data.empty()) {
                std::memcpy(position_, data.data(), data.size());
                position_ += data.size();
            }
        } else {
            slow(data);
        }
    }
    /// True for a Writer that only counts and discards its input.
    [[nodiscard]] bool is_measuring() const { return is_measuring_; }
    /// From now on fails with Bad_EncodingError at a text that is not UTF-8 (Part 6, 5.2.2.4).
    void check_texts() { checks_texts_ = true; }
    /// True after check_texts().
    [[nodiscard]] bool checks_texts() const { return checks_texts_; }
    /// Writes the elements of an array of numbers at once.
    template <busbar::detail::WireNumber T>
    void numbers(std::span<const T> values)
    {
        if constexpr (std::endian::native == std::endian::little || sizeof(T) == 1) {
            bytes(std::as_bytes(values));
        } else {
            for (const T value : values) {
                number(value);
            }
        }
    }
    /// Writes an Int32 count; fails with Bad_EncodingLimitsExceeded past 2^31-1.
    void length(std::size_t count);

    /// Enters a nested value (Part 6, 5.1.5). False if that makes more than 100 levels, which fails
    /// the Writer.
    [[nodiscard]] bool enter();
    void leave() { --depth_; }

private:
    void slow(std::span<const std::byte> data);

    Sink* sink_;
    std::byte* begin_{nullptr};
    std::byte* position_{nullptr};
    std::byte* end_{nullptr};
    std::size_t before_{0};
    std::uint32_t depth_{0};
    bool is_measuring_{false};
    bool checks_texts_{false};
    StatusCode status_;
};

/// Collects the output in a vector of at most `limit` bytes.
class BUSBAR_API VectorSink : public Sink {
public:
    explicit VectorSink(std::size_t limit = SIZE_MAX) : limit_{limit} {}

    [[nodiscard]] std::span<std::byte> next() override;
    [[nodiscard]] StatusCode status() const override { return status::Bad_EncodingLimitsExceeded; }
    /// Takes the first `size` bytes of the output; the sink is empty afterwards.
    [[nodiscard]] std::vector<std::byte> take(std::size_t size);

private:
    std::vector<std::byte> bytes_;
    std::size_t limit_;
};

/// Discards the output; Writer::written() returns its size.
class BUSBAR_API CountingSink : public Sink {
public:
    [[nodiscard]] std::span<std::byte> next() override { return scratch_; }
    [[nodiscard]] StatusCode status() const override { return status::Bad_EncodingLimitsExceeded; }

private:
    std::array<std::byte, 512> scratch_;
};

/// Encodes into one given block and fails with Bad_EncodingLimitsExceeded when it is full.
class BUSBAR_API SpanSink : public Sink {
public:
    explicit SpanSink(std::span<std::byte> block) : block_{block} {}

    [[nodiscard]] std::span<std::byte> next() override
    {
        return std::exchange(block_, std::span<std::byte>{});
    }
    [[nodiscard]] StatusCode status() const override { return status::Bad_EncodingLimitsExceeded; }

private:
    std::span<std::byte> block_;
};

} // namespace busbar::binary
