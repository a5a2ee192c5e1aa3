#include "node_changes.hpp"

#include <array>

#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

namespace {

constexpr unsigned bit(NodeClass node_class)
{
    return static_cast<unsigned>(node_class);
}

constexpr unsigned object = bit(NodeClass::Object);
constexpr unsigned variable = bit(NodeClass::Variable);
constexpr unsigned method = bit(NodeClass::Method);
constexpr unsigned object_type = bit(NodeClass::ObjectType);
constexpr unsigned variable_type = bit(NodeClass::VariableType);
constexpr unsigned data_type = bit(NodeClass::DataType);
constexpr unsigned view = bit(NodeClass::View);
constexpr unsigned all = 255;

/// NodeClasses that references of a type, or of a subtype, may connect.
struct Rule {
    std::uint32_t type;
    unsigned sources;
    unsigned targets;
};

/// A type may appear twice, with other targets for other sources.
constexpr std::array reference_rules{
    Rule{id::HasComponent, object | object_type, object | variable | method}, // Part 3, 7.7
    Rule{id::HasComponent, variable | variable_type, variable},
    Rule{id::HasProperty, all, variable},                                        // Part 3, 7.8
    Rule{id::Organizes, object | object_type | view, all},                       // Part 3, 7.11
    Rule{id::HasModellingRule, object | variable | method, object},              // Part 3, 7.12
    Rule{id::HasEncoding, data_type, object},                                    // Part 3, 7.14
    Rule{id::GeneratesEvent, object_type | variable_type | method, object_type}, // Part 3, 7.15
    Rule{id::HasEventSource, object | view, all},                                // Part 3, 7.17
    Rule{id::HasNotifier, object | view, object},                                // Part 3, 7.18
};

bool is_property(const model::AddressSpace& space, const ReferenceEnd& end)
{
    return end.node_class == NodeClass::Variable &&
           space.is_subtype_of(end.type_definition, id::PropertyType);
}

/// The target of HasProperty is a property, which has none itself and is never a component (Part 3,
/// 4.5.2).
bool keeps_properties_apart(const model::AddressSpace& space, model::NodeIndex type,
                            const ReferenceEnd& source, const ReferenceEnd& target)
{
    if (space.is_subtype_of(type, id::HasProperty)) {
        return is_property(space, target) && !is_property(space, source);
    }
    return !space.is_subtype_of(type, id::HasComponent) || !is_property(space, target);
}

} // namespace

ReferenceEnd reference_end(const model::AddressSpace& space, model::NodeIndex node)
{
    return {space.node_class(node), space.type_definition(node)};
}

StatusCode check_ends(const model::AddressSpace& space, model::NodeIndex type,
                      const ReferenceEnd& source, const ReferenceEnd& target)
{
    bool has_rule = false;
    bool fits = false;
    // The most specific rule is the last one: HasNotifier is a HasEventSource.
    std::uint32_t rule_type = 0;
    for (const Rule& rule : reference_rules) {
        if (!space.is_subtype_of(type, rule.type)) {
            continue;
        }
        fits = (rule.type == rule_type && fits) || ((rule.sources & bit(source.node_class)) != 0 &&
                                                    (rule.targets & bit(target.node_class)) != 0);
        rule_type = rule.type;
        has_rule = true;
    }
    const bool is_allowed =
        (!has_rule || fits) && keeps_properties_apart(space, type, source, target);
    return is_allowed ? status::Good : status::Bad_ReferenceNotAllowed;
}

} // namespace busbar::server::detail
