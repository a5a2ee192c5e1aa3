#include "leaving_out.hpp"

#include <unordered_set>
#include <utility>

#include "initial_checker.hpp"
#include "program_checker.hpp"
#include "program_problem.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::string_view is_left_out = "which is left out";

/// Calls `visit` for each use of a type in the declaration of a type, until it returns false.
template <typename Visit>
void visit_uses(const DerivedType& type, Visit visit)
{
    if (type.kind == DerivedType::Kind::Alias) {
        visit(type.alias, std::string{}, type.place);
        return;
    }
    for (const Member& member : type.members) {
        if (!visit(member.type, "." + quoted_name(member.name), member.place)) {
            return;
        }
    }
}

Problem use_problem(const Program& program, const std::string& where, const ProgramPlace& place,
                    const TypeUse& use, std::string_view reason)
{
    return problem_at(program, where, place,
                      "is of the type " + quoted_name(use.type_name) + ", " + std::string{reason});
}

} // namespace

ProgramSieve::ProgramSieve(Program& program, const ProgramLimits& limits)
    : program_{&program}, limits_{&limits}, types_{program}
{
    for (const LeftOut& each : program.left_out) {
        remember(each);
    }
}

void ProgramSieve::run()
{
    ProgramChecker checker{types_, *limits_};
    sieve_types([&](std::size_t i) {
        auto found = check_uses(i);
        return found ? found : checker.check_type(i);
    });
    checker.prepare_nesting();
    sieve_types([&](std::size_t i) { return checker.check_nesting_of(i); });
    checker.lay_out_types();
    InitialChecker initial{types_};
    sieve_types([&](std::size_t i) { return initial.check_type(i); });
    sieve_variables();
}

void ProgramSieve::sieve_types(const CheckType& check)
{
    std::vector<Found> problems(program_->types.size());
    bool is_good = true;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        problems[i] = check(i);
        is_good = is_good && !problems[i];
    }
    if (!is_good) {
        add_users(problems);
        leave_out_types(problems);
        types_.index();
    }
}

void ProgramSieve::add_users(std::vector<Found>& problems) const
{
    const std::vector<DerivedType>& types = program_->types;
    std::unordered_map<std::string, std::vector<std::size_t>> users;
    std::vector<std::size_t> bad;
    for (std::size_t i = 0; i < types.size(); ++i) {
        visit_uses(types[i], [&](const TypeUse& use, const std::string&, const ProgramPlace&) {
            if (!use.type_name.empty()) {
                users[fold_name(use.type_name)].push_back(i);
            }
            return true;
        });
        // A second type of the same name is not used.
        if (problems[i] && types_.find(types[i].name) == &types[i]) {
            bad.push_back(i);
        }
    }
    while (!bad.empty()) {
        const DerivedType& gone = types[bad.back()];
        bad.pop_back();
        for (const std::size_t user : std::exchange(users[fold_name(gone.name)], {})) {
            if (problems[user]) {
                continue;
            }
            problems[user] = use_problem(*program_, place_in("types", user, types[user].name),
                                         types[user].place, {.type_name = gone.name}, is_left_out);
            bad.push_back(user);
        }
    }
}

void ProgramSieve::leave_out_types(std::vector<Found>& problems)
{
    std::vector<DerivedType> stay;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        DerivedType& type = program_->types[i];
        if (!problems[i]) {
            stay.push_back(std::move(type));
            continue;
        }
        LeftOut& one = program_->left_out.emplace_back();
        one.kind = LeftOut::Kind::Type;
        one.declared.name = std::move(type.name);
        one.declared.place = type.place;
        one.problem = std::move(*problems[i]);
        remember(one);
    }
    program_->types = std::move(stay);
}

void ProgramSieve::sieve_variables()
{
    ProgramChecker checker{types_, *limits_};
    checker.lay_out_types();
    InitialChecker initial{types_};
    std::unordered_set<std::string> names;
    std::vector<Found> problems(program_->variables.size());
    for (std::size_t i = 0; i < problems.size(); ++i) {
        const GlobalVariable& variable = program_->variables[i];
        problems[i] =
            check_use(variable.type, place_in("variables", i, variable.name), variable.place);
        problems[i] = problems[i] ? problems[i] : checker.check_variable(i, names);
        problems[i] = problems[i] ? problems[i] : initial.check_variable(i);
    }
    std::vector<GlobalVariable> stay;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        if (problems[i]) {
            program_->left_out.push_back({LeftOut::Kind::Variable,
                                          std::move(program_->variables[i]),
                                          std::move(*problems[i])});
        } else {
            stay.push_back(std::move(program_->variables[i]));
        }
    }
    program_->variables = std::move(stay);
}

void ProgramSieve::remember(const LeftOut& one)
{
    if (one.kind == LeftOut::Kind::Unit) {
        reasons_.emplace(fold_name(one.declared.name), "which " + one.problem.text);
    } else if (one.kind == LeftOut::Kind::Type) {
        reasons_.emplace(fold_name(one.declared.name), is_left_out);
    }
}

std::optional<Problem> ProgramSieve::check_use(const TypeUse& use, const std::string& where,
                                               const ProgramPlace& place) const
{
    if (use.type_name.empty() || types_.find(use.type_name) != nullptr) {
        return {};
    }
    const auto reason = reasons_.find(fold_name(use.type_name));
    return reason == reasons_.end() ? Found{}
                                    : use_problem(*program_, where, place, use, reason->second);
}

std::optional<Problem> ProgramSieve::check_uses(std::size_t index) const
{
    const DerivedType& type = program_->types[index];
    Found found;
    visit_uses(type, [&](const TypeUse& use, const std::string& member, const ProgramPlace& place) {
        found = check_use(use, place_in("types", index, type.name) + member, place);
        return !found;
    });
    return found;
}

} // namespace busbar::controller::detail
