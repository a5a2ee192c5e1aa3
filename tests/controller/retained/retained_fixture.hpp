#pragma once

#include <catch2/catch.hpp>

#include <numeric>
#include <string>
#include <vector>

#include <busbar/controller/retained_values.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace busbar::test {

/// Two retained numbers, a text, structures, and what is not retained.
[[nodiscard]] inline controller::Program retaining_program()
{
    using namespace controller;
    Program program;
    DerivedType axis{.name = "Axis"};
    axis.members = {
        {.name = "On", .type = {.elementary = ElementaryType::Bool}},
        {.name = "Name", .type = {.elementary = ElementaryType::String, .string_length = 8}}};
    program.types = {std::move(axis)};
    const auto add = [&](std::string name, TypeUse type, bool is_retained) {
        program.variables.push_back(
            {.name = std::move(name), .type = std::move(type), .is_retained = is_retained});
    };
    add("Count", {.elementary = ElementaryType::Dint}, true);
    add("Recipe", {.elementary = ElementaryType::String, .string_length = 16}, true);
    add("Axes", {.type_name = "Axis", .dimensions = {{0, 1}}}, true);
    add("Level", {.elementary = ElementaryType::Dint}, false);
    return program;
}

/// A controller from one start to the next.
struct RetainingController {
    explicit RetainingController(Storage& storage,
                                 controller::Program declared = retaining_program())
        : program{std::move(declared)}, types{controller::ProgramTypes::create(program).value()}
    {
        std::vector<std::size_t> all(program.variables.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        const auto encoding = [](const controller::DerivedType&) { return NodeId{1, 1}; };
        made = controller::ProgramImage::create(types, all, encoding).value();
        retained = std::make_unique<controller::RetainedValues>(storage, types, *made);
        restored = retained->restore();
    }
    [[nodiscard]] server::ImageMemory& memory() { return made->image()->memory(); }
    [[nodiscard]] std::int32_t& count() { return memory().value<std::int32_t>(0); }
    void scan()
    {
        made->image()->begin_scan();
        made->image()->publish(DateTime{++scans});
    }
    /// Another value of everything, which a scan publishes.
    void work(std::int32_t number)
    {
        count() = number;
        CHECK(memory().set_text(1, "recipe " + std::to_string(number)));
        CHECK(memory().structure(2, 1).set_text(1, std::to_string(number)));
        memory().value<std::int32_t>(3) = number;
        scan();
    }
    /// The number that everything is of; none if it is of several.
    [[nodiscard]] std::optional<std::int32_t> number()
    {
        const std::string text = std::to_string(count());
        const bool is_new = count() == 0 && memory().text(1) == "";
        const bool is_whole =
            memory().text(1) == "recipe " + text && memory().structure(2, 1).text(1) == text;
        return is_new || is_whole ? std::optional{count()} : std::nullopt;
    }

    controller::Program program;
    controller::ProgramTypes types;
    std::optional<controller::ProgramImage> made;
    std::unique_ptr<controller::RetainedValues> retained;
    controller::RetainedRestore restored;
    std::int64_t scans{0};
};

} // namespace busbar::test
