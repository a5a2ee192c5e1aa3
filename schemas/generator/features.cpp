#include "features.hpp"

#include <algorithm>
#include <fstream>
#include <unordered_map>
#include <vector>

#include <model/nodeset/node_flags.hpp>

#include "hierarchy.hpp"

namespace busbar::generator {

namespace {

using nodeset::Node;
using Children = std::unordered_map<NodeId, std::vector<NodeId>>;

bool leads_down(const NodeId& type)
{
    return type.is(basic_id::HasComponent) || type.is(basic_id::HasOrderedComponent) ||
           type.is(basic_id::HasProperty) || type.is(basic_id::Organizes);
}

/// Instances below instances, whichever end names the reference.
Children children_of_instances(const nodeset::Document& document)
{
    Children children;
    for (const Node& node : document.nodes()) {
        for (const nodeset::Reference& reference : node.references) {
            if (leads_down(reference.type)) {
                const bool is_forward = reference.is_forward;
                children[is_forward ? node.id : reference.target].push_back(
                    is_forward ? reference.target : node.id);
            }
        }
    }
    for (const Node& node : document.nodes()) {
        if (nodeset::is_type(node)) {
            children.erase(node.id);
        }
    }
    return children;
}

/// One row's NodeId: a numeric one of namespace 0.
Expected<NodeId, Failure> parse_row(const std::string& place, const std::string& row)
{
    const std::size_t comma = row.find(',');
    auto id = comma == std::string::npos ? Result<NodeId>{fail(status::Bad_NodeIdInvalid)}
                                         : NodeId::parse("i=" + row.substr(comma + 1));
    if (!id) {
        return Unexpected{place + ": found \"" + row +
                          "\", expected a feature, a comma and the number of a NodeId"};
    }
    return *std::move(id);
}

bool has(const std::vector<std::string>& names, const std::string& name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace

Expected<std::set<NodeId>, Failure> nodes_of_other_features(const nodeset::Document& document,
                                                            const Options& options)
{
    std::set<NodeId> left_out;
    if (options.features_file.empty()) {
        return left_out;
    }
    std::ifstream file{options.features_file};
    if (!file) {
        return Unexpected{options.features_file + ": cannot be opened"};
    }
    std::vector<NodeId> open;
    std::set<std::string> known;
    std::string row;
    std::getline(file, row); // the header
    for (std::size_t line = 2; std::getline(file, row); ++line) {
        auto id = parse_row(options.features_file + ":" + std::to_string(line), row);
        if (!id) {
            return Unexpected{id.error()};
        }
        const std::string& feature = *known.insert(row.substr(0, row.find(','))).first;
        if (!has(options.features, feature) && !has(options.given, feature)) {
            open.push_back(*std::move(id));
        }
    }
    for (const auto* names : {&options.features, &options.given}) {
        for (const std::string& feature : *names) {
            if (known.count(feature) == 0) {
                return Unexpected{options.features_file + ": found no feature " + feature};
            }
        }
    }
    const Children children = children_of_instances(document);
    while (!open.empty()) {
        const NodeId id = open.back();
        open.pop_back();
        const auto below = children.find(id);
        if (left_out.insert(id).second && below != children.end()) {
            open.insert(open.end(), below->second.begin(), below->second.end());
        }
    }
    return left_out;
}

} // namespace busbar::generator
