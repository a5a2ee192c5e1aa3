#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

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
    /// The problem is that of ProgramTypes or of an initial value that does not fit.
    [[nodiscard]] static Configured<std::unique_ptr<PublishedProgram>>
    create(Program program, const PublishingLimits& limits);
    explicit PublishedProgram(Key) {}
    PublishedProgram(const PublishedProgram&) = delete;
    PublishedProgram& operator=(const PublishedProgram&) = delete;

    /// The program that it was made with, without what was edited.
    [[nodiscard]] const Program& program() const { return editions_.front()->program; }
    [[nodiscard]] const ProgramTypes& types() const { return *editions_.front()->types; }
    [[nodiscard]] const Publication& publication() const { return *publication_; }
    /// Of the published variables, in their order.
    [[nodiscard]] std::span<const std::uint32_t> handles() const { return handles_; }
    /// The image of the published variables, in the order of their handles, and behind them the
    /// RETAIN variables that are not published: they have no nodes, but each scan has their values,
    /// for RetainedValues. Unions are not among these. `namespace_index` is that of MachineNodes.
    [[nodiscard]] Configured<ProgramImage>
    make_image(std::uint16_t namespace_index, const ProgramImageOptions& options = {}) const;

    /// Whether edit() would find that the program has to be downloaded; the image is not looked at.
    [[nodiscard]] Configured<void> check_edit(Program edited) const;
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
    /// The problem is one that create() or ProgramImage::add has, or that a type or a variable is
    /// another one than in `edited`, which takes a download. Nothing was changed then.
    [[nodiscard]] Configured<ProgramAddition> edit(Program edited, std::uint16_t namespace_index,
                                                   ProgramImage& image);

private:
    /// A program as it came, whose types look at it.
    struct Edition {
        Program program;
        std::optional<ProgramTypes> types{};
    };

    [[nodiscard]] static Configured<std::unique_ptr<const Edition>> checked(Program program);
    [[nodiscard]] Configured<std::unique_ptr<const Edition>> edition_of(Program edited) const;
    struct NewHandles;
    /// Variables that are new in the image have handles from `first` on.
    void take(NewHandles handles, std::uint32_t first) noexcept;

    /// The first one is what it was made with, the last one the program as it is.
    std::vector<std::unique_ptr<const Edition>> editions_;
    std::optional<Publication> publication_;
    std::vector<std::uint32_t> handles_;
    /// Of all in the image, by their folded names.
    std::unordered_map<std::string, std::uint32_t> in_image_;
};

} // namespace busbar::controller
