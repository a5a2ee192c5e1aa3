#pragma once

#include <memory>
#include <optional>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/plc_config.hpp>
#include <busbar/controller/program_types.hpp>
#include <busbar/controller/publishing_limits.hpp>
#include <busbar/controller/simulated_labels.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/process_image.hpp>

namespace busbar::product {

struct ControllerConfig;

/// Everything of a configuration that decides whether there can be such a PLC: its program, its
/// image, and what [plc] adds. To try that takes time with the program, so that what went well once
/// is remembered (SourceFiles::tried).
struct PlcTrial {
    explicit PlcTrial(const ControllerConfig& config);

    /// Makes such a PLC and drops it. The problem is that of ProgramImage, of SimulatedLabels, then
    /// with the program's file, or of Plc::create. Any thread.
    [[nodiscard]] Configured<void> run() const;

    friend bool operator==(const PlcTrial&, const PlcTrial&) = default;

    /// Of a machine, which may be null.
    std::shared_ptr<const controller::CheckedProgram> program;
    controller::PublishingLimits publishing;
    controller::ElementaryTypes elementary;
    /// Of labels, which may be null, and its file.
    std::shared_ptr<const controller::Program> labels;
    std::string labels_file;
    controller::SimulatedLabelsOptions label_options;
    controller::PlcConfig plc;
    server::ImageOptions image;
};

} // namespace busbar::product
