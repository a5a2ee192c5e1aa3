#include "backend/plan/layout.hpp"

#include <algorithm>
#include <tuple>

namespace busbar::backend::detail {

namespace {

constexpr std::uint64_t max_end = std::uint64_t{1} << 32U;

std::uint64_t end_of(const PlanAddress& address)
{
    return std::uint64_t{address.offset} + address.width;
}

bool may_join_write(const PlanPart& part)
{
    return part.mask == 0xFFFF && !part.is_piece;
}

/// Puts one part after the other into requests, the present one as long as they fit.
class ReadLayout {
public:
    ReadLayout(const PlanRules& rules, const PlanMemory& memory, TimePoint now)
        : rules_{&rules}, memory_{&memory}, now_{now}
    {
    }

    void add(const PlanPart& part, std::size_t at)
    {
        if (rule_ == nullptr || part.address.area != rule_->area) {
            rule_ = rules_->find(part.address.area);
        }
        const bool fits = !jobs_.empty() && (is_same(part) || (may_join(part) && join(part)));
        if (!fits) {
            jobs_.push_back({at, at, {part.address}});
            used_ = std::uint64_t{rule_->range_cost} + part.address.width;
        }
        jobs_.back().end = at + 1;
        sharing_ = part.sharing;
        is_closed_ = part.is_alone;
    }
    [[nodiscard]] std::vector<PlanJob> take() { return std::move(jobs_); }

private:
    /// Equal addresses are read once, also those that are refused.
    [[nodiscard]] bool is_same(const PlanPart& part) const
    {
        return jobs_.back().ranges.back() == part.address;
    }
    [[nodiscard]] bool may_join(const PlanPart& part) const
    {
        const PlanAddress& last = jobs_.back().ranges.back();
        const bool begins_last =
            last.area == part.address.area && last.offset == part.address.offset;
        return !is_closed_ && !part.is_alone &&
               (begins_last || !memory_->is_cut(part.address, now_));
    }
    [[nodiscard]] bool join(const PlanPart& part) { return extend(part.address) || append(part); }
    /// Makes the last range long enough for the address.
    [[nodiscard]] bool extend(const PlanAddress& address)
    {
        PlanAddress& last = jobs_.back().ranges.back();
        if (last.area != address.area || address.offset > end_of(last) + rule_->max_gap ||
            memory_->is_refused_within(last.area, end_of(last), address.offset)) {
            return false;
        }
        const std::uint64_t end = std::max(end_of(last), end_of(address));
        const std::uint64_t more = end - end_of(last);
        if (used_ + more > rule_->max_read) {
            return false;
        }
        used_ += more;
        last.width += static_cast<std::uint32_t>(more);
        return true;
    }
    /// Begins another range of the same request.
    [[nodiscard]] bool append(const PlanPart& part)
    {
        const std::uint64_t more = std::uint64_t{rule_->range_cost} + part.address.width;
        if (part.sharing != sharing_ || jobs_.back().ranges.size() >= rule_->max_ranges ||
            used_ + more > rule_->max_read) {
            return false;
        }
        used_ += more;
        jobs_.back().ranges.push_back(part.address);
        return true;
    }

    const PlanRules* rules_;
    const PlanMemory* memory_;
    TimePoint now_;
    std::vector<PlanJob> jobs_{};
    /// The rule of the last part's area.
    const PlanRule* rule_{nullptr};
    std::uint32_t sharing_{0};
    /// Units of the last job.
    std::uint64_t used_{0};
    /// The last job takes equal addresses only.
    bool is_closed_{false};
};

} // namespace

PlanRules::PlanRules(std::vector<PlanRule> rules) : rules_{std::move(rules)}
{
    std::stable_sort(rules_.begin(), rules_.end(),
                     [](const PlanRule& a, const PlanRule& b) { return a.area < b.area; });
}

const PlanRule* PlanRules::find(std::uint32_t area) const
{
    const auto found = std::lower_bound(
        rules_.begin(), rules_.end(), area,
        [](const PlanRule& rule, std::uint32_t wanted) { return rule.area < wanted; });
    return found == rules_.end() || found->area != area ? nullptr : &*found;
}

bool is_possible(const PlanAddress& address, const PlanRule* rule)
{
    return rule != nullptr && address.width > 0 && end_of(address) <= max_end;
}

void append_pieces(std::vector<PlanPart>& parts, PlanPart whole, std::uint32_t max_width,
                   std::uint32_t words_per_unit)
{
    const std::uint64_t end = end_of(whole.address);
    max_width = std::max(max_width, 1U);
    whole.is_piece = whole.address.width > max_width;
    PlanPart piece = whole;
    for (std::uint64_t at = whole.address.offset; at < end; at += piece.address.width) {
        piece.address.offset = static_cast<std::uint32_t>(at);
        piece.address.width =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(max_width, end - at));
        piece.first_word =
            whole.first_word + static_cast<std::size_t>(at - whole.address.offset) * words_per_unit;
        parts.push_back(piece);
    }
}

void sort_parts(std::vector<PlanPart>& parts)
{
    const auto before = [](const PlanPart& a, const PlanPart& b) {
        return std::tie(a.is_alone, a.sharing, a.address, a.index) <
               std::tie(b.is_alone, b.sharing, b.address, b.index);
    };
    if (!std::is_sorted(parts.begin(), parts.end(), before)) {
        std::sort(parts.begin(), parts.end(), before);
    }
}

std::vector<PlanJob> lay_out(std::span<const PlanPart> parts, std::size_t begin, std::size_t end,
                             const PlanRules& rules, const PlanMemory& memory, TimePoint now)
{
    ReadLayout layout{rules, memory, now};
    for (std::size_t at = begin; at < end; ++at) {
        layout.add(parts[at], at);
    }
    return layout.take();
}

std::vector<PlanJob> lay_out_writes(std::span<const PlanPart> parts, const PlanRules& rules)
{
    std::vector<PlanJob> jobs;
    for (std::size_t at = 0; at < parts.size(); ++at) {
        const PlanPart& part = parts[at];
        const bool follows = !jobs.empty() && may_join_write(part) &&
                             may_join_write(parts[at - 1]) &&
                             jobs.back().ranges[0].area == part.address.area &&
                             end_of(jobs.back().ranges[0]) == part.address.offset &&
                             std::uint64_t{jobs.back().ranges[0].width} + part.address.width <=
                                 std::max(rules.find(part.address.area)->max_write, 1U);
        if (follows) {
            jobs.back().ranges[0].width += part.address.width;
        } else {
            jobs.push_back({at, at, {part.address}});
        }
        jobs.back().end = at + 1;
    }
    return jobs;
}

PlanJob write_of(std::span<const PlanPart> parts, std::size_t begin, std::size_t end)
{
    PlanAddress range = parts[begin].address;
    for (std::size_t at = begin + 1; at < end; ++at) {
        range.width += parts[at].address.width;
    }
    return {begin, end, {range}};
}

std::size_t divide(std::span<const PlanPart> parts, std::size_t begin, std::size_t end)
{
    const auto is_step = [&](std::size_t at) { return parts[at].address != parts[at - 1].address; };
    const std::size_t middle = begin + (end - begin) / 2;
    for (std::size_t at = middle; at > begin; --at) {
        if (is_step(at)) {
            return at;
        }
    }
    for (std::size_t at = middle + 1; at < end; ++at) {
        if (is_step(at)) {
            return at;
        }
    }
    return end;
}

} // namespace busbar::backend::detail
