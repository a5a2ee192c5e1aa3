#include "variable_facts.hpp"

#include <unordered_map>

#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "tool/printing/display_text.hpp"

namespace busbar::tool {

namespace {

/// The texts of the properties EngineeringUnits; empty for a node without.
std::vector<std::string> units_of(Connection& connection, const std::vector<NamedNode>& nodes)
{
    std::vector<std::string> paths;
    std::vector<std::size_t> owners;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const auto path = nodes[i].id ? client::NodeAddress::path("/EngineeringUnits", *nodes[i].id)
                                      : fail(status::Bad_NodeIdUnknown);
        if (path) {
            paths.push_back(path->text());
            owners.push_back(i);
        }
    }
    std::vector<std::string> units(nodes.size());
    if (paths.empty()) {
        return units;
    }
    const auto values = read_nodes(connection, find_nodes(connection, paths));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto* const object = values[i].value.get_if<ExtensionObject>();
        const auto* const unit = object == nullptr ? nullptr : object->get_if<EUInformation>();
        if (unit != nullptr && values[i].status.is_good()) {
            units[owners[i]] = safe(unit->display_name.text.view());
        }
    }
    return units;
}

bool has_names(const NodeId& data_type)
{
    return !data_type.is_null() &&
           !(data_type.namespace_index() == 0 && data_type.is_numeric() &&
             data_type.numeric() <= static_cast<std::uint32_t>(BuiltInType::DiagnosticInfo));
}

} // namespace

std::vector<std::string> type_names(Connection& connection, const std::vector<NodeId>& types)
{
    std::vector<NamedNode> nodes;
    nodes.reserve(types.size());
    for (const NodeId& type : types) {
        nodes.push_back({"", type.is_null() ? Result<NodeId>{fail(status::Bad_NodeIdUnknown)}
                                            : Result<NodeId>{type}});
    }
    const auto values = read_nodes(connection, nodes, AttributeId::BrowseName);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < types.size(); ++i) {
        const auto* const name = values[i].value.get_if<QualifiedName>();
        names.push_back(name != nullptr      ? safe(name->name.view())
                        : types[i].is_null() ? std::string{}
                                             : safe(to_string(types[i])));
    }
    return names;
}

std::vector<ValueFacts> facts_of(Connection& connection, const std::vector<NamedNode>& nodes,
                                 FactsWanted wanted)
{
    std::vector<ValueFacts> facts(nodes.size());
    const auto values = read_nodes(connection, nodes, AttributeId::DataType);
    std::unordered_map<NodeId, std::string> known;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        facts[i].data_type = values[i].value.value_or<NodeId>({});
        if (!facts[i].data_type.is_null()) {
            known.try_emplace(facts[i].data_type);
        }
    }
    std::vector<NodeId> all;
    std::vector<NodeId> to_learn;
    for (const auto& [type, name] : known) {
        all.push_back(type);
        if (has_names(type)) {
            to_learn.push_back(type);
        }
    }
    if (!to_learn.empty()) {
        static_cast<void>(connection.types_of(to_learn));
    }
    if (wanted == FactsWanted::DataType) {
        return facts;
    }
    const auto names = type_names(connection, all);
    for (std::size_t i = 0; i < all.size(); ++i) {
        known[all[i]] = names[i];
    }
    const auto units = wanted == FactsWanted::All ? units_of(connection, nodes)
                                                  : std::vector<std::string>(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        facts[i].type_name = facts[i].data_type.is_null() ? "" : known[facts[i].data_type];
        const bool is_duration = facts[i].data_type == NodeId{0, id::Duration};
        facts[i].unit = units[i].empty() && is_duration ? "ms" : units[i];
    }
    return facts;
}

} // namespace busbar::tool
