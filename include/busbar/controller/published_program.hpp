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

/// What an online edit has changed.
struct ProgramAddition {
    /// What became of the new variables; see tell().
    PublicationGroup group{};
    /// Those that are published, and RETAIN variables that are not.
    ProgramImageAddition image{};
    /// Variables that the image had before and that are RETAIN in the edited program only, each as
    /// an addition of one.
    std::vector<ProgramImageAddition> retained{};
    /// Names of variables that were published and are not any more, as their nodes have them.
    std::vector<std::string> removed{};
    /// Of the edited program. Lives as long as the PublishedProgram.
    const ProgramTypes* types{nullptr};
};

/// A program with what of it is published, as one object that stays where it is. Made in any
/// thread, then of the server's.
class BUSBAR_API PublishedProgram {
    struct Key {};

public:
    /// A program that it was made with, or edited to.
    using Edition = std::shared_ptr<const CheckedProgram>;

    [[nodiscard]] static std::unique_ptr<PublishedProgram> create(Edition program,
                                                                  const PublishingLimits& limits);
    /// Checks the program first. The problem is that of CheckedProgram.
    [[nodiscard]] static Configured<std::unique_ptr<PublishedProgram>>
    create(Program program, const PublishingLimits& limits);
    explicit PublishedProgram(Key) {}
    PublishedProgram(const PublishedProgram&) = delete;
    PublishedProgram& operator=(const PublishedProgram&) = delete;

    /// The program that it was made with, without what was edited.
    [[nodiscard]] const Program& program() const { return editions_.front()->program(); }
    [[nodiscard]] const ProgramTypes& types() const { return editions_.front()->types(); }
    /// The first one is what it was made with, the last one the program as it is. A copy serves to
    /// check edits in another thread.
    [[nodiscard]] const std::vector<Edition>& editions() const { return editions_; }
    [[nodiscard]] const Publication& publication() const { return *publication_; }
    /// Of the published variables, in their order.
    [[nodiscard]] std::span<const std::uint32_t> handles() const { return handles_; }
    /// The image of the published variables, in the order of their handles, and behind them the
    /// RETAIN variables that are not published: they have no nodes, but each scan has their values,
    /// for RetainedValues. Unions are not among these. `namespace_index` is that of MachineNodes.
    [[nodiscard]] Configured<ProgramImage>
    make_image(std::uint16_t namespace_index, const ProgramImageOptions& options = {}) const;

    /// Whether the program is one that these can be edited to; the problem names a type or a
    /// variable that is another one than it was, which takes a download. The image is not looked
    /// at. Any thread.
    [[nodiscard]] static Configured<void> check_edit(std::span<const Edition> editions,
                                                     const CheckedProgram& edited);
    /// Takes in an online edit (seed 000, 3-3-2, 4-2-5 and 6-2-2): `edited` is the whole program.
    /// Variables whose names are new are added, with their types, and those that it does not have
    /// any more are removed; another publish attribute counts as one of the two. `image` is the one
    /// of make_image(), and gets what is added; its task may run, and waits for nothing. The place
    /// of a variable that was removed stays unused, and is not given to another one.
    ///
    /// After it come RetainedValues::add, MachineNodes::remove_variables and add_variables, which
    /// is given publication() again and handles(); should that fail, the variables are without
    /// nodes until a later call of it, and nothing else is wrong.
    ///
    /// check_edit() must have found nothing against it. The problem is one of ProgramImage::add;
    /// nothing was changed then.
    [[nodiscard]] Configured<ProgramAddition> edit(Edition edited, std::uint16_t namespace_index,
                                                   ProgramImage& image);
    /// Checks the program first; the problem may be that of create() or of check_edit(), too.
    [[nodiscard]] Configured<ProgramAddition> edit(Program edited, std::uint16_t namespace_index,
                                                   ProgramImage& image);

private:
    struct NewHandles;
    /// Variables that are new in the image have handles from `first` on.
    void take(NewHandles handles, std::uint32_t first) noexcept;

    std::vector<Edition> editions_;
    std::optional<Publication> publication_;
    std::vector<std::uint32_t> handles_;
    /// Of all in the image, by their folded names.
    std::unordered_map<std::string, std::uint32_t> in_image_;
};

} // namespace busbar::controller
