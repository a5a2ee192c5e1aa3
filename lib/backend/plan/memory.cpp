#include "backend/plan/memory.hpp"

namespace busbar::backend::detail {

namespace {

/// True if there is a place for another entry, if need be that of one whose time is over.
template <typename Map, typename IsOver>
bool make_room(Map& map, std::size_t limit, IsOver is_over)
{
    if (map.size() >= limit) {
        std::erase_if(map, is_over);
    }
    return map.size() < limit;
}

} // namespace

const PlanMemory::Refusal* PlanMemory::refusal_of(const PlanAddress& address) const
{
    const auto found = refusals_.find(address);
    return found == refusals_.end() ? nullptr : &found->second;
}

bool PlanMemory::is_refused_within(std::uint32_t area, std::uint64_t begin, std::uint64_t end) const
{
    if (begin >= end) {
        return false;
    }
    const auto next = refusals_.lower_bound({area, static_cast<std::uint32_t>(begin), 0});
    return next != refusals_.end() && next->first.area == area && next->first.offset < end;
}

void PlanMemory::refused(const PlanAddress& address, const Refusal& refusal, TimePoint now)
{
    const auto found = refusals_.find(address);
    if (found != refusals_.end()) {
        found->second = refusal;
    } else if (make_room(refusals_, limit_,
                         [&](const auto& entry) { return entry.second.until <= now; })) {
        refusals_.emplace(address, refusal);
    }
}

void PlanMemory::accepted(const PlanAddress& address)
{
    refusals_.erase(address);
}

bool PlanMemory::is_cut(const PlanAddress& address, TimePoint now) const
{
    const auto found = cuts_.find({address.area, address.offset});
    return found != cuts_.end() && now < found->second;
}

void PlanMemory::cut(const PlanAddress& address, TimePoint until, TimePoint now)
{
    if (make_room(cuts_, limit_, [&](const auto& entry) { return entry.second <= now; })) {
        cuts_.insert_or_assign({address.area, address.offset}, until);
    }
}

void PlanMemory::forget()
{
    refusals_.clear();
    cuts_.clear();
}

} // namespace busbar::backend::detail
