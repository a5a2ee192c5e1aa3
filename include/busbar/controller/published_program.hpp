#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <busbar/controller/program_image.hpp>
#include <busbar/controller/program_types.hpp>
#include <busbar/controller/publishing.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// A program with what of it is published, as one object that stays where it is. Made in any
/// thread, then of the server's.
class BUSBAR_API PublishedProgram {
    struct Key {};

public:
    /// The problem is that of ProgramTypes or of an initial value that does not fit.
    [[nodiscard]] static Configured<std::unique_ptr<PublishedProgram>>
    create(Program program, const PublishingLimits& limits);
    PublishedProgram(Key, Program program) : program_{std::move(program)} {}
    PublishedProgram(const PublishedProgram&) = delete;
    PublishedProgram& operator=(const PublishedProgram&) = delete;

    [[nodiscard]] const Program& program() const { return program_; }
    [[nodiscard]] const ProgramTypes& types() const { return *types_; }
    [[nodiscard]] const Publication& publication() const { return *publication_; }
    /// The image of the published variables, in the order of their handles. `namespace_index` is
    /// that of MachineNodes.
    [[nodiscard]] Configured<ProgramImage> make_image(std::uint16_t namespace_index,
                                                      const server::ImageOptions& options) const;

private:
    Program program_;
    std::optional<ProgramTypes> types_;
    std::optional<Publication> publication_;
};

} // namespace busbar::controller
