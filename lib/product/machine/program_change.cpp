#include "program_change.hpp"

#include <algorithm>
#include <string>
#include <unordered_set>

#include <busbar/controller/program_types.hpp>

namespace busbar::product {

namespace {

bool has_same_tasks(const controller::Program& one, const controller::Program& other)
{
    return std::ranges::equal(one.tasks, other.tasks,
                              [](const auto& a, const auto& b) {
                                  return a.name == b.name && a.priority == b.priority &&
                                         a.interval == b.interval;
                              }) &&
           std::ranges::equal(one.instances, other.instances, [](const auto& a, const auto& b) {
               return a.name == b.name && a.type_name == b.type_name && a.task == b.task;
           });
}

} // namespace

bool keeps_all(const controller::Program& before, const controller::Program& edited)
{
    std::unordered_set<std::string> names;
    for (const controller::GlobalVariable& variable : edited.variables) {
        names.insert(controller::fold_name(variable.name));
    }
    return has_same_tasks(before, edited) &&
           std::ranges::all_of(before.variables, [&](const controller::GlobalVariable& variable) {
               return names.contains(controller::fold_name(variable.name));
           });
}

} // namespace busbar::product
