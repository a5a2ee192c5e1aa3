#include <algorithm>

#include <busbar/controller/mapping_check.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::controller {

namespace {

using model::NodeIndex;

enum Below : std::uint8_t {
    below_objects = 1,
    below_types = 2,
    below_server = 4,
    below_aliases = 8,
    below_method = 16,
};

/// Finds the nodes below several roots, one after another; visits each node once per root.
class Walk {
public:
    explicit Walk(const model::SpaceReader& space)
        : hierarchical_{space.find(id::HierarchicalReferences)},
          event_source_{space.find(id::HasEventSource)}, space_{space}
    {
        std::size_t end = 0;
        space.for_each([&](NodeIndex node) { end = std::max(end, position(node) + 1); });
        below_.resize(end);
        level_.resize(end);
        below_from({space.find(id::ObjectsFolder)}, below_objects, true);
        below_from({space.find(id::TypesFolder)}, below_types, false);
        below_from({space.find(id::Server)}, below_server, false);
        below_from({space.find(id::Aliases)}, below_aliases, false);
        std::vector<NodeIndex> methods;
        space.for_each([&](NodeIndex node) {
            if (space.node_class(node) == NodeClass::Method) {
                methods.push_back(node);
            }
        });
        below_methods(methods);
    }

    [[nodiscard]] static std::size_t position(NodeIndex node)
    {
        return static_cast<std::size_t>(node);
    }
    [[nodiscard]] std::size_t size() const { return below_.size(); }
    [[nodiscard]] bool is(NodeIndex node, Below what) const
    {
        return (below_[position(node)] & what) != 0;
    }
    [[nodiscard]] std::uint32_t level(NodeIndex node) const { return level_[position(node)]; }

private:
    /// Marks the existing roots and all nodes below them.
    void below_from(std::vector<NodeIndex> queue, Below what, bool with_levels)
    {
        queue.erase(std::remove(queue.begin(), queue.end(), model::no_node), queue.end());
        for (const NodeIndex root : queue) {
            mark(root, what);
        }
        for (std::size_t next = 0; next < queue.size(); ++next) {
            const NodeIndex parent = queue[next];
            for_each_below(parent, [&](NodeIndex child) {
                if (is(child, what)) {
                    return;
                }
                mark(child, what);
                if (with_levels) {
                    level_[position(child)] = level(parent) + 1;
                }
                queue.push_back(child);
            });
        }
    }
    void below_methods(const std::vector<NodeIndex>& methods)
    {
        std::vector<NodeIndex> first;
        for (const NodeIndex method : methods) {
            for_each_below(method, [&](NodeIndex child) { first.push_back(child); });
        }
        below_from(std::move(first), below_method, false);
    }
    void mark(NodeIndex node, Below what)
    {
        below_[position(node)] = static_cast<std::uint8_t>(below_[position(node)] | what);
    }
    void for_each_below(NodeIndex parent, FunctionRef<void(NodeIndex)> visit) const
    {
        model::ReferenceCursor cursor = space_.references(parent);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward && space_.is_subtype_of(reference->type, hierarchical_) &&
                !space_.is_subtype_of(reference->type, event_source_)) {
                visit(reference->target);
            }
        }
    }

    NodeIndex hierarchical_;
    NodeIndex event_source_;
    const model::SpaceReader& space_;
    std::vector<std::uint8_t> below_;
    std::vector<std::uint32_t> level_;
};

/// Marks the namespaces, by index, that models require.
std::vector<bool> required_namespaces(const model::SpaceReader& space,
                                      const std::vector<std::string>& required)
{
    std::vector<bool> result(space.namespace_count());
    for (const std::string& uri : required) {
        if (const auto index = space.namespace_index(uri)) {
            result[*index] = true;
        }
    }
    return result;
}

bool is_arguments(const model::SpaceReader& space, const Walk& walk, NodeIndex node)
{
    const QualifiedName name = space.browse_name(node);
    return walk.is(node, below_method) && name.namespace_index == 0 &&
           (name.name == String{"InputArguments"} || name.name == String{"OutputArguments"});
}

NodePlace place_of(const model::SpaceReader& space, const Walk& walk,
                   const std::vector<bool>& required, NodeIndex node)
{
    const std::uint16_t index = space.node_id(node).namespace_index();
    if (index == 0) {
        return NodePlace::StandardNode;
    }
    if (walk.is(node, below_server)) {
        return NodePlace::BelowServer;
    }
    if (walk.is(node, below_aliases)) {
        return NodePlace::BelowAliases;
    }
    if (!walk.is(node, below_objects) || walk.is(node, below_types)) {
        return NodePlace::NotBelowObjects;
    }
    if (required[index]) {
        return NodePlace::RequiredNamespace;
    }
    const NodeClass node_class = space.node_class(node);
    if (node_class != NodeClass::Variable && node_class != NodeClass::Method) {
        return NodePlace::WrongNodeClass;
    }
    return is_arguments(space, walk, node) ? NodePlace::ArgumentsProperty : NodePlace::Mappable;
}

} // namespace

NodePlaces::NodePlaces(const model::SpaceReader& space, const std::vector<std::string>& required)
{
    const Walk walk{space};
    const auto namespaces = required_namespaces(space, required);
    entries_.resize(walk.size());
    space.for_each([&](NodeIndex node) {
        Entry& entry = entries_[Walk::position(node)];
        entry.place = place_of(space, walk, namespaces, node);
        entry.level = walk.level(node);
        entry.is_counted = space.node_class(node) == NodeClass::Variable &&
                           walk.is(node, below_objects) && !walk.is(node, below_server) &&
                           !walk.is(node, below_aliases) && !walk.is(node, below_method);
        // Levels are limited only outside Server's own nodes (SH-082679, 2.1, note 5).
        entry.level = walk.is(node, below_server) ? 0 : entry.level;
    });
}

NodePlace NodePlaces::of(model::NodeIndex node) const
{
    return entries_[Walk::position(node)].place;
}

bool NodePlaces::is_counted(model::NodeIndex node) const
{
    return entries_[Walk::position(node)].is_counted;
}

std::uint32_t NodePlaces::level(model::NodeIndex node) const
{
    return entries_[Walk::position(node)].level;
}

} // namespace busbar::controller
