#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/program_image.hpp>
#include <busbar/controller/program_types.hpp>
#include <busbar/controller/publishing.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// The changes made by an online edit.
struct ProgramAddition {
    /// The result for the new variables; see tell().
    PublicationGroup group{};
    /// The published ones, and RETAIN variables that are not published.
    ProgramImageAddition image{};
    /// Variables that were in the image before and are RETAIN only in the edited program, each as
    /// an addition of one.
    std::vector<ProgramImageAddition> retained{};
    /// Node names of variables that are no longer published.
    std::vector<std::string> removed{};
    /// The types of the edited program. Lives as long as the PublishedProgram.
    const ProgramTypes* types{nullptr};
};

/// A program with its published variables, as one object that stays in place. Created on any
/// thread, then used by the server's.
class BUSBAR_API PublishedProgram {
    struct Key {};

public:
    /// The program from creation, or one that it was edited to.
    using Edition = std::shared_ptr<const CheckedProgram>;

    /// Publishes a program within these limits, and without unions, which have no place in an
    /// image.
    [[nodiscard]] static std::unique_ptr<PublishedProgram> create(Edition program,
                                                                  const PublishingLimits& limits);
    /// Checks the program first. The problem is that of CheckedProgram.
    [[nodiscard]] static Configured<std::unique_ptr<PublishedProgram>>
    create(Program program, const PublishingLimits& limits);
    explicit PublishedProgram(Key) {}
    PublishedProgram(const PublishedProgram&) = delete;
    PublishedProgram& operator=(const PublishedProgram&) = delete;

    /// Returns the program from creation, without edits.
    [[nodiscard]] const Program& program() const { return editions_.front()->program(); }
    [[nodiscard]] const ProgramTypes& types() const { return editions_.front()->types(); }
    /// The first is that from creation, the last the current program. A copy allows another thread
    /// to check edits.
    [[nodiscard]] const std::vector<Edition>& editions() const { return editions_; }
    [[nodiscard]] const Publication& publication() const { return *publication_; }
    /// The handles of the published variables, in their order.
    [[nodiscard]] std::span<const std::uint32_t> handles() const { return handles_; }
    /// Creates the image of the published variables, in the order of their handles, followed by the
    /// RETAIN variables that are not published: they have no nodes, but every scan has their
    /// values, for RetainedValues. Unions are not among these. `namespace_index` is that of
    /// MachineNodes.
    [[nodiscard]] Configured<ProgramImage>
    make_image(std::uint16_t namespace_index, const ProgramImageOptions& options = {}) const;

    /// Checks whether `editions` can be edited to this program; the problem names a type or a
    /// variable that has changed, which requires a download. The image is not checked. Any thread.
    [[nodiscard]] static Configured<void> check_edit(std::span<const Edition> editions,
                                                     const CheckedProgram& edited);
    /// Applies an online edit (W588, 3-3-2, 4-2-5 and 6-2-2): `edited` is the
    /// whole program. Variables with new names are added, with their types, and those that it no
    /// longer has are removed; a changed publish attribute counts as one of the two. `image` is the
    /// one from make_image(), and is extended; its task may run, and does not wait. The place of a
    /// removed variable stays unused, and is not given to another one.
    ///
    /// Afterwards call RetainedValues::add, MachineNodes::remove_variables and add_variables, with
    /// publication() again and handles(); if that fails, the variables are without nodes until a
    /// later call of it, and nothing else is wrong.
    ///
    /// check_edit() must have succeeded. The problem is that of ProgramImage::add; nothing has been
    /// changed then.
    [[nodiscard]] Configured<ProgramAddition> edit(Edition edited, std::uint16_t namespace_index,
                                                   ProgramImage& image);
    /// Checks the program first; the problem may also be that of create() or of check_edit().
    [[nodiscard]] Configured<ProgramAddition> edit(Program edited, std::uint16_t namespace_index,
                                                   ProgramImage& image);

private:
    struct NewHandles;
    /// The handles of variables that are new in the image begin with `first`.
    void take(NewHandles handles, std::uint32_t first) noexcept;

    std::vector<Edition> editions_;
    std::optional<Publication> publication_;
    std::vector<std::uint32_t> handles_;
    /// All in the image, keyed by their folded names.
    std::unordered_map<std::string, std::uint32_t> in_image_;
};

} // namespace busbar::controller
