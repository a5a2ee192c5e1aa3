#include <algorithm>
#include <array>
#include <map>

#include <busbar/binary/relative_path.hpp>
#include <busbar/client/attributes.hpp>
#include <busbar/client/resolve_nodes.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "handlers.hpp"
#include "path_search.hpp"

namespace busbar::client {

namespace {

struct CommonReference {
    std::string_view name;
    std::uint32_t id;
};

/// Common ReferenceTypes; others are looked up on the server.
constexpr std::array common_references{
    CommonReference{"References", id::References},
    CommonReference{"HierarchicalReferences", id::HierarchicalReferences},
    CommonReference{"NonHierarchicalReferences", id::NonHierarchicalReferences},
    CommonReference{"HasChild", id::HasChild},
    CommonReference{"Organizes", id::Organizes},
    CommonReference{"Aggregates", id::Aggregates},
    CommonReference{"HasComponent", id::HasComponent},
    CommonReference{"HasOrderedComponent", id::HasOrderedComponent},
    CommonReference{"HasProperty", id::HasProperty},
    CommonReference{"HasSubtype", id::HasSubtype},
    CommonReference{"HasTypeDefinition", id::HasTypeDefinition},
    CommonReference{"HasEncoding", id::HasEncoding},
    CommonReference{"HasModellingRule", id::HasModellingRule},
    CommonReference{"HasEventSource", id::HasEventSource},
    CommonReference{"HasNotifier", id::HasNotifier},
    CommonReference{"GeneratesEvent", id::GeneratesEvent},
    CommonReference{"HasInterface", id::HasInterface},
    CommonReference{"HasAddIn", id::HasAddIn},
};

/// Returns the ReferenceType of namespace 0 with this BrowseName; null if it is not a common one.
NodeId standard_reference_type(const QualifiedName& name)
{
    const auto* const found = std::find_if(
        common_references.begin(), common_references.end(), [&](const CommonReference& type) {
            return name.namespace_index == 0 && type.name == name.name.view();
        });
    return found == common_references.end() ? NodeId{} : NodeId{0, found->id};
}

/// Returns the BrowseName of such a ReferenceType; empty if it is not one of them.
QualifiedName standard_name(const NodeId& reference_type)
{
    const auto* const found = std::find_if(common_references.begin(), common_references.end(),
                                           [&](const CommonReference& type) {
                                               return reference_type == NodeId{0, type.id};
                                           });
    return found == common_references.end() ? QualifiedName{} : QualifiedName{0, found->name};
}

/// Works in steps, each skipped if it is not needed: wait for a session, browse ReferenceTypes for
/// unknown names, translate.
class ResolveOperation final : public detail::OperationState,
                               public std::enable_shared_from_this<ResolveOperation> {
public:
    using Done = std::function<void(std::vector<ResolvedNode>)>;

    ResolveOperation(Requester& requester, std::vector<NodeAddress> addresses, Done done,
                     const ServiceOptions& options)
        : requester_{requester}, addresses_{std::move(addresses)},
          results_(addresses_.size(), ResolvedNode{fail(status::Bad_NoMatch), {}}),
          done_{std::move(done)}, options_{options}
    {
    }

    void begin()
    {
        if (requester_.server().namespaces.empty()) {
            return wait_for_session();
        }
        use_ids();
        if (paths_.empty()) {
            later_ = detail::later(requester_, [self = shared_from_this()] { self->finish(); });
            is_later_ = true;
            return;
        }
        look_up();
    }
    void cancel() override
    {
        done_ = nullptr;
        step_.cancel();
        if (is_later_) {
            requester_.cancel(later_);
        }
    }
    void no_memory()
    {
        for (ResolvedNode& result : results_) {
            if (!result.id) {
                result = ResolvedNode{fail(status::Bad_OutOfMemory), {}};
            }
        }
        finish();
    }

private:
    void wait_for_session()
    {
        step_ =
            read(requester_, {attribute_of(NodeId{0, id::Server_NamespaceArray})},
                 detail::step_of(shared_from_this(),
                                 [](ResolveOperation& self, const std::vector<DataValue>& values) {
                                     self.waited(values.front().status);
                                 }),
                 {}, options_);
    }
    void waited(StatusCode status)
    {
        if (requester_.server().namespaces.empty() && status.is_bad()) {
            results_.assign(results_.size(), ResolvedNode{fail(status), {}});
            return finish();
        }
        use_ids();
        paths_.empty() ? finish() : look_up();
    }
    void use_ids()
    {
        for (std::size_t i = 0; i < addresses_.size(); ++i) {
            if (addresses_[i].is_path()) {
                paths_.push_back(i);
            } else {
                results_[i].id = addresses_[i].node_id(requester_.server());
            }
        }
    }

    /// Creates BrowsePaths; with ReferenceTypes of the server if they are needed.
    void look_up()
    {
        auto paths = make_paths();
        if (needs_types_ && types_.empty()) {
            BrowseDescription how = children_of(NodeId{});
            how.reference_type_id = NodeId{0, id::HasSubtype};
            TreeLimits limits;
            limits.max_nodes = max_types;
            step_ = browse_tree(requester_, {NodeId{0, id::References}}, how,
                                detail::step_of(shared_from_this(),
                                                [](ResolveOperation& self,
                                                   const BrowsedTree& tree) { self.learn(tree); }),
                                limits, options_);
            return;
        }
        sent_ = paths;
        step_ = translate(requester_, std::move(paths),
                          detail::step_of(shared_from_this(),
                                          [](ResolveOperation& self,
                                             const std::vector<BrowsePathResult>& results) {
                                              self.translated(results);
                                          }),
                          options_);
    }
    [[nodiscard]] std::vector<BrowsePath> make_paths()
    {
        std::vector<BrowsePath> paths;
        asked_.clear();
        for (const std::size_t i : paths_) {
            auto path = addresses_[i].browse_path(
                requester_.server(), [this](const QualifiedName& name) { return type_of(name); });
            if (path) {
                paths.push_back(*std::move(path));
                asked_.push_back(i);
            } else {
                results_[i].id = fail(path.error());
            }
        }
        return paths;
    }
    [[nodiscard]] NodeId type_of(const QualifiedName& name)
    {
        NodeId type = standard_reference_type(name);
        if (type.is_null()) {
            needs_types_ = true;
            const auto found = types_.find(name);
            return found == types_.end() ? NodeId{} : found->second;
        }
        return type;
    }
    void learn(const BrowsedTree& tree)
    {
        types_.emplace(QualifiedName{}, NodeId{}); // not empty any more: asked once
        for (const TreeNode& node : tree.nodes) {
            if (node.parent != TreeNode::no_parent && node.reference.node_id.is_local()) {
                types_.emplace(node.reference.browse_name, node.reference.node_id.node_id);
            }
        }
        look_up();
    }

    void translated(const std::vector<BrowsePathResult>& results)
    {
        std::vector<BrowsePath> paths;
        std::vector<std::size_t> searched;
        for (std::size_t i = 0; i < asked_.size(); ++i) {
            ResolvedNode& result = results_[asked_[i]];
            result = target_of(results[i]);
            if (results[i].status_code == status::Bad_NoMatch &&
                detail::may_be_searched(sent_[i])) {
                paths.push_back(std::move(sent_[i]));
                searched.push_back(asked_[i]);
            }
        }
        if (paths.empty()) {
            return finish();
        }
        step_ = detail::search_paths(
            requester_, std::move(paths),
            detail::step_of(
                shared_from_this(),
                [searched](ResolveOperation& self, std::vector<detail::SearchedPath> found) {
                    for (std::size_t i = 0; i < searched.size(); ++i) {
                        self.take(std::move(found[i]), self.results_[searched[i]]);
                    }
                    self.finish();
                }),
            options_);
    }
    void take(detail::SearchedPath found, ResolvedNode& result) const
    {
        result.id = std::move(found.id);
        for (const BrowsePath& candidate : found.candidates) {
            const auto& path = candidate.relative_path;
            if (path.elements.empty()) {
                result.candidates.emplace_back(candidate.starting_node);
                continue;
            }
            const auto text =
                binary::to_text(path, [this](const NodeId& type) { return name_of(type); });
            const auto address =
                text ? NodeAddress::path(*text, candidate.starting_node) : fail(text.error());
            if (address) {
                result.candidates.push_back(*address);
            }
        }
    }
    [[nodiscard]] QualifiedName name_of(const NodeId& type) const
    {
        for (const auto& [name, id] : types_) {
            if (id == type) {
                return name;
            }
        }
        return standard_name(type);
    }
    [[nodiscard]] ResolvedNode target_of(const BrowsePathResult& result) const
    {
        if (result.status_code.is_bad()) {
            return {fail(result.status_code), {}};
        }
        if (result.targets.empty()) {
            return {fail(status::Bad_NoMatch), {}};
        }
        if (result.targets.size() == 1) {
            return {local_target(result.targets.front()), {}};
        }
        ResolvedNode many{fail(status::Bad_TooManyMatches), {}};
        for (const BrowsePathTarget& target : result.targets) {
            const auto id = local_target(target);
            if (id && many.candidates.size() < detail::max_candidates) {
                many.candidates.emplace_back(*id);
            }
        }
        return many;
    }
    [[nodiscard]] Result<NodeId> local_target(const BrowsePathTarget& target) const
    {
        // Part 4, 7.6: a path that leaves the server ends before its last element.
        return target.remaining_path_index != UINT32_MAX
                   ? fail(status::Bad_NoMatch)
                   : local_id(target.target_id, requester_.server());
    }
    void finish()
    {
        if (const Done done = std::exchange(done_, nullptr)) {
            done(std::move(results_));
        }
    }

    static constexpr std::size_t max_types = 10'000;

    Requester& requester_;
    std::vector<NodeAddress> addresses_;
    std::vector<ResolvedNode> results_;
    Done done_;
    ServiceOptions options_;
    Operation step_;
    RequestId later_{0};
    bool is_later_{false};
    bool needs_types_{false};
    std::vector<std::size_t> paths_; // indices of addresses_
    std::vector<std::size_t> asked_; // those that have a BrowsePath
    std::vector<BrowsePath> sent_;   // BrowsePaths of asked_
    std::map<QualifiedName, NodeId> types_;
};

} // namespace

Operation resolve_nodes(Requester& requester, std::vector<NodeAddress> addresses,
                        std::function<void(std::vector<ResolvedNode>)> done,
                        const ServiceOptions& options)
{
    const auto operation = std::make_shared<ResolveOperation>(requester, std::move(addresses),
                                                              std::move(done), options);
    operation->begin();
    return Operation{operation};
}

Operation resolve(Requester& requester, std::vector<NodeAddress> addresses,
                  std::function<void(std::vector<Result<NodeId>>)> done,
                  const ServiceOptions& options)
{
    // Created before it is needed, so that resolved addresses cannot fail any more.
    const auto results =
        std::make_shared<std::vector<Result<NodeId>>>(addresses.size(), fail(status::Bad_NoMatch));
    return resolve_nodes(
        requester, std::move(addresses),
        [done = std::move(done), results](std::vector<ResolvedNode> found) {
            for (std::size_t i = 0; i < found.size(); ++i) {
                (*results)[i] = std::move(found[i].id);
            }
            done(std::move(*results));
        },
        options);
}

} // namespace busbar::client
