#include "path_search.hpp"

#include <algorithm>
#include <span>

#include <busbar/client/node_address.hpp>
#include <busbar/client/view.hpp>

#include "client/request_queue.hpp"
#include "handlers.hpp"

namespace busbar::client::detail {

namespace {

/// Maximum number of targets of one node.
constexpr std::size_t max_targets = 10'000;

/// Follows one element of all paths in each step.
class PathSearch final : public OperationState, public std::enable_shared_from_this<PathSearch> {
public:
    using Done = std::function<void(std::vector<SearchedPath>)>;

    PathSearch(Requester& requester, std::vector<BrowsePath> paths, Done done,
               const ServiceOptions& options)
        : requester_{requester}, paths_{std::move(paths)},
          found_(paths_.size(), SearchedPath{fail(status::Bad_NoMatch), {}}),
          done_{std::move(done)}, options_{options}
    {
        for (std::size_t i = 0; i < paths_.size(); ++i) {
            found_[i].id = paths_[i].starting_node;
            open_.push_back(i);
        }
    }

    void step()
    {
        std::erase_if(open_, [this](std::size_t i) {
            return !found_[i].id || at_ == paths_[i].relative_path.elements.size();
        });
        if (open_.empty()) {
            return finish();
        }
        std::vector<BrowseDescription> items;
        for (const std::size_t i : open_) {
            const RelativePathElement& element = paths_[i].relative_path.elements[at_];
            BrowseDescription item = children_of(*found_[i].id);
            item.reference_type_id = element.reference_type_id;
            item.include_subtypes = element.include_subtypes;
            item.browse_direction =
                element.is_inverse ? BrowseDirection::Inverse : BrowseDirection::Forward;
            items.push_back(std::move(item));
        }
        BrowseLimits limits;
        limits.max_references_per_node = max_targets;
        operation_ = browse(requester_, std::move(items),
                            step_of(shared_from_this(),
                                    [](PathSearch& self, const std::vector<BrowseResult>& results) {
                                        self.take(results);
                                    }),
                            limits, options_);
    }
    void cancel() override
    {
        done_ = nullptr;
        operation_.cancel();
    }
    void no_memory()
    {
        if (done_ == nullptr) {
            return;
        }
        for (const std::size_t i : open_) {
            found_[i] = SearchedPath{fail(status::Bad_OutOfMemory), {}};
        }
        finish();
    }

private:
    using Targets = std::vector<const ReferenceDescription*>;

    void take(const std::vector<BrowseResult>& results)
    {
        for (std::size_t i = 0; i < open_.size(); ++i) {
            found_[open_[i]] = choose(results[i], paths_[open_[i]]);
        }
        ++at_;
        step();
    }
    /// Chooses a target in the named namespace before all others. The path's element gets the name
    /// of the target, for candidates of later elements.
    [[nodiscard]] SearchedPath choose(const BrowseResult& result, BrowsePath& path) const
    {
        QualifiedName& name = path.relative_path.elements[at_].target_name;
        if (is_unanswered(result.status_code)) {
            return {fail(result.status_code), {}};
        }
        Targets exact;
        Targets others;
        for (const ReferenceDescription& reference : result.references) {
            if (reference.browse_name == name) {
                add(reference, exact);
            } else if (name.namespace_index == 0 && reference.browse_name.name == name.name) {
                add(reference, others);
            }
        }
        const auto& fitting = exact.empty() ? others : exact;
        // Targets that were not returned may fit, too.
        const bool is_complete = result.status_code.is_good();
        if (fitting.empty() || !is_complete) {
            return {fail(status::Bad_NoMatch), {}};
        }
        if (fitting.size() == 1) {
            name = fitting.front()->browse_name;
            return {local_id(fitting.front()->node_id, requester_.server()), {}};
        }
        return {fail(status::Bad_TooManyMatches), candidates(path, fitting)};
    }
    [[nodiscard]] std::vector<BrowsePath> candidates(const BrowsePath& path,
                                                     const Targets& targets) const
    {
        std::vector<BrowsePath> found;
        for (const ReferenceDescription* each : targets) {
            const auto has_name = [each](const ReferenceDescription* other) {
                return other->browse_name == each->browse_name;
            };
            const bool is_only = std::ranges::count_if(targets, has_name) == 1;
            const auto id = local_id(each->node_id, requester_.server());
            if (found.size() == max_candidates || (!is_only && !id)) {
                continue;
            }
            BrowsePath& candidate = found.emplace_back(path);
            auto& elements = candidate.relative_path.elements;
            elements[at_].target_name = each->browse_name;
            if (!is_only) {
                candidate.starting_node = *id;
                const std::span<const RelativePathElement> all = path.relative_path.elements;
                elements = Array<RelativePathElement>{all.subspan(at_ + 1)};
            }
        }
        return found;
    }
    /// Several references to one node count as one match.
    static void add(const ReferenceDescription& reference, Targets& to)
    {
        if (std::ranges::none_of(to, [&](const ReferenceDescription* each) {
                return each->node_id == reference.node_id;
            })) {
            to.push_back(&reference);
        }
    }
    void finish()
    {
        if (const Done done = std::exchange(done_, nullptr)) {
            done(std::move(found_));
        }
    }

    Requester& requester_;
    std::vector<BrowsePath> paths_;
    std::vector<SearchedPath> found_;
    Done done_;
    ServiceOptions options_;
    Operation operation_;
    std::size_t at_{0};
    std::vector<std::size_t> open_;
};

} // namespace

bool may_be_searched(const BrowsePath& path)
{
    const auto& elements = path.relative_path.elements;
    const bool has_names = std::ranges::none_of(elements, [](const RelativePathElement& element) {
        return element.target_name.name.empty();
    });
    return has_names && std::ranges::any_of(elements, [](const RelativePathElement& element) {
               return element.target_name.namespace_index == 0;
           });
}

Operation search_paths(Requester& requester, std::vector<BrowsePath> paths,
                       std::function<void(std::vector<SearchedPath>)> done,
                       const ServiceOptions& options)
{
    const auto operation =
        std::make_shared<PathSearch>(requester, std::move(paths), std::move(done), options);
    operation->step();
    return Operation{operation};
}

} // namespace busbar::client::detail
