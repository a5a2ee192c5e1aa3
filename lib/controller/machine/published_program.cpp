#include <busbar/controller/published_program.hpp>

#include <utility>

#include <busbar/controller/machine_types.hpp>
#include <busbar/controller/program_initial.hpp>

namespace busbar::controller {

Configured<std::unique_ptr<PublishedProgram>>
PublishedProgram::create(Program program, const PublishingLimits& limits)
{
    auto result = std::make_unique<PublishedProgram>(Key{}, std::move(program));
    auto types = ProgramTypes::create(result->program_);
    if (!types) {
        return tl::unexpected{std::move(types).error()};
    }
    result->types_ = std::move(*types);
    if (auto checked = check_initial_values(*result->types_); !checked) {
        return tl::unexpected{std::move(checked).error()};
    }
    result->publication_.emplace(*result->types_, limits);
    return result;
}

Configured<ProgramImage> PublishedProgram::make_image(std::uint16_t namespace_index,
                                                      const server::ImageOptions& options) const
{
    std::vector<std::size_t> variables;
    variables.reserve(publication_->published().size());
    for (const PublishedVariable& each : publication_->published()) {
        variables.push_back(static_cast<std::size_t>(each.variable - program_.variables.data()));
    }
    return ProgramImage::create(
        *types_, variables,
        [&](const DerivedType& type) { return MachineTypes::encoding_of(namespace_index, type); },
        options);
}

} // namespace busbar::controller
