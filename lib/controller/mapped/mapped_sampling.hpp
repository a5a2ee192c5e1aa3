#pragma once

#include <vector>

#include "mapped_operation.hpp"

namespace busbar::controller::detail {

/// What a PLC samples in each scan (8.3, Processing when using high-speed sampling).
class MappedSampling {
public:
    enum class State : std::uint8_t {
        Off,      // nothing is sampled, or it is not known
        Changing, // the PLC was asked to sample others
        On,
        Failed, // the PLC cannot
    };

    [[nodiscard]] State state() const { return state_; }
    /// Whether batches of this kind get what was sampled.
    [[nodiscard]] static bool serves(SamplingMode mode, bool is_sample)
    {
        return mode == SamplingMode::AllVariables ||
               (mode == SamplingMode::MonitoredItems && is_sample);
    }

    /// The request to sample what is wanted now; null if nothing is and nothing was. Nothing is
    /// sampled until it is answered.
    [[nodiscard]] std::unique_ptr<backend::LabelRequest> change(MappedContext& context);
    /// Its answer.
    void changed(MappedContext& context, const backend::LabelRequest& request);
    void stop() { state_ = State::Off; }

    /// Answers the batch from the newest scan. False, and nothing is done, if there is none, or if
    /// one of the Variables is not sampled.
    [[nodiscard]] bool answer(MappedContext& context, backend::LabelBackend& backend,
                              server::ReadBatch& batch);

private:
    [[nodiscard]] bool look(backend::LabelBackend& backend);
    [[nodiscard]] static bool has_all(MappedContext& context, const server::ReadBatch& batch);

    State state_{State::Off};
    bool has_asked_{false};
    std::size_t size_{0};
    std::vector<std::byte> bytes_;
    std::uint64_t scan_{0};
    DateTime time_;
    /// From scan to scan, as far as they were seen.
    Duration scan_interval_{0};
};

} // namespace busbar::controller::detail
