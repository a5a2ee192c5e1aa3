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

#include "product/store/source_files.hpp"

namespace busbar::product {

struct ControllerConfig;

/// The parts of a configuration that decide whether a PLC can be created: its program, its image,
/// and [plc]. A trial takes time in proportion to the program; successes are remembered
/// (SourceFiles::tried).
struct PlcTrial {
    explicit PlcTrial(const ControllerConfig& config);

    /// Creates such a PLC and drops it. The problem comes from ProgramImage, from SimulatedLabels,
    /// then with the program's file, or from Plc::create. Thread-safe.
    [[nodiscard]] Configured<void> run() const;

    friend bool operator==(const PlcTrial&, const PlcTrial&) = default;

    /// The program of a machine; may be null.
    std::shared_ptr<const controller::CheckedProgram> program;
    ProgramReading reading;
    controller::PublishingLimits publishing;
    controller::ElementaryTypes elementary;
    /// The program of labels, which may be null, and its file.
    std::shared_ptr<const controller::Program> labels;
    std::string labels_file;
    ProgramReading label_reading;
    controller::SimulatedLabelsOptions label_options;
    controller::PlcConfig plc;
    server::ImageOptions image;
};

} // namespace busbar::product
