#include "label_sampler.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

namespace busbar::controller::detail {

LabelSampler::LabelSampler(std::vector<LabelStep> steps, std::size_t bytes)
    : steps_{std::move(steps)}, by_memory_(steps_.size()), pauses_(steps_.size()), latest_(bytes)
{
    std::iota(by_memory_.begin(), by_memory_.end(), 0U);
    std::ranges::sort(by_memory_, std::less<const std::byte*>{},
                      [this](std::uint32_t step) { return steps_[step].memory; });
    for (Sample& sample : samples_) {
        sample.bytes.resize(bytes);
    }
}

void LabelSampler::find(const std::byte* memory, std::vector<std::uint32_t>& found) const
{
    auto step = std::ranges::lower_bound(
        by_memory_, memory, std::less<const std::byte*>{},
        [this](std::uint32_t one) -> const std::byte* { return steps_[one].memory; });
    for (; step != by_memory_.end() && steps_[*step].memory == memory; ++step) {
        found.push_back(*step);
    }
}

void LabelSampler::pause(std::span<const std::uint32_t> steps)
{
    for (const std::uint32_t step : steps) {
        ++pauses_[step];
    }
}

void LabelSampler::resume(std::span<const std::uint32_t> steps)
{
    for (const std::uint32_t step : steps) {
        --pauses_[step];
    }
}

void LabelSampler::sample(std::uint64_t scan, DateTime now)
{
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        // A step without a sample yet has nothing to keep.
        if (pauses_[i] == 0 || !has_sample_) {
            load_label(steps_[i].kind, steps_[i].memory, latest_.data() + steps_[i].offset);
        }
    }
    has_sample_ = true;
    Sample& filled = samples_[plc_];
    std::ranges::copy(latest_, filled.bytes.begin());
    filled.scan = scan;
    filled.time = now;
    plc_ = middle_.exchange(plc_ | is_new, std::memory_order_acq_rel) & ~is_new;
}

std::uint64_t LabelSampler::newest(std::span<std::byte> bytes, DateTime& time)
{
    if ((middle_.load(std::memory_order_relaxed) & is_new) != 0) {
        server_ = middle_.exchange(server_, std::memory_order_acq_rel) & ~is_new;
    }
    const Sample& sample = samples_[server_];
    if (sample.scan == 0 || bytes.size() != sample.bytes.size()) {
        return 0;
    }
    std::ranges::copy(sample.bytes, bytes.begin());
    time = sample.time;
    return sample.scan;
}

} // namespace busbar::controller::detail
