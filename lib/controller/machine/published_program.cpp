#include <busbar/controller/published_program.hpp>

#include <span>
#include <utility>

#include <busbar/controller/machine_types.hpp>
#include <busbar/controller/program_initial.hpp>

#include "online_edit.hpp"

namespace busbar::controller {

namespace {

/// Indices among the variables of `program`, which must be theirs.
std::vector<std::size_t> indices_of(std::span<const PublishedVariable> variables,
                                    const Program& program)
{
    std::vector<std::size_t> indices;
    indices.reserve(variables.size());
    for (const PublishedVariable& each : variables) {
        indices.push_back(static_cast<std::size_t>(each.variable - program.variables.data()));
    }
    return indices;
}

} // namespace

Configured<std::unique_ptr<const PublishedProgram::Edition>>
PublishedProgram::checked(Program program)
{
    auto edition = std::make_unique<Edition>(Edition{std::move(program)});
    auto types = ProgramTypes::create(edition->program);
    if (!types) {
        return tl::unexpected{std::move(types).error()};
    }
    edition->types = std::move(*types);
    if (auto initial = check_initial_values(*edition->types); !initial) {
        return tl::unexpected{std::move(initial).error()};
    }
    return edition;
}

Configured<std::unique_ptr<PublishedProgram>>
PublishedProgram::create(Program program, const PublishingLimits& limits)
{
    auto edition = checked(std::move(program));
    if (!edition) {
        return tl::unexpected{std::move(edition).error()};
    }
    auto result = std::make_unique<PublishedProgram>(Key{});
    result->editions_.push_back(std::move(*edition));
    result->publication_.emplace(result->types(), limits);
    return result;
}

Configured<ProgramImage> PublishedProgram::make_image(std::uint16_t namespace_index,
                                                      const ProgramImageOptions& options) const
{
    return ProgramImage::create(
        types(), indices_of(publication_->published(), program()),
        [&](const DerivedType& type) { return MachineTypes::encoding_of(namespace_index, type); },
        options);
}

Configured<ProgramAddition> PublishedProgram::add(Program edited, std::uint16_t namespace_index,
                                                  ProgramImage& image)
{
    auto edition = checked(std::move(edited));
    if (!edition) {
        return tl::unexpected{std::move(edition).error()};
    }
    const ProgramTypes& types = *(*edition)->types;
    for (const auto& before : editions_) {
        if (auto same = detail::check_unchanged(*before->types, types); !same) {
            return tl::unexpected{std::move(same).error()};
        }
    }
    // A copy, so that nothing has changed if the image cannot have them.
    Publication publication{*publication_};
    const PublicationGroup group = publication.add(types);
    const std::span<const PublishedVariable> added{publication.published()};
    auto in_image = image.add(
        types, indices_of(added.subspan(group.first_published), types.program()),
        [&](const DerivedType& type) { return MachineTypes::encoding_of(namespace_index, type); });
    if (!in_image) {
        return tl::unexpected{std::move(in_image).error()};
    }
    editions_.push_back(std::move(*edition));
    *publication_ = std::move(publication);
    return ProgramAddition{group, std::move(*in_image), &types};
}

} // namespace busbar::controller
