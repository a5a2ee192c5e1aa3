#include <busbar/client/attributes.hpp>

#include "batch.hpp"

namespace busbar::client {

namespace {

struct WriteService {
    using Item = WriteValue;
    using Outcome = StatusCode;
    using Response = WriteResponse;
    /// Writing the same value again changes nothing.
    static constexpr bool is_repeatable = true;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_write;
    }
    [[nodiscard]] static detail::BorrowingRequest<WriteRequest, WriteValue>
    request(std::span<const WriteValue> items)
    {
        return {items, {}, nullptr, {}};
    }
    static Array<StatusCode> results(WriteResponse& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }
};

struct ExplainedWriteService : WriteService {
    using Outcome = ExplainedWrite;

    static std::vector<ExplainedWrite> results(const WriteResponse& response, std::size_t /*count*/)
    {
        std::vector<ExplainedWrite> all;
        for (std::size_t i = 0; i < response.results.size(); ++i) {
            all.push_back(
                {response.results[i], detail::additional_info_of(response.diagnostic_infos, i)});
        }
        return all;
    }
};

} // namespace

WriteValue value_for(NodeId node, DataValue value, AttributeId attribute,
                     std::string_view index_range)
{
    WriteValue item;
    item.node_id = std::move(node);
    item.attribute_id = static_cast<std::uint32_t>(attribute);
    item.index_range = index_range.empty() ? String{} : String{index_range};
    item.value = std::move(value);
    return item;
}

Operation write(Requester& requester, std::vector<WriteValue> items,
                std::function<void(std::vector<StatusCode>)> done, const ServiceOptions& options)
{
    return detail::run_batch(requester, WriteService{}, std::move(items), std::move(done), options);
}

Operation write_explained(Requester& requester, std::vector<WriteValue> items,
                          std::function<void(std::vector<ExplainedWrite>)> done,
                          const ServiceOptions& options)
{
    return detail::run_batch(requester, ExplainedWriteService{}, std::move(items), std::move(done),
                             detail::asking_for_additional_info(options));
}

} // namespace busbar::client
