#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/simulated_labels.hpp>

#include "label_exchange.hpp"
#include "label_table.hpp"

namespace busbar::controller::detail {

/// The server thread's part: checks and prepares requests so that the PLC's thread only has to
/// copy.
class LabelServerSide {
public:
    LabelServerSide(LabelExchange& exchange, const SimulatedLabelsOptions& options);

    void start(std::unique_ptr<backend::LabelRequest> request);
    void attach(backend::LabelListener* listener);
    [[nodiscard]] std::uint64_t sampled(std::span<std::byte> bytes, DateTime& time);

private:
    /// Adopts a program that has replaced another.
    void follow_program();
    void prepare(LabelJob& job);
    void prepare_access(LabelJob& job);
    void prepare_sample(LabelJob& job);
    [[nodiscard]] backend::LabelStatus sample_refusal(const backend::LabelRequest& request,
                                                      std::span<const LabelStep> steps) const;
    /// False, with nothing given, if the PLC is halted.
    [[nodiscard]] bool give(std::unique_ptr<LabelJob>& job);
    void answer(LabelJob& job, backend::LabelStatus status);

    LabelExchange* exchange_;
    SimulatedLabelsOptions options_;
    std::unique_ptr<LabelTable> table_;
    /// The sampler requested last; null if nothing is sampled.
    std::shared_ptr<LabelSampler> sampler_{};
};

} // namespace busbar::controller::detail
