#include "sections.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <initializer_list>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include <busbar/controller/plc.hpp>

#include "limit_keys.hpp"
#include "plc_trial.hpp"

namespace busbar::product {

namespace {

using controller::PlcEvent;
using controller::PlcProgram;
using controller::PlcProgramKind;
using controller::PlcVariable;

std::uint32_t elements_of(const PlcVariable& variable)
{
    return std::accumulate(variable.dimensions.begin(), variable.dimensions.end(), 1U,
                           std::multiplies<>{});
}

BuiltInType read_type(const TomlTable& table)
{
    const std::string text = table.text("type");
    for (std::uint8_t id = 1; id <= last_built_in_type; ++id) {
        if (name(static_cast<BuiltInType>(id)) == text) {
            return static_cast<BuiltInType>(id);
        }
    }
    table.fail("type", "a built-in type such as Boolean, Int16, Double or String");
}

Variant initial_value(const toml::node& node)
{
    if (const auto value = node.value_exact<bool>()) {
        return Variant{*value};
    }
    if (const auto value = node.value_exact<std::int64_t>()) {
        return Variant{*value};
    }
    if (const auto value = node.value_exact<double>()) {
        return Variant{*value};
    }
    if (const auto value = node.value_exact<std::string>()) {
        return Variant{String{*value}};
    }
    return {};
}

PlcVariable read_variable(const TomlTable& table, const server::ServerLimits& limits)
{
    table.allow({"name", "type", "dimensions", "count", "initial", "access", "capacity"});
    PlcVariable variable;
    variable.name = table.text("name");
    variable.type = read_type(table);
    for (const std::int64_t size : table.integers("dimensions", 1, most_elements)) {
        variable.dimensions.push_back(static_cast<std::uint32_t>(size));
    }
    variable.count = static_cast<std::uint32_t>(table.integer("count", 0, 0, 1'000'000));
    if (!variable.name.empty()) {
        check_name(table, "name",
                   variable.count == 0 ? variable.name
                                       : variable.name + std::to_string(variable.count - 1));
    }
    variable.capacity = static_cast<std::uint32_t>(table.integer("capacity", 80, 1, 1'000'000));
    if (const toml::node* node = table.node("initial")) {
        variable.initial = initial_value(*node);
        if (variable.initial.is_null()) {
            table.fail("initial", "true, false, a number or a text");
        }
    }
    const std::string access = table.text("access", "write");
    if (access != "read" && access != "write") {
        table.fail("access", "\"read\" or \"write\"");
    }
    variable.is_writable = access == "write";
    check_size(table, variable, limits);
    return variable;
}

PlcProgram read_plc_program(const TomlTable& table)
{
    static constexpr std::array<std::pair<std::string_view, PlcProgramKind>, 7> kinds = {
        {{"increment", PlcProgramKind::Increment},
         {"sine", PlcProgramKind::Sine},
         {"toggle", PlcProgramKind::Toggle},
         {"copy", PlcProgramKind::Copy},
         {"acknowledge", PlcProgramKind::Acknowledge},
         {"shutdown", PlcProgramKind::Shutdown},
         {"plc_error", PlcProgramKind::PlcError}}};
    table.allow({"kind", "target", "source", "period_ms", "amplitude", "offset", "sets", "to"});
    PlcProgram program;
    const std::string text = table.text("kind");
    const auto* kind = std::find_if(kinds.begin(), kinds.end(),
                                    [&](const auto& known) { return known.first == text; });
    if (kind == kinds.end()) {
        table.fail("kind", "increment, sine, toggle, copy, acknowledge, shutdown or plc_error");
    }
    program.kind = kind->second;
    program.target = table.text("target");
    program.source = table.text("source", "");
    program.period = std::chrono::milliseconds{table.integer("period_ms", 0, 0, 86'400'000)};
    program.amplitude = table.number("amplitude", 1);
    program.offset = table.number("offset", 0);
    program.sets = table.text("sets", "");
    program.to = table.number("to", 0);
    return program;
}

PlcEvent read_event(const TomlTable& table)
{
    table.allow({"variable", "limit", "severity", "message"});
    PlcEvent event;
    event.variable = table.text("variable");
    event.limit = table.number("limit", 0);
    event.severity = static_cast<std::uint16_t>(table.integer("severity", 500, 1, 1000));
    event.message = table.text("message");
    return event;
}

/// The tables of one kind, with the name of their list in a PlcConfig.
struct Entries {
    std::string_view list;
    const std::vector<TomlTable>& tables;
};

/// Finds the table and the key of "variables[2].type"; nothing if it belongs to another list.
std::optional<std::pair<TomlTable, std::string>> find_entry(std::string_view where,
                                                            const Entries& entries)
{
    const std::size_t end = where.find("].");
    if (!where.starts_with(entries.list) || end == std::string_view::npos) {
        return std::nullopt;
    }
    std::size_t index = 0;
    const std::string_view number = where.substr(entries.list.size() + 1);
    static_cast<void>(std::from_chars(number.data(), where.data() + end, index));
    const std::string_view field = where.substr(end + 2);
    return index < entries.tables.size()
               ? std::optional{std::pair{entries.tables[index],
                                         std::string{field == "period" ? "period_ms" : field}}}
               : std::nullopt;
}

/// Throws at the place in the configuration that the problem is about.
[[noreturn]] void fail(const Problem& problem, std::initializer_list<Entries> lists)
{
    static constexpr std::string_view expected = "expected ";
    for (const Entries& entries : lists) {
        if (const auto entry = find_entry(problem.where, entries)) {
            const auto& [table, key] = *entry;
            if (problem.text.starts_with(expected)) {
                table.fail(key, problem.text.substr(expected.size()));
            }
            table.refuse(key, problem.text);
        }
    }
    throw ConfigError{problem};
}

} // namespace

void read_plc(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"scan_ms", "realtime_priority", "queued_scans", "waiting_writes", "variable",
                 "program", "event"});
    read_numbers(table, "plc", config);
    const auto variables = table.tables("variable");
    const auto programs = table.tables("program");
    for (const TomlTable& entry : variables) {
        config.plc.variables.push_back(read_variable(entry, config.server.limits));
    }
    for (const TomlTable& entry : programs) {
        config.plc.programs.push_back(read_plc_program(entry));
        const PlcProgramKind kind = config.plc.programs.back().kind;
        if (!config.machine.program &&
            (kind == PlcProgramKind::Shutdown || kind == PlcProgramKind::PlcError)) {
            entry.refuse("kind", "found " + entry.text("kind") +
                                     ", expected it with a program in [machine] only");
        }
    }
    for (const PlcVariable& variable : config.plc.variables) {
        // Allow a change for each element of a text, so that all can be written at once.
        config.image.max_changes_per_scan =
            std::max(config.image.max_changes_per_scan, elements_of(variable));
    }
    const auto events = table.tables("event");
    for (const TomlTable& entry : events) {
        if (config.labels.has_plc()) {
            entry.refuse("variable", "found an event, expected none of a program of labels");
        }
        config.plc.events.push_back(read_event(entry));
    }
    auto& tried = table.sources().tried();
    PlcTrial trial{config};
    if (tried != nullptr && *tried == trial) {
        return;
    }
    if (const auto done = trial.run(); !done) {
        fail(done.error(), {{"variables", variables}, {"programs", programs}, {"events", events}});
    }
    tried = std::make_shared<const PlcTrial>(std::move(trial));
}

} // namespace busbar::product
