#include "batch_plan.hpp"

#include <utility>

#include <busbar/core/status_codes.hpp>

namespace busbar::client::detail {

BatchPlan::BatchPlan(std::size_t items, std::size_t max_items)
    : max_items_{std::max<std::size_t>(max_items, 1)}
{
    if (items != 0) {
        waiting_.push_back({0, items});
    }
}

void BatchPlan::limit(std::size_t max_items)
{
    if (max_items != 0) {
        max_items_ = std::min(max_items_, max_items);
    }
}

std::optional<BatchPlan::Part> BatchPlan::next()
{
    if (waiting_.empty()) {
        return std::nullopt;
    }
    Part part = waiting_.back();
    if (part.count <= max_items_) {
        waiting_.pop_back();
        return part;
    }
    waiting_.back() = {part.first + max_items_, part.count - max_items_};
    part.count = max_items_;
    return part;
}

bool BatchPlan::halve(Part part)
{
    if (part.count < 2) {
        return false;
    }
    limit((part.count + 1) / 2);
    waiting_.push_back(part);
    return true;
}

std::vector<BatchPlan::Part> BatchPlan::take_rest()
{
    return std::exchange(waiting_, {});
}

bool is_too_large(StatusCode why, bool is_repeatable)
{
    const StatusCode code = why.code();
    const bool not_begun =
        code == status::Bad_TooManyOperations || code == status::Bad_RequestTooLarge;
    const bool maybe_done =
        code == status::Bad_ResponseTooLarge || code == status::Bad_EncodingLimitsExceeded;
    return not_begun || (is_repeatable && maybe_done);
}

} // namespace busbar::client::detail
