#include "program_change.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <busbar/controller/program_types.hpp>
#include <busbar/core/text.hpp>

#include "program_file.hpp"

namespace busbar::product {

namespace {

bool is_same(const controller::ProgramTask& one, const controller::ProgramTask& other)
{
    return one.priority == other.priority && one.interval == other.interval;
}

bool is_same(const controller::ProgramInstance& one, const controller::ProgramInstance& other)
{
    return one.type_name == other.type_name && one.task == other.task;
}

template <typename Part>
Configured<void> check_same(std::string_view list, const std::vector<Part>& before,
                            const std::vector<Part>& edited)
{
    const auto refuse = [list](const Part& part, std::string_view what) {
        return misconfigured(std::string{list} + " (" + printable(part.name) + ")",
                             std::string{what} +
                                 "; this requires a download instead of an online edit");
    };
    const auto in = [](const std::vector<Part>& all, const Part& wanted) {
        return std::ranges::find(all, wanted.name, &Part::name);
    };
    for (const Part& each : edited) {
        const auto old = in(before, each);
        if (old == before.end() || !is_same(*old, each)) {
            return refuse(each, old == before.end() ? "is new" : "was different");
        }
    }
    for (const Part& each : before) {
        if (in(edited, each) == edited.end()) {
            return refuse(each, "is gone");
        }
    }
    return {};
}

using controller::DerivedType;
using controller::GlobalVariable;
using controller::InitialValue;
using controller::TypeUse;

std::string text_of(const TypeUse& use)
{
    std::string all;
    for (const controller::Bounds& each : use.dimensions) {
        all += (all.empty() ? "ARRAY[" : ", ") + std::to_string(each.lower) + ".." +
               std::to_string(each.upper);
    }
    all += all.empty() ? "" : "] OF ";
    all += use.type_name.empty() ? std::string{controller::name(use.elementary)} : use.type_name;
    if (use.type_name.empty() && is_text(use.elementary) && size_of(use.elementary) == 0) {
        all += "[" + std::to_string(use.string_length) + "]";
    }
    if (use.subrange) {
        all += "(" + std::to_string(use.subrange->lower) + ".." +
               std::to_string(use.subrange->upper) + ")";
    }
    return all;
}

std::string text_of(const Variant& value)
{
    if (const auto* const flag = value.get_if<bool>()) {
        return *flag ? "TRUE" : "FALSE";
    }
    if (const auto* const number = value.get_if<std::int64_t>()) {
        return std::to_string(*number);
    }
    if (const auto* const number = value.get_if<std::uint64_t>()) {
        return std::to_string(*number);
    }
    if (const auto* const number = value.get_if<double>()) {
        return std::to_string(*number);
    }
    if (const auto* const text = value.get_if<String>()) {
        return "'" + printable(text->view()) + "'";
    }
    const auto* const time = value.get_if<DateTime>();
    return time != nullptr ? to_string(*time) : "";
}

/// Puts values with parts in parentheses.
std::string text_of(const InitialValue& initial)
{
    std::string all = initial.member.empty() ? "" : initial.member + " := ";
    all += initial.repeat > 1 ? std::to_string(initial.repeat) + " times " : "";
    if (initial.parts.empty()) {
        return all + text_of(initial.value);
    }
    const char* separator = "(";
    for (const InitialValue& part : initial.parts) {
        all += separator + text_of(part);
        separator = ", ";
    }
    return all + ")";
}

std::string with_initial(std::string text, const InitialValue& initial)
{
    return initial.empty() ? text : std::move(text) + " := " + text_of(initial);
}

std::string text_of(const GlobalVariable& variable)
{
    constexpr std::array<std::string_view, 4> publishing{"", ", published", ", published as input",
                                                         ", published as output"};
    return with_initial(text_of(variable.type), variable.initial) +
           (variable.is_constant ? ", CONSTANT" : "") + (variable.is_retained ? ", RETAIN" : "") +
           (variable.address.empty() ? "" : ", AT " + variable.address) +
           std::string{publishing[static_cast<std::size_t>(variable.publish)]};
}

std::string text_of(const DerivedType& type)
{
    constexpr std::array<std::string_view, 4> kinds{"", "(", "STRUCT ", "UNION "};
    std::string all{kinds[static_cast<std::size_t>(type.kind)]};
    if (type.kind == DerivedType::Kind::Alias) {
        all += text_of(type.alias);
    }
    const char* separator = "";
    for (const controller::Enumerator& each : type.enumerators) {
        all += separator + each.name + " := " + std::to_string(each.value);
        separator = ", ";
    }
    for (const controller::Member& each : type.members) {
        all += separator + each.name + " : " + with_initial(text_of(each.type), each.initial);
        separator = "; ";
    }
    all += type.kind == DerivedType::Kind::Enumeration ? ")" : "";
    return with_initial(std::move(all), type.initial);
}

std::string text_of(const controller::ProgramTask& task)
{
    return "priority " + std::to_string(task.priority) + ", interval " + task.interval;
}

std::string text_of(const controller::ProgramInstance& instance)
{
    return instance.type_name + " in " + instance.task;
}

template <typename Part>
void add_differences(std::vector<ProgramDifference>& all, const char* what,
                     const std::vector<Part>& file, const std::vector<Part>& controller)
{
    std::unordered_map<std::string, const Part*> others;
    for (const Part& each : controller) {
        others.emplace(controller::fold_name(each.name), &each);
    }
    const auto add = [&](const Part& named, std::string of_file, std::string of_controller) {
        all.push_back(
            {what + (" " + printable(named.name)), std::move(of_file), std::move(of_controller)});
    };
    for (const Part& each : file) {
        const auto other = others.extract(controller::fold_name(each.name));
        std::string of_file = text_of(each);
        std::string of_controller = other.empty() ? "" : text_of(*other.mapped());
        if (of_file != of_controller) {
            add(each, std::move(of_file), std::move(of_controller));
        }
    }
    for (const Part& each : controller) {
        if (others.contains(controller::fold_name(each.name))) {
            add(each, "", text_of(each));
        }
    }
}

} // namespace

std::vector<ProgramDifference> differences(const controller::Program& file,
                                           const controller::Program& controller)
{
    std::vector<ProgramDifference> all;
    add_differences(all, "type", file.types, controller.types);
    add_differences(all, "variable", file.variables, controller.variables);
    add_differences(all, "task", file.tasks, controller.tasks);
    add_differences(all, "instance", file.instances, controller.instances);
    return all;
}

Configured<void> check_edit(std::span<const controller::PublishedProgram::Edition> editions,
                            const controller::CheckedProgram& edited)
{
    // An online edit cannot change tasks and instances.
    const controller::Program& before = editions.back()->program();
    return check_same("tasks", before.tasks, edited.program().tasks)
        .and_then(
            [&] { return check_same("instances", before.instances, edited.program().instances); })
        .and_then([&] { return controller::PublishedProgram::check_edit(editions, edited); });
}

Configured<void> check_left_out(const controller::Program& before, const controller::Program& next,
                                const std::string& file)
{
    using Kind = controller::LeftOut::Kind;
    const auto key_of = [](const controller::LeftOut& one) {
        return std::to_string(static_cast<int>(one.kind)) +
               controller::fold_name(one.declared.name);
    };
    const auto reason_of = [&](const controller::LeftOut& one) {
        return key_of(one) + " " + one.problem.text;
    };
    std::unordered_multiset<std::string> known;
    std::unordered_multiset<std::string> known_reasons;
    for (const controller::LeftOut& each : before.left_out) {
        known.insert(key_of(each));
        known_reasons.insert(reason_of(each));
    }
    const auto take = [](std::unordered_multiset<std::string>& all, const std::string& one) {
        const auto found = all.find(one);
        if (found == all.end()) {
            return false;
        }
        all.erase(found);
        return true;
    };
    // Several can have the same name, or none: those with a reason that is known are not new.
    std::vector<const controller::LeftOut*> others;
    for (const controller::LeftOut& each : next.left_out) {
        if (take(known_reasons, reason_of(each))) {
            take(known, key_of(each));
        } else {
            others.push_back(&each);
        }
    }
    for (const controller::LeftOut* each : others) {
        if (each->kind != Kind::Unit && !take(known, key_of(*each))) {
            return Unexpected{in_file(*each, file)};
        }
    }
    return {};
}

Configured<PreparedProgram> prepare_program(const ProgramBase& base, std::string_view text,
                                            const std::string& name)
{
    return read_program(text, name, base.trial.reading)
        .and_then([&](SourceFiles::Program program) -> Configured<SourceFiles::Program> {
            if (!base.may_leave_out_more) {
                auto kept =
                    check_left_out(base.editions.back()->program(), program->program(), name);
                if (!kept) {
                    return Unexpected{std::move(kept).error()};
                }
            }
            return program;
        })
        .transform([&](SourceFiles::Program program) {
            PlcTrial trial{base.trial};
            trial.program = program;
            const bool is_possible = trial.run().has_value();
            return PreparedProgram{
                .files = {.text = nullptr,
                          .program = program,
                          .tried = is_possible ? std::make_shared<const PlcTrial>(std::move(trial))
                                               : nullptr},
                .edition = base.editions.back(),
                .may_edit = check_edit(base.editions, *program)};
        });
}

} // namespace busbar::product
