#include <busbar/controller/program_image.hpp>

#include "initial_values.hpp"
#include "program_layout.hpp"

namespace busbar::controller {

namespace {

tl::unexpected<Problem> problem_of_variable(const Program& program, std::size_t index,
                                            Problem problem)
{
    problem.where = detail::place_of_variable(program, index) + problem.where;
    return tl::unexpected<Problem>{std::move(problem)};
}

Configured<server::ImageLayout> lay_out(const ProgramTypes& types,
                                        std::span<const std::size_t> variables,
                                        ProgramImage::EncodingOf encoding_of)
{
    const Program& program = types.program();
    detail::ProgramLayout made{types, encoding_of};
    server::ImageLayout layout;
    for (const std::size_t index : variables) {
        auto variable = made.variable(program.variables[index].type);
        if (!variable) {
            return problem_of_variable(program, index, std::move(variable.error()));
        }
        if (const auto added = layout.add(*variable); !added) {
            return problem_of_variable(program, index,
                                       {added.error(), "", "does not fit into the process image"});
        }
    }
    return layout;
}

} // namespace

Configured<ProgramImage> ProgramImage::create(const ProgramTypes& types,
                                              std::span<const std::size_t> variables,
                                              EncodingOf encoding_of,
                                              const server::ImageOptions& options)
{
    auto layout = lay_out(types, variables, encoding_of);
    if (!layout) {
        return tl::unexpected<Problem>{std::move(layout.error())};
    }
    auto image = server::ProcessImage::create(std::move(*layout), options);
    const detail::InitialValues initial{types};
    for (std::uint32_t handle = 0; handle < variables.size(); ++handle) {
        const GlobalVariable& variable = types.program().variables[variables[handle]];
        const server::ImagePlace& place = image->layout()[handle];
        if (auto problem = initial.store(variable.type, variable.initial, place,
                                         image->memory().bytes(place))) {
            return problem_of_variable(types.program(), variables[handle], std::move(*problem));
        }
    }
    return ProgramImage{std::move(image), variables};
}

} // namespace busbar::controller
