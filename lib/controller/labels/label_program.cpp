#include <busbar/controller/label_program.hpp>

#include <algorithm>
#include <utility>
#include <vector>

#include <busbar/controller/program_initial.hpp>

#include "controller/program/leaving_out.hpp"
#include "controller/program/program_problem.hpp"
#include "wide_texts.hpp"

namespace busbar::controller {

namespace {

/// Leaves out the program's types that have the name of one of `own`.
void leave_out_types_of(Program& program, const std::vector<DerivedType>& own)
{
    std::erase_if(program.types, [&](const DerivedType& type) {
        const bool is_taken = std::any_of(own.begin(), own.end(), [&](const DerivedType& each) {
            return fold_name(each.name) == fold_name(type.name);
        });
        if (is_taken) {
            program.left_out.push_back(detail::left_out(LeftOut::Kind::Type, type.name, {},
                                                        type.place,
                                                        "has the name of a type of labels"));
            detail::add_file(program.left_out.back(), program.files);
        }
        return is_taken;
    });
}

/// Appends these after the program's own types, so that places in problems remain valid.
void append(std::vector<DerivedType> own, Program& program)
{
    for (DerivedType& type : own) {
        program.types.push_back(std::move(type));
    }
}

Configured<ProgramTypes> types_of_labels(const Program& program)
{
    return ProgramTypes::create(program).and_then([](ProgramTypes types) {
        return check_initial_values(types).transform([&] { return std::move(types); });
    });
}

} // namespace

LabelProgram::LabelProgram(Key, Program program) : program_{std::move(program)} {}
LabelProgram::~LabelProgram() = default;

void LabelProgram::leave_out(Program& program)
{
    const std::vector<DerivedType> own = label_types();
    leave_out_types_of(program, own);
    append(own, program);
    if (!types_of_labels(program)) {
        detail::ProgramSieve{program, {}}.run();
    }
    // Nothing is wrong with these, so that they are still the last ones.
    program.types.erase(program.types.end() - static_cast<std::ptrdiff_t>(own.size()),
                        program.types.end());
}

Configured<std::shared_ptr<LabelProgram>> LabelProgram::create(Program program, Unserved unserved,
                                                               const server::ImageOptions& options)
{
    if (unserved == Unserved::LeaveOut) {
        leave_out(program);
    }
    append(label_types(), program);
    auto made = std::make_shared<LabelProgram>(Key{}, std::move(program));
    if (auto problem = made->make(options)) {
        return Unexpected<Problem>{std::move(*problem)};
    }
    return made;
}

std::optional<Problem> LabelProgram::make(const server::ImageOptions& options)
{
    auto types = types_of_labels(program_);
    if (types) {
        const auto is_changed = detail::lay_out_wide_texts(program_, *types);
        if (!is_changed) {
            return is_changed.error();
        }
        if (*is_changed) {
            types = ProgramTypes::create(program_);
        }
    }
    if (!types) {
        return std::move(types.error());
    }
    types_ = std::move(*types);
    std::vector<std::size_t> variables;
    for (std::size_t i = 0; i < program_.variables.size(); ++i) {
        by_name_.emplace(fold_name(program_.variables[i].name), i);
        if (types_->layout(types_->resolve(program_.variables[i].type)).has_union) {
            handles_.emplace_back();
        } else {
            handles_.emplace_back(static_cast<std::uint32_t>(variables.size()));
            variables.push_back(i);
        }
    }
    // No value here is ever an ExtensionObject.
    const auto no_encoding = [](const DerivedType&) { return NodeId{}; };
    auto image = ProgramImage::create(*types_, variables, no_encoding, {.image = options});
    if (!image) {
        return std::move(image.error());
    }
    image_ = std::move(*image);
    return std::nullopt;
}

const GlobalVariable* LabelProgram::variable(std::string_view name) const
{
    const auto found = by_name_.find(fold_name(name));
    return found == by_name_.end() ? nullptr : &program_.variables[found->second];
}

std::optional<std::uint32_t> LabelProgram::handle_of(const GlobalVariable& variable) const
{
    return handles_[static_cast<std::size_t>(&variable - program_.variables.data())];
}

} // namespace busbar::controller
