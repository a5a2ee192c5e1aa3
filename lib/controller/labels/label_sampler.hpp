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

/// One value of a request and where it lies in a program's memory.
struct LabelStep {
    std::byte* memory;
    backend::LabelKind kind;
    /// In the request's bytes.
    std::uint32_t offset;
    /// Words, or one for a bit.
    std::uint32_t points;
};

/// The labels that are sampled in each scan, and their newest sample: three buffers, so that the
/// PLC's thread always has one to fill and the server's one to read. Both sides are wait-free.
class LabelSampler {
public:
    /// `bytes` is what the steps' offsets are in.
    LabelSampler(std::vector<LabelStep> steps, std::size_t bytes);
    LabelSampler(const LabelSampler&) = delete;
    LabelSampler& operator=(const LabelSampler&) = delete;

    /// The indices of the steps for what lies there are added to `found`. For any thread.
    void find(const std::byte* memory, std::vector<std::uint32_t>& found) const;

    // For the PLC's thread.

    /// The steps of these indices keep what was sampled last, until resume() was called as often.
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
    /// The PLC's: for each step, how many Writes it waits for.
    std::vector<std::uint32_t> pauses_;
    /// The PLC's.
    std::vector<std::byte> latest_;
    std::array<Sample, 3> samples_;
    /// The one that neither side has, and whether it is newer than the server's.
    std::atomic<unsigned> middle_{1};
    unsigned plc_{0};
    unsigned server_{2};
    bool has_sample_{false};
};

} // namespace busbar::controller::detail
