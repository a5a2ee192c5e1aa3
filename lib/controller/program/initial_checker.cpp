#include "initial_checker.hpp"

#include <busbar/controller/program_initial.hpp>

#include "core/ascii_case.hpp"
#include "program_problem.hpp"

namespace busbar::controller::detail {

namespace {

using Notation = InitialValue::Notation;

/// True for a list such as [1, 2], but not for (X := 1).
bool is_list(const InitialValue& value)
{
    return !value.parts.empty() && value.parts.front().member.empty();
}

} // namespace

std::optional<Problem> InitialChecker::check()
{
    for (std::size_t i = 0; i < program_->types.size(); ++i) {
        if (auto found = check_type(i)) {
            return found;
        }
    }
    for (std::size_t i = 0; i < program_->variables.size(); ++i) {
        if (auto found = check_variable(i)) {
            return found;
        }
    }
    return {};
}

std::optional<Problem> InitialChecker::check_type(std::size_t index)
{
    const DerivedType& type = program_->types[index];
    steps_.clear();
    root_ = place_in("types", index, type.name);
    return check_type(type);
}

std::optional<Problem> InitialChecker::check_variable(std::size_t index)
{
    const GlobalVariable& variable = program_->variables[index];
    if (variable.initial.empty()) {
        return {};
    }
    steps_.clear();
    root_ = place_in("variables", index, variable.name);
    return check_use(variable.type, variable.initial, variable.place);
}

std::optional<Problem> InitialChecker::check_type(const DerivedType& type)
{
    for (const Member& member : type.members) {
        steps_.push_back({&member.name});
        if (auto found = check_use(member.type, member.initial, member.place)) {
            return found;
        }
        steps_.pop_back();
    }
    if (type.kind == DerivedType::Kind::Alias) {
        return check_use(type.alias, type.initial, type.place);
    }
    return check_use({.type_name = type.name}, type.initial, type.place);
}

std::optional<Problem> InitialChecker::check_use(const TypeUse& use, const InitialValue& initial,
                                                 const ProgramPlace& place)
{
    if (initial.empty()) {
        return {};
    }
    place_ = place;
    if (initial.repeat != 1) {
        return problem(initial, "is repeated, which only elements of an array can be");
    }
    return check_value(types_->resolve(use), 0, initial);
}

std::optional<Problem> InitialChecker::check_value(const ResolvedType& type, std::size_t level,
                                                   const InitialValue& value)
{
    if (value.empty()) {
        return {};
    }
    if (level < type.dimensions.size()) {
        return check_list(type, level, value);
    }
    if (type.kind == ResolvedType::Kind::Structure || type.kind == ResolvedType::Kind::Union) {
        return check_aggregate(*type.type, value);
    }
    if (!value.parts.empty()) {
        return problem(value, "has several values, expected one");
    }
    if (type.kind == ResolvedType::Kind::Enumeration) {
        return check_enumerator(*type.type, value);
    }
    if (!value.enumeration.empty() || !is_of_type(value, type)) {
        return problem(value, "has " + value_words(value) + ", expected " + type_words(type));
    }
    return {};
}

std::optional<Problem> InitialChecker::check_list(const ResolvedType& type, std::size_t level,
                                                  const InitialValue& value)
{
    if (!is_list(value)) {
        return problem(value, "has no list, expected one as [1, 2]");
    }
    const bool is_of_lists = level + 1 < type.dimensions.size() && is_list(value.parts.front());
    ResolvedType rest;
    rest.dimensions.assign(type.dimensions.begin() + static_cast<std::ptrdiff_t>(level),
                           type.dimensions.end());
    rest.dimensions.resize(is_of_lists ? 1 : rest.dimensions.size());
    const std::uint64_t most = rest.elements();
    std::uint64_t count = 0;
    for (const InitialValue& part : value.parts) {
        steps_.push_back({nullptr, count});
        if (auto found = check_element(type, is_of_lists ? level + 1 : type.dimensions.size(), part,
                                       is_of_lists)) {
            return found;
        }
        steps_.pop_back();
        count += part.repeat;
        if (count > most) {
            return problem(part, "has a list of more than the " + std::to_string(most) +
                                     " elements that there are");
        }
    }
    return {};
}

std::optional<Problem> InitialChecker::check_element(const ResolvedType& type, std::size_t level,
                                                     const InitialValue& part, bool is_of_lists)
{
    if (part.repeat == 0) {
        return problem(part, "is repeated 0 times, expected 1 or more");
    }
    if (!part.member.empty()) {
        return problem(part, "is for the member " + quoted_name(part.member) +
                                 ", expected an element of an array");
    }
    if (is_of_lists && !part.empty() && !is_list(part)) {
        return problem(part, "has one value beside lists, expected another list");
    }
    return check_value(type, level, part);
}

std::optional<Problem> InitialChecker::check_aggregate(const DerivedType& type,
                                                       const InitialValue& value)
{
    if (value.parts.empty() || is_list(value)) {
        return problem(value, "has no members, expected those of " + quoted_name(type.name) +
                                  " as (X := 1)");
    }
    if (type.kind == DerivedType::Kind::Union && value.parts.size() > 1) {
        return problem(value, "has several members, expected one because " +
                                  quoted_name(type.name) + " is a union");
    }
    Names& names = names_of(type);
    const std::uint64_t aggregate = ++aggregates_;
    for (const InitialValue& part : value.parts) {
        steps_.push_back({&part.member});
        if (auto found = check_member(type, names, aggregate, part)) {
            return found;
        }
        steps_.pop_back();
    }
    return {};
}

std::optional<Problem> InitialChecker::check_member(const DerivedType& type, Names& names,
                                                    std::uint64_t aggregate,
                                                    const InitialValue& part)
{
    const auto index = names.index.find(fold_name(part.member));
    if (index == names.index.end()) {
        return problem(part, "is not a member of " + quoted_name(type.name));
    }
    if (names.last_found[index->second] == aggregate) {
        return problem(part, "has a second value");
    }
    if (part.repeat != 1) {
        return problem(part, "is repeated, which only elements of an array can be");
    }
    names.last_found[index->second] = aggregate;
    return check_value(types_->members(type)[index->second], 0, part);
}

std::optional<Problem> InitialChecker::check_enumerator(const DerivedType& type,
                                                        const InitialValue& value)
{
    const bool is_name =
        value.notation == Notation::Unknown || value.notation == Notation::Enumerator;
    const auto* name = value.value.get_if<String>();
    if (!is_name || name == nullptr || !names_of(type).index.contains(fold_name(name->view()))) {
        return problem(value, "has " + value_words(value) + ", expected the name of a value of " +
                                  quoted_name(type.name));
    }
    if (!value.enumeration.empty() &&
        !busbar::detail::is_same_ignoring_case(value.enumeration, type.name)) {
        return problem(value, "has a value of " + quoted_name(value.enumeration) +
                                  ", expected one of " + quoted_name(type.name));
    }
    return {};
}

InitialChecker::Names& InitialChecker::names_of(const DerivedType& type)
{
    const auto [entry, is_new] = names_.try_emplace(&type);
    Names& names = entry->second;
    if (is_new) {
        for (const Enumerator& one : type.enumerators) {
            names.index.emplace(fold_name(one.name), names.index.size());
        }
        for (const Member& member : type.members) {
            names.index.emplace(fold_name(member.name), names.index.size());
        }
        names.last_found.resize(type.members.size());
    }
    return names;
}

Problem InitialChecker::problem(const InitialValue& value, std::string text) const
{
    std::string where = root_;
    for (const Step& step : steps_) {
        where += step.member != nullptr ? "." + quoted_name(*step.member)
                                        : "[" + std::to_string(step.element) + "]";
    }
    return problem_at(*program_, std::move(where), value.place.line != 0 ? value.place : place_,
                      std::move(text));
}

} // namespace busbar::controller::detail

namespace busbar::controller {

Configured<void> check_initial_values(const ProgramTypes& types)
{
    if (auto problem = detail::InitialChecker{types}.check()) {
        return Unexpected<Problem>{std::move(*problem)};
    }
    return {};
}

} // namespace busbar::controller
