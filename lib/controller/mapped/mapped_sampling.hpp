#pragma once

#include <vector>

#include "mapped_operation.hpp"

namespace busbar::controller::detail {

/// The Variables whose labels the PLC samples in each scan (8.3, Processing when using high-speed
/// sampling).
class MappedSampling {
public:
    enum class State : std::uint8_t {
        Off,      // nothing is sampled, or the state is unknown
        Changing, // the PLC was asked to change what it samples
        On,
        Failed, // the PLC cannot
    };

    [[nodiscard]] State state() const { return state_; }
    /// Tells whether batches of this kind are answered with sampled values.
    [[nodiscard]] static bool serves(SamplingMode mode, bool is_sample)
    {
        return mode == SamplingMode::AllVariables ||
               (mode == SamplingMode::MonitoredItems && is_sample);
    }

    /// Makes the request to sample the Variables that are wanted now; null if nothing is or was
    /// sampled. No samples are used until it is answered.
    [[nodiscard]] std::unique_ptr<backend::LabelRequest> change(MappedContext& context);
    /// Processes the answer to change().
    void changed(MappedContext& context, const backend::LabelRequest& request);
    void stop() { state_ = State::Off; }

    /// Answers the batch from the newest scan. False, with nothing done, if there is none or one of
    /// the Variables is not sampled.
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
    /// Measured between the scans that were seen.
    Duration scan_interval_{0};
};

} // namespace busbar::controller::detail
