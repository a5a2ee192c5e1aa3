#pragma once

#include <busbar/client/view.hpp>

#include "batch.hpp"

namespace busbar::client::detail {

struct BrowseService {
    using Item = BrowseDescription;
    using Outcome = BrowseResult;
    using Response = BrowseResponse;
    static constexpr bool is_repeatable = true;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_browse;
    }
    [[nodiscard]] BorrowingRequest<BrowseRequest, BrowseDescription>
    request(std::span<const BrowseDescription> items) const
    {
        BrowseRequest others;
        others.requested_max_references_per_node = references_per_answer;
        return {items,
                std::move(others),
                [](binary::Writer& writer, const BrowseRequest& request) {
                    encode(writer, request.view);
                    writer.number(request.requested_max_references_per_node);
                },
                {}};
    }
    static Array<BrowseResult> results(BrowseResponse& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }

    std::uint32_t references_per_answer{0};
};

/// Part 4, 5.9.3.
struct BrowseNextService {
    using Item = ByteString;
    using Outcome = BrowseResult;
    using Response = BrowseNextResponse;
    /// The first try uses a continuation point up.
    static constexpr bool is_repeatable = false;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_browse;
    }
    [[nodiscard]] BorrowingRequest<BrowseNextRequest, ByteString>
    request(std::span<const ByteString> items) const
    {
        BrowseNextRequest others;
        others.release_continuation_points = releases;
        return {items,
                std::move(others),
                [](binary::Writer& writer, const BrowseNextRequest& request) {
                    encode(writer, request.release_continuation_points);
                },
                {}};
    }
    static Array<BrowseResult> results(BrowseNextResponse& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }

    bool releases{false};
};

} // namespace busbar::client::detail
