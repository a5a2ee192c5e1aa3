#include "program_change.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/text.hpp>

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
                             std::string{what} + "; that takes a download, no online edit");
    };
    const auto in = [](const std::vector<Part>& all, const Part& wanted) {
        return std::ranges::find(all, wanted.name, &Part::name);
    };
    for (const Part& each : edited) {
        const auto old = in(before, each);
        if (old == before.end() || !is_same(*old, each)) {
            return refuse(each, old == before.end() ? "is new" : "was another one");
        }
    }
    for (const Part& each : before) {
        if (in(edited, each) == edited.end()) {
            return refuse(each, "is gone");
        }
    }
    return {};
}

} // namespace

Configured<void> check_same_tasks(const controller::Program& before,
                                  const controller::Program& edited)
{
    return check_same("tasks", before.tasks, edited.tasks).and_then([&] {
        return check_same("instances", before.instances, edited.instances);
    });
}

} // namespace busbar::product
