#include <busbar/client/view.hpp>

#include "batch.hpp"

namespace busbar::client {

namespace {

struct TranslateService {
    using Item = BrowsePath;
    using Outcome = BrowsePathResult;
    using Response = TranslateBrowsePathsToNodeIdsResponse;
    static constexpr bool is_repeatable = true;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_translate_browse_paths;
    }
    [[nodiscard]] static detail::BorrowingRequest<TranslateBrowsePathsToNodeIdsRequest, BrowsePath>
    request(std::span<const BrowsePath> items)
    {
        return {items, {}, nullptr, {}};
    }
    static Array<BrowsePathResult> results(Response& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }
};

} // namespace

Operation translate(Requester& requester, std::vector<BrowsePath> paths,
                    std::function<void(std::vector<BrowsePathResult>)> done,
                    const ServiceOptions& options)
{
    return detail::run_batch(requester, TranslateService{}, std::move(paths), std::move(done),
                             options);
}

} // namespace busbar::client
