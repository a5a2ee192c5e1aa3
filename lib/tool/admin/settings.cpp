#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/types/data_types.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/nodes/node_feed.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value.hpp"
#include "tool/printing/value_type.hpp"

namespace busbar::tool::admin {

namespace settings {
namespace {

constexpr std::size_t max_settings = 10'000;
constexpr std::string_view root_name = "Settings.";

NodeId root_of(Connection& connection)
{
    return child_of(connection, standard(id::ObjectsFolder), "Settings");
}

/// Returns a setting or one of its properties: the NodeId contains the path.
NodeId node_of(const NodeId& root, std::string_view path)
{
    return NodeId{root.namespace_index(), String{std::string{root_name} + std::string{path}}};
}

struct Row {
    std::string name;
    Variant value;
    Variant otherwise;
    Variant range;
    Variant unit;
    bool is_changed{false};
    bool waits{false};
};

std::vector<Row> rows_of(Connection& connection, const NodeId& root,
                         const std::vector<std::string>& names)
{
    std::vector<NamedNode> nodes;
    for (const std::string& name : names) {
        for (const char* aspect : {"", ".Default", ".InstrumentRange", ".EngineeringUnits",
                                   ".IsChanged", ".WaitsForRestart"}) {
            nodes.push_back({name + aspect, node_of(root, name + aspect)});
        }
    }
    auto values = read_nodes(connection, nodes);
    std::vector<Row> rows;
    auto next = values.begin();
    const auto take = [&] { return std::move((next++)->value); };
    for (const std::string& name : names) {
        Row row{name, {}, {}, {}, {}};
        row.value = take();
        row.otherwise = take();
        row.range = take();
        row.unit = take();
        row.is_changed = take().value_or<bool>(false);
        row.waits = take().value_or<bool>(false);
        rows.push_back(std::move(row));
    }
    return rows;
}

/// Lists all names that begin with one of `parts`; all names if there are no parts.
std::vector<std::string> names_of(Connection& connection, const NodeId& root,
                                  const std::vector<std::string>& parts)
{
    std::vector<std::string> names;
    const auto below = variables_below(connection, {to_string(root)}, max_settings);
    for (const VariableBelow& variable : below.variables) {
        const std::string id = variable.node.address.text();
        const std::size_t found = id.find(root_name);
        if (found == std::string_view::npos) {
            continue;
        }
        const std::string name = id.substr(found + root_name.size());
        if (parts.empty() || std::any_of(parts.begin(), parts.end(), [&](const std::string& part) {
                return name.starts_with(part);
            })) {
            names.emplace_back(name);
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string unit_of(const Row& row)
{
    const auto* const object = row.unit.get_if<ExtensionObject>();
    const auto* const unit = object != nullptr ? object->get_if<EUInformation>() : nullptr;
    return unit != nullptr ? safe(unit->display_name.text.view()) : "";
}

std::string note_of(const Row& row)
{
    return row.waits ? "waits for a restart" : row.is_changed ? "changed" : "";
}

void append_json(JsonLine& json, const Row& row)
{
    json.open_object().member("name", row.name).key("value");
    tool::append_json(json, row.value, nullptr);
    json.key("default");
    tool::append_json(json, row.otherwise, nullptr);
    const auto* const object = row.range.get_if<ExtensionObject>();
    if (const auto* const range = object != nullptr ? object->get_if<Range>() : nullptr) {
        json.member("low", range->low).member("high", range->high);
    }
    json.member("unit", unit_of(row)).member("isChanged", row.is_changed);
    json.member("waitsForRestart", row.waits).close_object();
}

Exit list(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const NodeId root = root_of(connection);
    const auto names = names_of(connection, root, arguments.words);
    if (names.empty()) {
        throw Failure{Exit::Failed, "there are no such settings",
                      "give the beginning of their names, such as limits"};
    }
    JsonLine json;
    json.open_array();
    Table table{{{"SETTING", 20}, {"VALUE", 12, false, true}, {"UNIT"}, {"", 8}}};
    for (const Row& row : rows_of(connection, root, names)) {
        if (arguments.only_changed && !row.is_changed) {
            continue;
        }
        append_json(json, row);
        table.add(
            {{safe(row.name)}, {text_of(row.value, nullptr)}, {unit_of(row)}, {note_of(row)}});
    }
    return print_rows(context, json.close_array(), table, "No settings were changed");
}

/// Applies one set of changes; a null value takes a change back.
Exit change(Context& context, Connection& connection, const std::vector<std::string>& names,
            const std::vector<Variant>& values)
{
    const NodeId root = root_of(connection);
    Array<String> all;
    for (const std::string& name : names) {
        all.push_back(String{name});
    }
    const auto outputs =
        call(connection, root, child_of(connection, root, "Set"),
             {Variant{std::move(all)}, Variant{Array<Variant>{values}}}, "changing settings");
    if (outputs.size() != 2 || !outputs[0].value_or<bool>(false)) {
        throw Failure{Exit::Failed,
                      "nothing was changed: " +
                          (outputs.size() == 2 ? safe_line(outputs[1].value_or<String>({}).view())
                                               : "the answer is not one of settings"),
                      "see `busbar admin setting list`"};
    }
    std::string waiting;
    try {
        for (const Row& row : rows_of(connection, root, names)) {
            if (row.waits) {
                waiting += (waiting.empty() ? "" : ", ") + safe(row.name);
            }
        }
    } catch (const Failure& failure) {
        // They may change how clients connect, and who may.
        return report(context, "changed; whether they are in force cannot be read by the same "
                               "connection any more: " +
                                   std::string{failure.what()});
    }
    return report(context, waiting.empty() ? "changed and in force"
                                           : "changed; these wait for a restart: " + waiting);
}

Exit set(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const auto& words = arguments.words;
    if (words.empty() || words.size() % 2 != 0) {
        throw Failure{Exit::Usage, "expected pairs of a setting and a value",
                      "busbar admin setting set limits.sessions 20"};
    }
    const NodeId root = root_of(connection);
    std::vector<std::string> names;
    std::vector<Variant> values;
    for (std::size_t i = 0; i < words.size(); i += 2) {
        const auto like = read_attributes(connection, node_of(root, words[i]),
                                          {AttributeId::DataType, AttributeId::ValueRank});
        if (like[0].status.is_bad()) {
            throw Failure{like[0].status, safe(words[i]), "see `busbar admin setting list`"};
        }
        const auto type = value_type(connection, like[0].value.value_or<NodeId>({}),
                                     like[1].value.value_or<std::int32_t>(-1));
        names.push_back(words[i]);
        values.push_back(parse_value(words[i + 1], type, words[i]));
    }
    return change(context, connection, names, values);
}

Exit reset(Context& context, Connection& connection, const AdminArguments& arguments)
{
    if (arguments.words.empty()) {
        throw Failure{Exit::Usage, "no setting is given",
                      "see `busbar admin setting list --changed`"};
    }
    return change(context, connection, arguments.words,
                  std::vector<Variant>(arguments.words.size()));
}

} // namespace
} // namespace settings

void add_settings(CLI::App& admin, Run& run)
{
    using namespace settings;
    Group group{admin, run, "setting", "What a controller is set to."};
    group
        .add_any("list", "Lists settings, or those with names that begin with PART.", "URL PART",
                 list)
        ->add_flag("--changed", group.arguments().only_changed,
                   "only those that were changed online");
    group.add_any("set", "Changes settings: all of them, or none.", "URL NAME VALUE", set);
    group.add_any("reset", "Takes back what was changed of settings.", "URL NAME", reset);
}

} // namespace busbar::tool::admin
