#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/backend/label.hpp>
#include <busbar/core/date_time.hpp>

namespace busbar::controller::detail {

// Two functions copy a label's value between a program's memory, laid out as an image lays it out,
// and the bytes of a request. Neither allocates; `wire` has backend::size_of(kind) bytes.

/// Reads a label. TIMEs are rounded to milliseconds and limited to 32 bits; zeros follow a text.
void load_label(const backend::LabelKind& kind, const std::byte* memory, std::byte* wire);
/// Writes a label. Any bit but 0 is 1. A text ends before its first zero, or fills its place.
void store_label(const backend::LabelKind& kind, std::byte* memory, const std::byte* wire);

/// A value of a request and its place in a program's memory.
struct LabelStep {
    std::byte* memory;
    backend::LabelKind kind;
    /// Offset in the request's bytes.
    std::uint32_t offset;
    /// Number of words, or one for a bit.
    std::uint32_t points;
};

/// The labels that are sampled in each scan, and their newest sample: three buffers, so that the
/// PLC's thread always has one to fill and the server's one to read. Both sides are wait-free.
class LabelSampler {
public:
    /// The offsets in `steps` are below `bytes`.
    LabelSampler(std::vector<LabelStep> steps, std::size_t bytes);
    LabelSampler(const LabelSampler&) = delete;
    LabelSampler& operator=(const LabelSampler&) = delete;

    /// Adds the indices of all steps for this memory to `found`. Any thread may call it.
    void find(const std::byte* memory, std::vector<std::uint32_t>& found) const;

    // For the PLC's thread.

    /// Keeps the last sample of these steps until resume() has been called as often.
    void pause(std::span<const std::uint32_t> steps);
    void resume(std::span<const std::uint32_t> steps);
    void sample(std::uint64_t scan, DateTime now);

    // For the server's thread.

    /// See LabelBackend::sampled.
    [[nodiscard]] std::uint64_t newest(std::span<std::byte> bytes, DateTime& time);

private:
    struct Sample {
        std::vector<std::byte> bytes{};
        std::uint64_t scan{0};
        DateTime time{};
    };
    static constexpr unsigned is_new = 4;

    std::vector<LabelStep> steps_;
    /// Indices of steps by the memory that they are for.
    std::vector<std::uint32_t> by_memory_;
    /// Used by the PLC's thread: for each step, the number of Writes it waits for.
    std::vector<std::uint32_t> pauses_;
    /// Used by the PLC's thread.
    std::vector<std::byte> latest_;
    std::array<Sample, 3> samples_;
    /// The buffer that neither side holds, and whether it is newer than the server's.
    std::atomic<unsigned> middle_{1};
    unsigned plc_{0};
    unsigned server_{2};
    bool has_sample_{false};
};

} // namespace busbar::controller::detail
