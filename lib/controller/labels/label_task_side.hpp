#pragma once

#include <cstdint>
#include <memory>

#include <busbar/controller/simulated_labels.hpp>

#include "label_exchange.hpp"
#include "label_job.hpp"

namespace busbar::controller::detail {

/// The PLC thread's part, which runs at the end of a scan.
class LabelTaskSide {
public:
    LabelTaskSide(LabelExchange& exchange, const SimulatedLabelsOptions& options);

    void end_of_scan(DateTime now);
    void halt(DateTime now);
    [[nodiscard]] LabelProgram& program() { return *program_; }

private:
    /// Takes new jobs: carries out changes at once and queues requests after the waiting ones.
    void accept();
    void change(LabelJob& job);
    void serve(DateTime now);
    /// Continues a request; false if a part of it is left for the next scan.
    [[nodiscard]] bool advance(LabelJob& job);
    [[nodiscard]] bool access(LabelJob& job);
    /// Answers the oldest waiting request.
    void finish(DateTime now);
    /// Tells whether the access unit has room for that many more points in this scan.
    [[nodiscard]] bool take_points(std::uint32_t points);

    LabelExchange* exchange_;
    std::uint32_t access_unit_;
    std::shared_ptr<LabelProgram> program_;
    std::uint64_t generation_;
    LabelJobs waiting_{};
    std::shared_ptr<LabelSampler> sampler_{};
    std::uint64_t scan_{0};
    /// Number of points accessed in this scan.
    std::uint64_t points_{0};
};

} // namespace busbar::controller::detail
