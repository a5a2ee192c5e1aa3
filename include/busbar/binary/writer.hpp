#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <busbar/core/result.hpp>

namespace busbar::binary {

/// Where a Writer's bytes go: a row of memory blocks, such as the bodies of a message's chunks.
class Sink {
public:
    Sink() = default;
    Sink(const Sink&) = delete;
    Sink& operator=(const Sink&) = delete;
    virtual ~Sink() = default;

    /// Takes back the block given last, of which the Writer has filled everything, and gives the
    /// next; an empty one when there is no more, which fails the Writer with `status()`.
    [[nodiscard]] virtual std::span<std::byte> next() = 0;
    /// Why next() gave nothing.
    [[nodiscard]] virtual StatusCode status() const = 0;
};

/// Writes little-endian primitives into the blocks of a Sink (Part 6, 5.2).
///
/// Sticky: after a failure it writes nothing and keeps the first status. A value may lie across
/// two blocks. Only this class and Reader touch wire bytes.
class Writer {
public:
    explicit Writer(Sink& sink) : sink_{&sink} {}

    [[nodiscard]] bool ok() const { return status_.is_good(); }
    [[nodiscard]] StatusCode status() const { return status_; }
    /// Keeps the first status that is given; it must be bad.
    void fail(StatusCode status)
    {
        if (ok()) {
            status_ = status;
        }
        position_ = end_ = nullptr;
    }
    /// Bytes written since construction.
    [[nodiscard]] std::size_t written() const
    {
        return before_ + static_cast<std::size_t>(position_ - begin_);
    }
    /// How many bytes of the block given last are filled.
    [[nodiscard]] std::size_t filled() const { return static_cast<std::size_t>(position_ - begin_); }

    /// Writes an integer, enumeration or floating-point number as it lies in memory.
    template <typename T>
    void number(T value)
    {
        static_assert(std::endian::native == std::endian::little && std::is_trivially_copyable_v<T>);
        if (static_cast<std::size_t>(end_ - position_) >= sizeof(T)) {
            std::memcpy(position_, &value, sizeof(T));
            position_ += sizeof(T);
        } else {
            slow(&value, sizeof(T));
        }
    }
    void bytes(std::span<const std::byte> data)
    {
        if (static_cast<std::size_t>(end_ - position_) >= data.size()) {
            if (!data.empty()) {
                std::memcpy(position_, data.data(), data.size());
                position_ += data.size();
            }
        } else {
            slow(data.data(), data.size());
        }
    }
    /// An Int32 count; fails with Bad_EncodingLimitsExceeded past 2^31-1.
    void length(std::size_t count);

    /// Enters a nested value (Part 6, 5.1.5); false, and failed, past 100 levels.
    [[nodiscard]] bool enter();
    void leave() { --depth_; }

private:
    void slow(const void* data, std::size_t size);

    Sink* sink_;
    std::byte* begin_{nullptr};
    std::byte* position_{nullptr};
    std::byte* end_{nullptr};
    std::size_t before_{0};
    std::uint32_t depth_{0};
    StatusCode status_;
};

/// Collects what is written in a vector of at most `limit` bytes.
class VectorSink : public Sink {
public:
    explicit VectorSink(std::size_t limit = SIZE_MAX) : limit_{limit} {}

    [[nodiscard]] std::span<std::byte> next() override;
    [[nodiscard]] StatusCode status() const override { return status::Bad_EncodingLimitsExceeded; }
    /// The first `size` bytes that were written; the sink is empty afterwards.
    [[nodiscard]] std::vector<std::byte> take(std::size_t size);

private:
    std::vector<std::byte> bytes_;
    std::size_t limit_;
};

/// Encodes into one given block and fails with Bad_EncodingLimitsExceeded when it is full.
class SpanSink : public Sink {
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
