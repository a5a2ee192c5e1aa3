#include "instantiation.hpp"

#include <algorithm>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::model::detail {

NodeIndex child_of(const SpaceReader& space, NodeIndex parent, const QualifiedName& name)
{
    NodeIndex found = no_node;
    static_cast<void>(space.for_each_child(parent, space.find(id::HierarchicalReferences), true,
                                           name, [&](NodeIndex child) {
                                               found = child;
                                               return false;
                                           }));
    return found;
}

Result<NodeIndex> Instantiation::create(const NewNode& node, NodeIndex type)
{
    busbar::detail::Undo undone{[this] { undo(); }};
    const auto root = create_root(node, type);
    if (!root) {
        return root;
    }
    if (const auto noted = note_created(*root); !noted) {
        return fail(noted.error());
    }
    if (const auto done = complete(*root, type); !done) {
        return fail(done.error());
    }
    undone.keep();
    return root;
}

Result<void> Instantiation::extend(NodeIndex object, NodeIndex interface_type)
{
    busbar::detail::Undo undone{[this] { undo(); }};
    if (auto done = reference(object, space_.find(id::HasInterface), interface_type); !done) {
        return done;
    }
    undone.keep();
    return complete(object, interface_type);
}

Result<void> Instantiation::complete(NodeIndex instance, NodeIndex type)
{
    busbar::detail::Undo undone{[this] { undo(); }};
    Result<void> done = add_members(instance, with_types({}, type), {}, 1);
    if (done) {
        done = add_other_references();
    }
    if (done) {
        done = check_paths();
    }
    if (done) {
        undone.keep();
    }
    return done;
}

/// Returns the sources followed by the type and its supertypes, in a new scope.
std::vector<DeclarationSource> Instantiation::with_types(std::vector<DeclarationSource> sources,
                                                         NodeIndex type)
{
    const std::uint32_t scope = ++last_scope_;
    for (const NodeIndex above : types_above(space_, type)) {
        sources.push_back({above, scope});
    }
    return sources;
}

Result<void> Instantiation::add_members(NodeIndex parent,
                                        std::span<const DeclarationSource> sources,
                                        const std::string& path, std::size_t depth)
{
    for (const DeclaredMember& member : members_of(space_, sources)) {
        std::string own_path = path.empty() ? path : path + '/';
        own_path += space_.browse_name(member.declaration()).name.view();
        if (!is_wanted(member, own_path)) {
            continue;
        }
        if (auto added = add_member(parent, member, own_path, depth); !added) {
            return added;
        }
    }
    return {};
}

Result<void> Instantiation::add_member(NodeIndex parent, const DeclaredMember& member,
                                       const std::string& path, std::size_t depth)
{
    if (depth > options_.limits.max_depth) {
        return fail(status::Bad_TooManyOperations);
    }
    if (const NodeIndex known = instance_of(member); known != no_node) {
        return reference(parent, member.reference_type, known);
    }
    NodeIndex node = child_of(space_, parent, space_.browse_name(member.declaration()));
    if (node == no_node) {
        const auto copied = copy(parent, member, path);
        if (!copied) {
            return fail(copied.error());
        }
        node = *copied;
    }
    for (const DeclarationSource& declaration : member.declarations) {
        instances_.emplace(declaration, node);
    }
    if (space_.node_class(node) == NodeClass::Method) {
        return {};
    }
    std::vector<DeclarationSource> sources = member.declarations;
    for (const DeclarationSource& declaration : member.declarations) {
        for (const NodeIndex implemented : interfaces_of(space_, declaration.node)) {
            sources = with_types(std::move(sources), implemented);
            if (auto added = reference(node, space_.find(id::HasInterface), implemented); !added) {
                return added;
            }
        }
    }
    return add_members(node, with_types(std::move(sources), space_.type_definition(node)), path,
                       depth + 1);
}

bool Instantiation::is_wanted(const DeclaredMember& member, const std::string& path)
{
    bool is_named = false;
    for (std::size_t i = 0; i < options_.optional.size(); ++i) {
        const std::string_view sought = options_.optional[i];
        const bool is_it = sought == path;
        used_[i] = used_[i] || is_it;
        is_named = is_named || is_it ||
                   (sought.size() > path.size() && sought[path.size()] == '/' &&
                    sought.substr(0, path.size()) == path);
    }
    return member.rule == ModellingRule::Mandatory || is_named ||
           (options_.all_optional && can_be_made(member, path)) ||
           (options_.is_wanted && options_.is_wanted(path, member.declaration()));
}

Result<void> Instantiation::check_paths() const
{
    const bool is_missing = std::find(used_.begin(), used_.end(), false) != used_.end();
    return is_missing ? Result<void>{fail(status::Bad_NotFound)} : Result<void>{};
}

NodeIndex Instantiation::instance_of(const DeclaredMember& member) const
{
    for (const DeclarationSource& declaration : member.declarations) {
        if (const auto found = instances_.find(declaration); found != instances_.end()) {
            return found->second;
        }
    }
    return no_node;
}

} // namespace busbar::model::detail
