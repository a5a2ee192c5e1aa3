#include "node_tables.hpp"

#include <algorithm>
#include <fstream>

#include <busbar/core/built_in_type.hpp>
#include <model/nodeset/node_flags.hpp>

#include "features.hpp"

namespace busbar::generator {

namespace {

using model::StaticIdentifier;
using model::StaticNode;
using model::StaticReference;
using model::StaticText;
using nodeset::is_type;
using nodeset::Node;
using nodeset::NodeClass;

constexpr std::uint32_t has_modelling_rule = basic_id::HasModellingRule;
constexpr std::uint32_t has_type_definition = basic_id::HasTypeDefinition;

/// Returns the id of the built-in type of a DataType; Number, Integer and UInteger have 26 to 28.
std::uint8_t built_in_id(const Hierarchy& hierarchy, const Node& node)
{
    if (node.node_class != NodeClass::DataType) {
        return 0;
    }
    for (const Node* at = &node; at != nullptr; at = hierarchy.supertype(at->id)) {
        const NodeId& id = at->id;
        if (id.namespace_index() != 0 || !id.is_numeric()) {
            continue;
        }
        if (id.numeric() == basic_id::Enumeration) {
            return static_cast<std::uint8_t>(BuiltInType::Int32);
        }
        if (id.numeric() == basic_id::Decimal) {
            return static_cast<std::uint8_t>(BuiltInType::ExtensionObject);
        }
        if (id.numeric() >= 1 && id.numeric() <= basic_id::UInteger) {
            return static_cast<std::uint8_t>(id.numeric());
        }
    }
    return 0;
}

} // namespace

StaticText Pool::add(const std::string& piece)
{
    const auto [at, is_new] = pieces_.try_emplace(piece);
    if (is_new) {
        at->second = {static_cast<std::uint32_t>(bytes_.size()),
                      static_cast<std::uint32_t>(piece.size())};
        bytes_ += piece;
    }
    return at->second;
}

NodeTableBuilder::NodeTableBuilder(const nodeset::Document& document, const Options& options)
    : document_{document}, options_{options}, hierarchy_{document}, values_{document,
                                                                            hierarchy_.data_types()}
{
}

Expected<NodeTables, Failure> NodeTableBuilder::build()
{
    if (auto selected = select(); !selected) {
        return Unexpected{selected.error()};
    }
    order();
    collect_links();
    for (const std::string& uri : document_.namespaces()) {
        tables_.namespaces.push_back(tables_.text.add(uri));
    }
    for (const Node* node : ordered_) {
        if (auto added = add_node(*node); !added) {
            return Unexpected{added.error()};
        }
    }
    fill_slots();
    for (const nodeset::Model& model : document_.models()) {
        if (model.uri == options_.namespace_uri && namespace_ != 0) {
            tables_.restrictions = model.access_restrictions.value_or(0);
        }
    }
    return std::move(tables_);
}

Expected<void, Failure> NodeTableBuilder::select()
{
    const auto index = document_.namespace_index(options_.namespace_uri);
    if (!index) {
        return Unexpected{"no file has the namespace " + options_.namespace_uri};
    }
    namespace_ = *index;
    std::set<NodeId> listed;
    if (!options_.node_list.empty()) {
        std::ifstream file{options_.node_list};
        if (!file) {
            return Unexpected{options_.node_list + ": cannot be opened"};
        }
        std::string row;
        for (std::size_t line = 1; std::getline(file, row); ++line) {
            if (row.empty() || row.front() == '#') {
                continue;
            }
            // A number alone is a numeric NodeId of the namespace.
            const bool is_number = row.find_first_not_of("0123456789") == std::string::npos;
            auto id = NodeId::parse(is_number ? "i=" + row : row);
            if (!id) {
                return Unexpected{options_.node_list + ":" + std::to_string(line) + ": found \"" +
                                  row + "\", expected a NodeId"};
            }
            id->set_namespace_index(namespace_);
            listed.insert(*id);
        }
    }
    auto others = nodes_of_other_features(document_, options_);
    if (!others) {
        return Unexpected{others.error()};
    }
    if (options_.is_addition) {
        return select_addition(*std::move(others));
    }
    for (const Node& node : document_.nodes()) {
        if (node.id.namespace_index() == namespace_ && others->count(node.id) == 0 &&
            (options_.node_list.empty() || listed.count(node.id) != 0)) {
            selected_.emplace(node.id, &node);
        }
    }
    return {};
}

/// Selects the nodes that are left out without the features but not with them.
Expected<void, Failure> NodeTableBuilder::select_addition(std::set<NodeId> others)
{
    Options without = options_;
    without.features = options_.given;
    const auto all = nodes_of_other_features(document_, without);
    if (!all) {
        return Unexpected{all.error()};
    }
    others_ = std::move(others);
    for (const Node& node : document_.nodes()) {
        if (all->count(node.id) != 0 && others_.count(node.id) == 0) {
            selected_.emplace(node.id, &node);
        }
    }
    return {};
}

bool NodeTableBuilder::is_left_out(const NodeId& id) const
{
    if (options_.is_addition) {
        return others_.count(id) != 0;
    }
    return id.namespace_index() == namespace_ && !is_emitted(id);
}

/// Types first, each directly before its subtypes; then the others by their ids.
void NodeTableBuilder::order()
{
    std::vector<const Node*> roots;
    std::vector<const Node*> others;
    for (const Node& node : document_.nodes()) {
        if (selected_.count(node.id) == 0) {
            continue;
        }
        if (!is_type(node)) {
            others.push_back(&node);
            continue;
        }
        const Node* above = hierarchy_.supertype(node.id);
        while (above != nullptr && selected_.count(above->id) == 0) {
            above = hierarchy_.supertype(above->id);
        }
        (above == nullptr ? roots : subtypes_[above->id]).push_back(&node);
    }
    for (const Node* root : roots) {
        order_below(*root);
    }
    std::sort(others.begin(), others.end(),
              [](const Node* a, const Node* b) { return a->id < b->id; });
    for (const Node* node : others) {
        indices_.emplace(node->id, static_cast<std::uint32_t>(ordered_.size()));
        ordered_.push_back(node);
    }
}

void NodeTableBuilder::order_below(const Node& type)
{
    const auto own = static_cast<std::uint32_t>(ordered_.size());
    indices_.emplace(type.id, own);
    ordered_.push_back(&type);
    lasts_.push_back(own);
    for (const Node* subtype : subtypes_[type.id]) {
        order_below(*subtype);
    }
    lasts_[own] = static_cast<std::uint32_t>(ordered_.size() - 1);
}

void NodeTableBuilder::collect_links()
{
    for (const Node& node : document_.nodes()) {
        for (const nodeset::Reference& reference : node.references) {
            const NodeId& source = reference.is_forward ? node.id : reference.target;
            const NodeId& target = reference.is_forward ? reference.target : node.id;
            add_link(source, reference.type, target);
        }
    }
}

void NodeTableBuilder::add_link(const NodeId& source, const NodeId& type, const NodeId& target)
{
    if ((!is_emitted(source) && !is_emitted(target)) || is_left_out(source) ||
        is_left_out(target) || is_left_out(type) ||
        !known_links_.emplace(source, type, target).second) {
        return;
    }
    if (is_emitted(source)) {
        auto& links = links_[source];
        // A service asks for the type definition more often than for anything else.
        links.insert(type.is(has_type_definition) ? links.begin() : links.end(),
                     Link{type, target, true});
    }
    if (is_emitted(target) && !type.is(has_type_definition) && !type.is(has_modelling_rule)) {
        links_[target].push_back(Link{type, source, false});
    }
}

StaticIdentifier NodeTableBuilder::identifier(const NodeId& id)
{
    if (id.is_numeric()) {
        return {id.numeric(), id.namespace_index(), model::StaticIdKind::Numeric};
    }
    NodeId bare = id;
    bare.set_namespace_index(0);
    tables_.texts.push_back(tables_.text.add(to_string(bare)));
    return {static_cast<std::uint32_t>(tables_.texts.size() - 1), id.namespace_index(),
            model::StaticIdKind::Text};
}

std::uint32_t NodeTableBuilder::index(const NodeId& id)
{
    if (const auto found = indices_.find(id); found != indices_.end()) {
        return found->second;
    }
    const auto [at, is_new] =
        externals_.try_emplace(id, static_cast<std::uint32_t>(ordered_.size() + externals_.size()));
    if (is_new) {
        tables_.externals.push_back(identifier(id));
    }
    return at->second;
}

Expected<void, Failure> NodeTableBuilder::add_node(const Node& node)
{
    StaticNode entry;
    entry.id = identifier(node.id);
    entry.browse_name = tables_.text.add(node.browse_name);
    entry.browse_namespace = node.browse_namespace;
    entry.node_class = static_cast<std::uint8_t>(node.node_class);
    entry.flags = nodeset::flags(node);
    entry.event_notifier = node.event_notifier;
    entry.first_reference = static_cast<std::uint32_t>(tables_.references.size());
    const auto at = details(node);
    if (!at) {
        return Unexpected{at.error()};
    }
    entry.details = *at;
    if (is_type(node)) {
        tables_.types.push_back({lasts_[tables_.nodes.size()], built_in_id(hierarchy_, node)});
    }
    add_extras(node);
    add_access(node);
    tables_.nodes.push_back(entry);
    return add_references(node);
}

Expected<std::uint32_t, Failure> NodeTableBuilder::details(const Node& node)
{
    if (node.node_class == NodeClass::Variable || node.node_class == NodeClass::VariableType) {
        return variable(node);
    }
    StaticText piece;
    if (node.node_class == NodeClass::ReferenceType) {
        piece = tables_.text.add(node.inverse_name.text);
    } else if (node.node_class == NodeClass::DataType) {
        const auto definition = values_.definition(node);
        if (!definition) {
            return Unexpected{definition.error()};
        }
        piece = tables_.values.add(*definition);
    }
    if (piece.size == 0) {
        return model::no_details;
    }
    tables_.texts.push_back(piece);
    return static_cast<std::uint32_t>(tables_.texts.size() - 1);
}

Expected<std::uint32_t, Failure> NodeTableBuilder::variable(const Node& node)
{
    const auto value = values_.value(node);
    if (!value) {
        return Unexpected{value.error()};
    }
    model::StaticVariable entry;
    entry.data_type = index(node.data_type);
    entry.value_rank = node.value_rank;
    entry.array_dimensions = {static_cast<std::uint32_t>(tables_.dimensions.size()),
                              static_cast<std::uint32_t>(node.array_dimensions.size())};
    tables_.dimensions.insert(tables_.dimensions.end(), node.array_dimensions.begin(),
                              node.array_dimensions.end());
    entry.value = tables_.values.add(*value);
    entry.minimum_sampling_interval = node.minimum_sampling_interval;
    entry.access_level = node.node_class == NodeClass::Variable
                             ? static_cast<std::uint8_t>(node.access_level)
                             : std::uint8_t{0};
    tables_.variables.push_back(entry);
    return static_cast<std::uint32_t>(tables_.variables.size() - 1);
}

Expected<void, Failure> NodeTableBuilder::add_references(const Node& node)
{
    for (const Link& link : links_[node.id]) {
        const auto [type, is_new] = reference_types_.try_emplace(
            link.type, static_cast<std::uint32_t>(reference_types_.size()));
        if (is_new) {
            tables_.reference_types.push_back(index(link.type));
        }
        const std::uint32_t target = index(link.target);
        if (type->second > StaticReference::max_type || target > StaticReference::max_target) {
            return Unexpected{"more than 256 ReferenceTypes or 8 million nodes"};
        }
        tables_.references.emplace_back(type->second, target, link.is_forward);
    }
    return {};
}

void NodeTableBuilder::add_extras(const Node& node)
{
    using ExtraKind = model::StaticExtra::Kind;
    const auto own = static_cast<std::uint32_t>(tables_.nodes.size());
    const auto add = [&](ExtraKind kind, const std::string& text) {
        if (!text.empty()) {
            tables_.extras.push_back({own, kind, tables_.text.add(text)});
        }
    };
    const nodeset::LocalizedText& display = node.display_name;
    const bool is_plain = display.locale.empty() && display.text == node.browse_name;
    add(ExtraKind::DisplayName, is_plain ? std::string{} : display.text);
    add(ExtraKind::Description, node.description.text);
    add(ExtraKind::DisplayNameLocale, display.locale);
    add(ExtraKind::DescriptionLocale, node.description.locale);
    if (node.node_class == NodeClass::ReferenceType) {
        add(ExtraKind::InverseNameLocale, node.inverse_name.locale);
    }
}

void NodeTableBuilder::add_access(const Node& node)
{
    const bool is_variable = node.node_class == nodeset::NodeClass::Variable;
    model::StaticAccess entry;
    entry.node = static_cast<std::uint32_t>(tables_.nodes.size());
    entry.write_mask = node.write_mask;
    entry.more_access_levels = is_variable ? node.access_level & ~std::uint32_t{UINT8_MAX} : 0;
    entry.has_restrictions = node.access_restrictions.has_value();
    entry.restrictions = node.access_restrictions.value_or(0);
    entry.role_permissions = tables_.values.add(NodeValues::permissions(node));
    if (entry.write_mask != 0 || entry.more_access_levels != 0 || entry.has_restrictions ||
        entry.role_permissions.size != 0) {
        tables_.access.push_back(entry);
    }
}

/// Namespace 0 is looked up where it lies; nodes of others are copied.
void NodeTableBuilder::fill_slots()
{
    if (namespace_ != 0 || options_.is_addition || tables_.nodes.size() >= UINT16_MAX) {
        return;
    }
    std::size_t size = 64;
    while (size < tables_.nodes.size() * 2) {
        size *= 2;
    }
    tables_.slots.resize(size);
    for (std::size_t i = 0; i < tables_.nodes.size(); ++i) {
        std::size_t at = model::static_slot(tables_.nodes[i].id.value, size);
        while (tables_.slots[at] != 0) {
            at = (at + 1) & (size - 1);
        }
        tables_.slots[at] = static_cast<std::uint16_t>(i + 1);
    }
}

} // namespace busbar::generator
