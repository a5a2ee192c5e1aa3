#include "plc_builder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/core/text.hpp>

#include "plc_step.hpp"

namespace busbar::controller {

namespace {

std::string quoted(std::string_view text)
{
    std::string result{"'"};
    result += printable(text);
    result += '\'';
    return result;
}

const char* name_of(PlcProgramKind kind)
{
    switch (kind) {
    case PlcProgramKind::Increment:
        return "increment";
    case PlcProgramKind::Sine:
        return "sine";
    case PlcProgramKind::Toggle:
        return "toggle";
    case PlcProgramKind::Copy:
        return "copy";
    case PlcProgramKind::Shutdown:
        return "shutdown";
    case PlcProgramKind::Acknowledge:
        return "acknowledge";
    case PlcProgramKind::PlcError:
        return "plc_error";
    }
    return "?";
}

/// Names a field of a PlcConfig: "variables[2].type".
std::string place(const char* list, std::size_t index, const char* field)
{
    return std::string{list} + '[' + std::to_string(index) + "]." + field;
}

Unexpected<Problem> wrong_variable(std::size_t index, const char* field, std::string text)
{
    return misconfigured(place("variables", index, field), std::move(text));
}

Unexpected<Problem> wrong_program(std::size_t index, const char* field, std::string text)
{
    return misconfigured(place("programs", index, field), std::move(text));
}

Unexpected<Problem> wrong_event(std::size_t index, const char* field, std::string text)
{
    return misconfigured(place("events", index, field), std::move(text));
}

} // namespace

Configured<std::unique_ptr<Plc>> PlcBuilder::build(server::ImageOptions options)
{
    Configured<void> checked = add_variables();
    if (checked) {
        checked = check_names();
    }
    if (checked) {
        plc_->image_ = server::ProcessImage::create(layout_, options);
        checked = set_values();
    }
    if (!checked) {
        return Unexpected{std::move(checked).error()};
    }
    finder_ = [this](std::string_view name) { return find(name); };
    return finish();
}

Configured<std::unique_ptr<Plc>> PlcBuilder::build(const ProgramTypes& types,
                                                   const ProgramImage& image)
{
    if (!config_->variables.empty()) {
        return wrong_variable(0, "name", "found a variable besides those of the program");
    }
    for (const std::size_t index : image.variables()) {
        const GlobalVariable& variable = types.program().variables[index];
        plc_->variables_.push_back({variable.name, !variable.is_constant});
    }
    if (auto checked = check_names(); !checked) {
        return Unexpected{std::move(checked).error()};
    }
    plc_->image_ = image.image();
    finder_ = [this, names = detail::ProgramNames{types, image}](std::string_view name) {
        return name == restore_target_variable ? find_restore_target() : names.find(name);
    };
    return finish();
}

Configured<std::unique_ptr<Plc>> PlcBuilder::finish()
{
    Configured<void> checked = add_programs();
    if (checked) {
        checked = add_events();
    }
    if (!checked) {
        return Unexpected{std::move(checked).error()};
    }
    return std::move(plc_);
}

Configured<void> PlcBuilder::add_variables()
{
    for (std::size_t i = 0; i < config_->variables.size(); ++i) {
        if (auto added = add_variable(i); !added) {
            return added;
        }
    }
    return {};
}

Configured<void> PlcBuilder::add_variable(std::size_t index)
{
    const PlcVariable& variable = config_->variables[index];
    if (variable.name.empty()) {
        return wrong_variable(index, "name", "found no name, expected one");
    }
    const Group group{static_cast<std::uint32_t>(layout_.size()), std::max(variable.count, 1U)};
    for (std::uint32_t i = 0; i < group.count; ++i) {
        const auto added = layout_.add({.type = variable.type,
                                        .dimensions = variable.dimensions,
                                        .capacity = variable.capacity,
                                        .is_read_only = !variable.is_writable});
        if (!added && added.error() == status::Bad_DataTypeIdUnknown) {
            return wrong_variable(
                index, "type",
                "found " + std::string{name(variable.type)} +
                    ", expected Boolean to Double, String, DateTime, Guid, ByteString, "
                    "XmlElement or StatusCode");
        }
        if (!added && added.error() == status::Bad_OutOfRange) {
            return wrong_variable(index, "dimensions",
                                  "expected at most 16 dimensions and none of them 0");
        }
        if (!added) {
            return wrong_variable(index, "dimensions",
                                  "the variables need more memory than an image may have");
        }
        plc_->variables_.push_back(
            {variable.count == 0 ? variable.name : variable.name + std::to_string(i),
             variable.is_writable});
    }
    groups_.push_back(group);
    return {};
}

Configured<void> PlcBuilder::check_names()
{
    auto& sorted = plc_->by_name_;
    const auto name_at = [this](std::uint32_t handle) -> const std::string& {
        return plc_->variables_[handle].name;
    };
    for (std::uint32_t handle = 0; handle < plc_->variables_.size(); ++handle) {
        sorted.push_back(handle);
    }
    std::ranges::sort(sorted, {}, name_at);
    const auto twin = std::ranges::adjacent_find(sorted, {}, name_at);
    if (twin == sorted.end()) {
        return {};
    }
    const std::uint32_t later = std::max(twin[0], twin[1]);
    const auto group = std::ranges::find_if(
        groups_, [&](const Group& g) { return later >= g.first && later - g.first < g.count; });
    return wrong_variable(static_cast<std::size_t>(group - groups_.begin()), "name",
                          "found " + quoted(name_at(later)) + " again, expected a name of its own");
}

Configured<void> PlcBuilder::set_values()
{
    for (std::size_t i = 0; i < groups_.size(); ++i) {
        const auto value = detail::initial_value(config_->variables[i]);
        if (!value) {
            return wrong_variable(i, "initial",
                                  "expected a value that " +
                                      std::string{name(config_->variables[i].type)} +
                                      " can have, with all elements or one for all");
        }
        for (std::uint32_t j = 0; j < groups_[i].count; ++j) {
            if (!plc_->image_->memory().store(groups_[i].first + j, *value).is_good()) {
                return wrong_variable(i, "initial",
                                      "expected a text of at most " +
                                          std::to_string(config_->variables[i].capacity) +
                                          " bytes");
            }
        }
    }
    return {};
}

std::vector<detail::PlcPlace> PlcBuilder::find(std::string_view name) const
{
    std::optional<Group> group;
    if (const auto handle = plc_->find(name)) {
        group = Group{*handle, 1};
    }
    for (std::size_t i = 0; !group && i < groups_.size(); ++i) {
        if (config_->variables[i].name == name) {
            group = groups_[i];
        }
    }
    std::vector<detail::PlcPlace> places;
    for (std::uint32_t i = 0; group && i < group->count; ++i) {
        server::ImageMemory& memory = plc_->image_->memory();
        const server::ImagePlace& place = memory.layout()[group->first + i];
        places.push_back({&place, memory.bytes(place), group->first + i});
    }
    return places;
}

std::vector<detail::PlcPlace> PlcBuilder::find_restore_target()
{
    system_place_.type = BuiltInType::Boolean;
    system_place_.stride = sizeof(bool);
    auto* const bytes = static_cast<std::byte*>(static_cast<void*>(&plc_->restores_profile_));
    return {{&system_place_, bytes, 0}};
}

Configured<void> PlcBuilder::add_programs()
{
    for (std::size_t i = 0; i < config_->programs.size(); ++i) {
        if (auto added = add_program(i); !added) {
            return added;
        }
    }
    return {};
}

Configured<void> PlcBuilder::add_program(std::size_t index)
{
    const PlcProgram& program = config_->programs[index];
    const auto targets = finder_(program.target);
    if (targets.empty()) {
        return wrong_program(index, "target",
                             "found " + quoted(program.target) + ", expected a variable's name");
    }
    const BuiltInType type = targets.front().place->type;
    if (!detail::PlcStep::accepts(program.kind, type)) {
        return wrong_program(index, "target",
                             "found a variable of " + std::string{name(type)} + ", which " +
                                 name_of(program.kind) + " cannot work on");
    }
    if (program.period.count() < 0 ||
        (program.period.count() == 0 && program.kind == PlcProgramKind::Sine)) {
        return wrong_program(index, "period",
                             "found " + std::to_string(program.period.count()) +
                                 " ms, expected more than 0");
    }
    if (!std::isfinite(program.amplitude) || !std::isfinite(program.offset) ||
        !std::isfinite(program.to)) {
        return wrong_program(index, "amplitude", "expected finite numbers");
    }
    const bool is_whole = std::trunc(program.amplitude) == program.amplitude;
    if (program.kind == PlcProgramKind::Increment && type < BuiltInType::Float && !is_whole) {
        return wrong_program(index, "amplitude",
                             "found " + std::to_string(program.amplitude) +
                                 ", expected a whole number for a variable of " +
                                 std::string{name(type)});
    }
    if (program.kind == PlcProgramKind::Copy) {
        return add_copy(index, targets);
    }
    if (detail::PlcStep::may_set(program.kind)) {
        return add_setting(index, targets);
    }
    for (const detail::PlcPlace& target : targets) {
        plc_->steps_.emplace_back(program, target.target());
    }
    return {};
}

Configured<void> PlcBuilder::add_copy(std::size_t index,
                                      const std::vector<detail::PlcPlace>& targets)
{
    const PlcProgram& program = config_->programs[index];
    const auto sources = finder_(program.source);
    if (sources.empty()) {
        return wrong_program(index, "source",
                             "found " + quoted(program.source) + ", expected a variable's name");
    }
    const server::ImagePlace& from = *sources.front().place;
    const server::ImagePlace& to = *targets.front().place;
    if (from.type != to.type || from.dimensions != to.dimensions || from.capacity > to.capacity ||
        from.structure != to.structure ||
        (sources.size() != 1 && sources.size() != targets.size())) {
        return wrong_program(index, "source",
                             "found " + quoted(program.source) +
                                 ", expected a variable of the type and size of " +
                                 quoted(program.target));
    }
    for (std::size_t i = 0; i < targets.size(); ++i) {
        plc_->steps_.emplace_back(program, targets[i].target(),
                                  sources[sources.size() == 1 ? 0 : i].target());
    }
    return {};
}

Configured<void> PlcBuilder::add_setting(std::size_t index,
                                         const std::vector<detail::PlcPlace>& targets)
{
    const PlcProgram& program = config_->programs[index];
    const auto set = program.sets.empty() ? std::vector<detail::PlcPlace>{} : finder_(program.sets);
    if (!program.sets.empty() &&
        (set.empty() ||
         !detail::PlcStep::accepts(PlcProgramKind::Increment, set.front().place->type))) {
        return wrong_program(index, "sets",
                             "found " + quoted(program.sets) + ", expected a variable of numbers");
    }
    for (const detail::PlcPlace& target : targets) {
        plc_->steps_.emplace_back(program, target.target(),
                                  set.empty() ? detail::PlcTarget{} : set.front().target());
        plc_->steps_.back().use(plc_->instructions());
    }
    return {};
}

Configured<void> PlcBuilder::add_events()
{
    for (std::size_t i = 0; i < config_->events.size(); ++i) {
        if (auto checked = check_event(i); !checked) {
            return checked;
        }
        const PlcEvent& event = config_->events[i];
        const auto places = finder_(event.variable);
        plc_->watches_.emplace_back(places.front().target(), event.limit);
        plc_->event_handles_.push_back(places.front().handle);
    }
    plc_->events_ = config_->events;
    plc_->occurrences_.reserve(config_->events.size());
    return {};
}

Configured<void> PlcBuilder::check_event(std::size_t index) const
{
    const PlcEvent& event = config_->events[index];
    const auto places = finder_(event.variable);
    if (places.size() != 1 || places.front().place == &system_place_) {
        return wrong_event(index, "variable",
                           "found " + quoted(event.variable) + ", expected a variable's name");
    }
    const server::ImagePlace& place = *places.front().place;
    if (place.is_array() || !detail::PlcWatch::accepts(place.type)) {
        return wrong_event(index, "variable",
                           "found " + quoted(event.variable) +
                               ", expected a scalar number or Boolean");
    }
    if (!std::isfinite(event.limit)) {
        return wrong_event(index, "limit", "expected a finite number");
    }
    if (event.severity < 1 || event.severity > 1000) {
        return wrong_event(index, "severity",
                           "found " + std::to_string(event.severity) + ", expected 1 to 1000");
    }
    return {};
}

} // namespace busbar::controller
