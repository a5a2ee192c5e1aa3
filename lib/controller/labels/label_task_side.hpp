#pragma once

#include <cstdint>
#include <memory>

#include <busbar/controller/simulated_labels.hpp>

#include "label_exchange.hpp"
#include "label_job.hpp"

namespace busbar::controller::detail {

/// What the PLC's thread does at the end of a scan.
class LabelTaskSide {
public:
    LabelTaskSide(LabelExchange& exchange, const SimulatedLabelsOptions& options);

    void end_of_scan(DateTime now);
    void halt(DateTime now);
    [[nodiscard]] LabelProgram& program() { return *program_; }

private:
    /// Takes in what has come: changes at once, requests behind those that wait.
    void accept();
    void change(LabelJob& job);
    void serve(DateTime now);
    /// Goes on with a request; false if there is more of it for the next scan.
    [[nodiscard]] bool advance(LabelJob& job);
    [[nodiscard]] bool access(LabelJob& job);
    /// Answers the first one that waits.
    void finish(DateTime now);
    /// Whether the access unit lets that many more points be accessed in this scan.
    [[nodiscard]] bool take_points(std::uint32_t points);

    LabelExchange* exchange_;
    std::uint32_t access_unit_;
    std::shared_ptr<LabelProgram> program_;
    std::uint64_t generation_;
    LabelJobs waiting_{};
    std::shared_ptr<LabelSampler> sampler_{};
    std::uint64_t scan_{0};
    /// Accessed in this scan.
    std::uint64_t points_{0};
};

} // namespace busbar::controller::detail
