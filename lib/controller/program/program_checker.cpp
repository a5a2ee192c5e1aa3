#include "program_checker.hpp"

#include <algorithm>
#include <utility>

#include "program_problem.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::size_t not_measured = SIZE_MAX;
constexpr std::size_t being_measured = SIZE_MAX - 1;
constexpr std::size_t not_measurable = SIZE_MAX - 2;

std::string more_than(std::size_t limit, std::string_view what)
{
    return "has more than " + std::to_string(limit) + " " + std::string{what};
}

} // namespace

std::optional<Problem> ProgramChecker::check()
{
    if (auto found = check_counts()) {
        return found;
    }
    for (std::size_t i = 0; i < program_->types.size(); ++i) {
        if (auto found = check_type(i)) {
            return found;
        }
    }
    if (auto found = check_nesting()) {
        return found;
    }
    return check_variables();
}

std::optional<Problem> ProgramChecker::check_counts() const
{
    if (program_->types.size() > limits_->max_types) {
        return Problem{.where = "types", .text = more_than(limits_->max_types, "types")};
    }
    if (program_->variables.size() > limits_->max_variables) {
        return Problem{.where = "variables",
                       .text = more_than(limits_->max_variables, "variables")};
    }
    return {};
}

std::optional<Problem> ProgramChecker::check_name(const std::string& name, const std::string& where,
                                                  const ProgramPlace& place) const
{
    if (name.empty()) {
        return problem_at(*program_, where, place, "has no name");
    }
    if (name.size() > limits_->max_name_length) {
        return problem_at(*program_, where, place,
                          "has a name of " + std::to_string(name.size()) + " bytes; at most " +
                              std::to_string(limits_->max_name_length) + " are allowed");
    }
    if (first_not_utf8(name)) {
        return problem_at(*program_, where, place, "has a name that is not UTF-8");
    }
    return {};
}

std::optional<Problem> ProgramChecker::check_type(std::size_t index) const
{
    const DerivedType& type = program_->types[index];
    const std::string where = place_in("types", index, type.name);
    if (auto found = check_name(type.name, where, type.place)) {
        return found;
    }
    if (types_->find(type.name) != &type) {
        return problem_at(*program_, where, type.place, "is also the name of another type");
    }
    switch (type.kind) {
    case DerivedType::Kind::Alias:
        return check_use(type.alias, where, type.place);
    case DerivedType::Kind::Enumeration:
        return check_enumerators(type, where);
    default:
        return check_members(type, where);
    }
}

std::optional<Problem> ProgramChecker::check_members(const DerivedType& type,
                                                     const std::string& where) const
{
    if (type.members.empty() || type.members.size() > limits_->max_members) {
        return problem_at(*program_, where, type.place,
                          type.members.empty() ? "has no members"
                                               : more_than(limits_->max_members, "members"));
    }
    std::unordered_set<std::string> names;
    for (const Member& member : type.members) {
        const std::string place = where + "." + quoted_name(member.name);
        if (auto found = check_name(member.name, place, member.place)) {
            return found;
        }
        if (!names.insert(fold_name(member.name)).second) {
            return problem_at(*program_, place, member.place, "is also the name of another member");
        }
        if (auto found = check_use(member.type, place, member.place)) {
            return found;
        }
    }
    return {};
}

std::optional<Problem> ProgramChecker::check_enumerators(const DerivedType& type,
                                                         const std::string& where) const
{
    if (type.enumerators.empty() || type.enumerators.size() > limits_->max_members) {
        return problem_at(*program_, where, type.place,
                          type.enumerators.empty() ? "has no values"
                                                   : more_than(limits_->max_members, "values"));
    }
    std::unordered_set<std::string> names;
    std::unordered_set<std::int32_t> values;
    for (const Enumerator& one : type.enumerators) {
        const std::string place = where + "." + quoted_name(one.name);
        if (auto found = check_name(one.name, place, type.place)) {
            return found;
        }
        if (!names.insert(fold_name(one.name)).second) {
            return problem_at(*program_, place, type.place, "is also the name of another value");
        }
        if (!values.insert(one.value).second) {
            return problem_at(*program_, place, type.place,
                              "has the value " + std::to_string(one.value) +
                                  " as another name has");
        }
    }
    return {};
}

std::optional<Problem> ProgramChecker::check_use(const TypeUse& use, const std::string& where,
                                                 const ProgramPlace& place) const
{
    if (!use.type_name.empty() && types_->find(use.type_name) == nullptr) {
        return problem_at(*program_, where, place,
                          "is of the type " + quoted_name(use.type_name) +
                              ", which is not declared");
    }
    if (use.dimensions.size() > limits_->max_dimensions) {
        return problem_at(*program_, where, place,
                          more_than(limits_->max_dimensions, "dimensions"));
    }
    for (const Bounds& bounds : use.dimensions) {
        // Limit indices so that their difference fits.
        constexpr std::int64_t most = INT32_MAX;
        if (bounds.lower > bounds.upper || bounds.lower < -most || bounds.upper > most) {
            return problem_at(*program_, where, place,
                              "has the bounds " + std::to_string(bounds.lower) + ".." +
                                  std::to_string(bounds.upper) +
                                  "; expected a lower and an upper one of 32 bits");
        }
    }
    if (use.subrange && use.subrange->lower > use.subrange->upper) {
        return problem_at(*program_, where, place, "has a subrange without any value");
    }
    return {};
}

std::optional<Problem> ProgramChecker::check_dimensions(const ResolvedType& type,
                                                        const std::string& where,
                                                        const ProgramPlace& place) const
{
    if (type.dimensions.size() <= limits_->max_dimensions) {
        return {};
    }
    return problem_at(*program_, where, place,
                      more_than(limits_->max_dimensions, "dimensions with those of its types"));
}

void ProgramChecker::prepare_nesting()
{
    depths_.assign(program_->types.size(), not_measured);
    types_->parts_.assign(program_->types.size(), {});
    failures_.clear();
}

std::optional<Problem> ProgramChecker::check_nesting_of(std::size_t index)
{
    is_too_deep_ = false;
    repeated_.reset();
    return measure(index, 1);
}

std::unordered_map<std::string, std::uint64_t>
ProgramChecker::sizes(const Program& program, const std::unordered_set<std::string>& unsettled)
{
    ProgramTypes types{program};
    const ProgramLimits limits;
    ProgramChecker checker{types, limits};
    checker.prepare_nesting();
    for (std::size_t i = 0; i < program.types.size(); ++i) {
        const DerivedType& type = program.types[i];
        // The values of an enumeration are settled later, and do not change its size.
        const bool is_measurable =
            !unsettled.contains(fold_name(type.name)) &&
            (type.kind == DerivedType::Kind::Enumeration || !checker.check_type(i));
        checker.depths_[i] = is_measurable ? not_measured : not_measurable;
    }
    std::unordered_map<std::string, std::uint64_t> all;
    for (std::size_t i = 0; i < program.types.size(); ++i) {
        if (!checker.check_nesting_of(i)) {
            const std::string& name = program.types[i].name;
            all.emplace(fold_name(name), types.size_of({.type_name = name}, ValueMemory::Source));
        }
    }
    return all;
}

std::optional<Problem> ProgramChecker::check_nesting()
{
    prepare_nesting();
    for (std::size_t i = 0; i < depths_.size(); ++i) {
        if (auto found = check_nesting_of(i)) {
            return found;
        }
    }
    return {};
}

std::optional<Problem> ProgramChecker::measure(std::size_t index, std::size_t level)
{
    const DerivedType& type = program_->types[index];
    const auto problem = [&](std::string text) {
        return problem_at(*program_, place_in("types", index, type.name), type.place,
                          std::move(text));
    };
    if (depths_[index] == being_measured) {
        repeated_ = index;
        return problem("contains itself");
    }
    if (depths_[index] == not_measurable) {
        return problem("cannot be measured");
    }
    if (const auto failed = failures_.find(index); failed != failures_.end()) {
        return failed->second;
    }
    if (depths_[index] == not_measured) {
        if (level > limits_->max_depth) {
            is_too_deep_ = true;
            return problem(more_than(limits_->max_depth, "types around it"));
        }
        depths_[index] = being_measured;
        std::size_t below = 0;
        if (auto found = measure_inner(type, level, below)) {
            depths_[index] = not_measured;
            return remember(index, level, std::move(*found));
        }
        depths_[index] = below + 1;
        types_->parts_[index] = types_->lay_out(type);
    }
    if (level + depths_[index] > limits_->max_depth + 1) {
        is_too_deep_ = true;
        return problem(more_than(limits_->max_depth, "types in and around it"));
    }
    return {};
}

Problem ProgramChecker::remember(std::size_t index, std::size_t level, Problem found)
{
    if (repeated_) {
        // Each type between a type and itself contains itself, too.
        const DerivedType& type = program_->types[index];
        failures_.emplace(index, problem_at(*program_, place_in("types", index, type.name),
                                            type.place, "contains itself"));
        if (*repeated_ == index) {
            repeated_.reset();
        }
    } else if (!is_too_deep_ || level == 1) {
        failures_.emplace(index, found);
    }
    return found;
}

std::optional<Problem> ProgramChecker::measure_inner(const DerivedType& type, std::size_t level,
                                                     std::size_t& below)
{
    const auto measure_use = [&](const TypeUse& use) -> Found {
        if (use.type_name.empty()) {
            return {};
        }
        const auto inner =
            static_cast<std::size_t>(types_->find(use.type_name) - program_->types.data());
        if (auto found = measure(inner, level + 1)) {
            return found;
        }
        below = std::max(below, depths_[inner]);
        return check_dimensions(types_->resolve(use), "type " + quoted_name(type.name), type.place);
    };
    if (type.kind == DerivedType::Kind::Alias) {
        return measure_use(type.alias);
    }
    for (const Member& member : type.members) {
        if (auto found = measure_use(member.type)) {
            return found;
        }
    }
    return {};
}

std::optional<Problem> ProgramChecker::check_variables() const
{
    std::unordered_set<std::string> names;
    for (std::size_t i = 0; i < program_->variables.size(); ++i) {
        if (auto found = check_variable(i, names)) {
            return found;
        }
    }
    return {};
}

std::optional<Problem> ProgramChecker::check_variable(std::size_t index,
                                                      std::unordered_set<std::string>& names) const
{
    const GlobalVariable& variable = program_->variables[index];
    const std::string where = place_in("variables", index, variable.name);
    if (auto found = check_name(variable.name, where, variable.place)) {
        return found;
    }
    if (!names.insert(fold_name(variable.name)).second) {
        return problem_at(*program_, where, variable.place, "is also the name of another variable");
    }
    if (auto found = check_use(variable.type, where, variable.place)) {
        return found;
    }
    const ResolvedType type = types_->resolve(variable.type);
    if (auto found = check_dimensions(type, where, variable.place)) {
        return found;
    }
    const ValueLayout layout = types_->layout(type);
    if (layout.in(ValueMemory::Cpu).size > limits_->max_variable_size) {
        return problem_at(*program_, where, variable.place,
                          more_than(limits_->max_variable_size, "bytes"));
    }
    if (layout.in(ValueMemory::Image).size > limits_->max_variable_size) {
        return problem_at(*program_, where, variable.place,
                          more_than(limits_->max_variable_size,
                                    "bytes in a process image, which keeps one for each BOOL"));
    }
    return {};
}

} // namespace busbar::controller::detail
