#include <busbar/controller/program_image.hpp>

#include <unordered_map>

#include <busbar/core/text.hpp>
#include <busbar/server/image_layout.hpp>

#include "controller/program/initial_checker.hpp"
#include "initial_values.hpp"

namespace busbar::controller {

namespace {

/// Words for the refusals of ImageLayout and ImageStructure.
std::string text_of_refusal(StatusCode status)
{
    if (status == status::Bad_OutOfMemory) {
        return "takes more bytes than a process image can have";
    }
    return "has more dimensions, members or levels than a process image can have";
}

std::string printable_name(const std::string& name)
{
    constexpr std::size_t enough = 60;
    return printable(name.substr(0, enough));
}

/// Builds what an image needs for a program's variables. Makes each structure once.
class ProgramLayout {
public:
    ProgramLayout(const ProgramTypes& types, ProgramImage::EncodingOf encoding_of,
                  ElementaryTypes elementary)
        : types_{&types}, encoding_of_{encoding_of}, elementary_{elementary}
    {
    }

    /// The text of the Problem tells why the variable cannot be in an image.
    [[nodiscard]] Configured<server::ImageVariable> variable(const ResolvedType& type);

private:
    using Structure = std::shared_ptr<const server::ImageStructure>;

    [[nodiscard]] Configured<Structure> structure(const DerivedType& type);

    const ProgramTypes* types_;
    ProgramImage::EncodingOf encoding_of_;
    ElementaryTypes elementary_;
    std::unordered_map<const DerivedType*, Structure> structures_;
};

Configured<server::ImageVariable> ProgramLayout::variable(const ResolvedType& type)
{
    server::ImageVariable made;
    for (const Bounds& bounds : type.dimensions) {
        made.dimensions.push_back(static_cast<std::uint32_t>(bounds.upper - bounds.lower + 1));
    }
    switch (type.kind) {
    case ResolvedType::Kind::Union:
        return misconfigured("", "is a union, which has no place in a process image");
    case ResolvedType::Kind::Structure: {
        auto inner = structure(*type.type);
        if (!inner) {
            return Unexpected<Problem>{std::move(inner.error())};
        }
        made.type = BuiltInType::ExtensionObject;
        made.structure = std::move(*inner);
        break;
    }
    default:
        made.type = built_in_type_of(type.elementary, elementary_);
        made.capacity = type.text_bytes();
        made.max_units = is_wide(type.elementary) ? type.string_length : 0;
        if (type.subrange) {
            made.range = server::ImageRange{type.subrange->lower, type.subrange->upper};
        }
    }
    return made;
}

Configured<ProgramLayout::Structure> ProgramLayout::structure(const DerivedType& type)
{
    if (const auto found = structures_.find(&type); found != structures_.end()) {
        return found->second;
    }
    std::vector<server::ImageVariable> members;
    for (const ResolvedType& member : types_->members(type)) {
        auto made = variable(member);
        if (!made) {
            Problem problem = std::move(made.error());
            problem.where = "." + printable_name(type.members[members.size()].name) + problem.where;
            return Unexpected<Problem>{std::move(problem)};
        }
        members.push_back(std::move(*made));
    }
    auto made = server::ImageStructure::create(encoding_of_(type), members);
    if (!made) {
        return misconfigured("", text_of_refusal(made.error()));
    }
    return structures_.emplace(&type, std::move(*made)).first->second;
}

/// Names a variable as problems do: "variables[7] (Speed)", with line and column if they are known.
std::string place_of_variable(const Program& program, std::size_t index)
{
    const GlobalVariable& variable = program.variables[index];
    std::string where;
    if (variable.place.line != 0) {
        where = std::to_string(variable.place.line) + ":" + std::to_string(variable.place.column) +
                ": ";
    }
    return where + "variables[" + std::to_string(index) + "] (" + printable_name(variable.name) +
           ")";
}

Unexpected<Problem> problem_of_variable(const Program& program, std::size_t index, Problem problem)
{
    problem.where = place_of_variable(program, index) + problem.where;
    return Unexpected<Problem>{std::move(problem)};
}

std::string text_of_refused_place(StatusCode status)
{
    return status == status::Bad_InvalidArgument
               ? "has another size or alignment in the image than in the runtime's memory"
               : "does not fit into the process image";
}

/// Checks the initial values of these variables and of all types.
std::optional<Problem> check_initial(const ProgramTypes& types,
                                     std::span<const std::size_t> variables)
{
    detail::InitialChecker checker{types};
    for (std::size_t i = 0; i < types.program().types.size(); ++i) {
        if (auto problem = checker.check_type(i)) {
            return problem;
        }
    }
    for (const std::size_t index : variables) {
        if (auto problem = checker.check_variable(index)) {
            return problem;
        }
    }
    return {};
}

Configured<server::ImageLayout> lay_out(const ProgramTypes& types,
                                        std::span<const std::size_t> variables,
                                        ProgramImage::EncodingOf encoding_of,
                                        const ProgramImageOptions& options)
{
    const Program& program = types.program();
    ProgramLayout made{types, encoding_of, options.elementary};
    server::ImageLayout layout;
    for (const std::size_t index : variables) {
        auto variable = made.variable(types.resolve(program.variables[index].type));
        if (!variable) {
            return problem_of_variable(program, index, std::move(variable.error()));
        }
        variable->is_read_only = program.variables[index].is_constant;
        if (options.runtime_of) {
            variable->runtime = options.runtime_of(program.variables[index]);
        }
        if (const auto added = layout.add(*variable); !added) {
            return problem_of_variable(program, index,
                                       {added.error(), "", text_of_refused_place(added.error())});
        }
    }
    if (auto problem = check_initial(types, variables)) {
        return Unexpected<Problem>{std::move(*problem)};
    }
    return layout;
}

/// Writes the initial values of variables; no other thread may use `memory`.
Configured<void> fill_in(const ProgramTypes& types, std::span<const std::size_t> variables,
                         server::ImageMemory& memory)
{
    const detail::InitialValues initial{types};
    for (std::uint32_t handle = 0; handle < variables.size(); ++handle) {
        const GlobalVariable& variable = types.program().variables[variables[handle]];
        const server::ImagePlace& place = memory.layout()[handle];
        if (place.runtime != nullptr) {
            continue; // the runtime already uses it
        }
        if (!initial.store(types.resolve(variable.type), variable.initial, place,
                           memory.bytes(place))) {
            return problem_of_variable(
                types.program(), variables[handle],
                {.text = "has an initial value that the type it is published as cannot have"});
        }
    }
    return {};
}

/// Words for the refusals of ProcessImage::add_variables.
std::string text_of_refused_addition(StatusCode status)
{
    if (status == status::Bad_TooManyOperations) {
        return "variables were added to the process image as often as it allows";
    }
    if (status == status::Bad_OutOfRange) {
        return "a variable takes more bytes than are written at the edge of a scan";
    }
    return "the process image has no room for more variables";
}

} // namespace

Configured<ProgramImage> ProgramImage::create(const ProgramTypes& types,
                                              std::span<const std::size_t> variables,
                                              EncodingOf encoding_of,
                                              const ProgramImageOptions& options)
{
    auto layout = lay_out(types, variables, encoding_of, options);
    if (!layout) {
        return Unexpected<Problem>{std::move(layout.error())};
    }
    auto image = server::ProcessImage::create(std::move(*layout), options.image);
    if (auto filled = fill_in(types, variables, image->memory()); !filled) {
        return Unexpected<Problem>{std::move(filled.error())};
    }
    return ProgramImage{std::move(image), variables, options};
}

Configured<ProgramImageAddition> ProgramImage::add(const ProgramTypes& types,
                                                   std::span<const std::size_t> variables,
                                                   EncodingOf encoding_of)
{
    if (variables.empty()) {
        return ProgramImageAddition{image_->size(), {}, nullptr};
    }
    auto layout = lay_out(types, variables, encoding_of, options_);
    if (!layout) {
        return Unexpected<Problem>{std::move(layout.error())};
    }
    ProgramImageAddition result{0, {variables.begin(), variables.end()}, nullptr};
    Configured<void> filled;
    const auto added =
        image_->add_variables(std::move(*layout), [&](server::ImageMemory& memory) -> StatusCode {
            filled = fill_in(types, variables, memory);
            return filled ? StatusCode{} : filled.error().status;
        });
    if (!filled) {
        return Unexpected<Problem>{std::move(filled.error())};
    }
    if (!added) {
        return misconfigured("", text_of_refused_addition(added.error()), added.error());
    }
    result.first_handle = added->first_handle;
    result.memory = added->memory;
    return result;
}

} // namespace busbar::controller
