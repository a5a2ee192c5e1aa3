#include "variable_facts.hpp"

#include <unordered_map>

#include <busbar/core/status_codes.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "names.hpp"
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

/// Reads the NodeClasses of the nodes without a DataType: those are not Variables.
void learn_classes(Connection& connection, const std::vector<NamedNode>& nodes,
                   const std::vector<DataValue>& data_types, std::vector<ValueFacts>& facts)
{
    std::vector<NamedNode> others;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (data_types[i].status == status::Bad_AttributeIdInvalid) {
            others.push_back(nodes[i]);
            places.push_back(i);
        }
    }
    if (others.empty()) {
        return;
    }
    const auto classes = read_nodes(connection, others, AttributeId::NodeClass);
    for (std::size_t i = 0; i < classes.size(); ++i) {
        facts[places[i]].node_class =
            static_cast<NodeClass>(classes[i].value.value_or<std::int32_t>(0));
    }
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
    learn_classes(connection, nodes, values, facts);
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

std::string reason_of_no_value(const ValueFacts& facts)
{
    const std::string_view what = name(facts.node_class);
    if (facts.node_class == NodeClass::Unspecified || what == "?") {
        return {};
    }
    const std::string article = what.starts_with('O') ? "an " : "a ";
    return "it is " + article + std::string{what} + ", which has no value";
}

Failure value_failure(const NamedNode& node, StatusCode status, const ValueFacts& facts)
{
    Failure failure = failure_of(node, status);
    const std::string reason = reason_of_no_value(facts);
    if (status != status::Bad_AttributeIdInvalid || reason.empty()) {
        return failure;
    }
    failure.reason = reason;
    if (facts.node_class == NodeClass::Object) {
        failure.hint = "`busbar watch --below` shows the Variables below it";
    } else if (facts.node_class == NodeClass::Method) {
        failure.hint = "`busbar call` calls it";
    }
    return failure;
}

} // namespace busbar::tool
