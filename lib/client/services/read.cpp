#include <busbar/client/attributes.hpp>

#include "batch.hpp"

namespace busbar::client {

namespace {

struct ReadService {
    using Item = ReadValueId;
    using Outcome = DataValue;
    using Response = ReadResponse;
    static constexpr bool is_repeatable = true;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_read;
    }
    [[nodiscard]] detail::BorrowingRequest<ReadRequest, ReadValueId>
    request(std::span<const ReadValueId> items) const
    {
        ReadRequest others;
        others.max_age = to_milliseconds(settings.max_age);
        others.timestamps_to_return = settings.timestamps;
        return {items,
                std::move(others),
                [](binary::Writer& writer, const ReadRequest& request) {
                    writer.number(request.max_age);
                    writer.number(request.timestamps_to_return);
                },
                {}};
    }
    static Array<DataValue> results(ReadResponse& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }

    ReadSettings settings;
};

} // namespace

ReadValueId attribute_of(NodeId node, AttributeId attribute, std::string_view index_range)
{
    ReadValueId item;
    item.node_id = std::move(node);
    item.attribute_id = static_cast<std::uint32_t>(attribute);
    item.index_range = index_range.empty() ? String{} : String{index_range};
    return item;
}

Operation read(Requester& requester, std::vector<ReadValueId> items,
               std::function<void(std::vector<DataValue>)> done, ReadSettings settings,
               const ServiceOptions& options)
{
    return detail::run_batch(requester, ReadService{settings}, std::move(items), std::move(done),
                             options);
}

} // namespace busbar::client
