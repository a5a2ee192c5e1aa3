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

/// Words that a range has where it shares a request.
std::uint64_t words_of(const PlanAddress& range, const PlanRule& rule, const PlanShare& share)
{
    const std::uint64_t per_word = std::max(share.units_per_word, 1U);
    if (per_word == 1) {
        return std::uint64_t{range.width} * std::max(rule.words_per_unit, 1U);
    }
    return (range.offset % per_word + range.width + per_word - 1) / per_word;
}

bool may_share(const PlanShare& share, std::size_t ranges, std::uint64_t words)
{
    return (ranges <= share.max_ranges &&
            words + std::uint64_t{share.range_cost} * ranges <= share.max_words) ||
           words <= share.max_listed;
}

/// The ranges of a request that grows.
class RangeList {
public:
    /// Begins another request.
    void begin(const PlanAddress& range, const PlanRule& rule, const PlanShare& share)
    {
        words_ = words_of(range, rule, share);
        share_ = &share;
    }
    /// Makes the last range so long, if that is within the limits.
    [[nodiscard]] bool extend(std::vector<PlanAddress>& ranges, std::uint64_t width,
                              std::uint32_t limit, const PlanRule& rule)
    {
        PlanAddress longer = ranges.back();
        longer.width = static_cast<std::uint32_t>(width);
        const std::uint64_t words =
            words_ - words_of(ranges.back(), rule, *share_) + words_of(longer, rule, *share_);
        if (width > limit || (ranges.size() > 1 && !may_share(*share_, ranges.size(), words))) {
            return false;
        }
        ranges.back() = longer;
        words_ = words;
        return true;
    }
    /// Appends a range, likewise.
    [[nodiscard]] bool append(std::vector<PlanAddress>& ranges, const PlanAddress& range,
                              const PlanRule& rule, const PlanShare& share)
    {
        const std::uint64_t words = words_ + words_of(range, rule, share);
        if (share.group != share_->group || !may_share(share, ranges.size() + 1, words)) {
            return false;
        }
        share_ = &share;
        words_ = words;
        ranges.push_back(range);
        return true;
    }

private:
    const PlanShare* share_{nullptr};
    std::uint64_t words_{0};
};

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
            list_.begin(part.address, *rule_, rule_->read);
        }
        jobs_.back().end = at + 1;
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
    [[nodiscard]] bool join(const PlanPart& part)
    {
        return extend(part.address) ||
               list_.append(jobs_.back().ranges, part.address, *rule_, rule_->read);
    }
    /// Makes the last range long enough for the address.
    [[nodiscard]] bool extend(const PlanAddress& address)
    {
        const PlanAddress& last = jobs_.back().ranges.back();
        if (last.area != address.area || address.offset > end_of(last) + rule_->max_gap ||
            memory_->is_refused_within(last.area, end_of(last), address.offset)) {
            return false;
        }
        const std::uint64_t end = std::max(end_of(last), end_of(address));
        return list_.extend(jobs_.back().ranges, end - last.offset, rule_->max_read, *rule_);
    }

    const PlanRules* rules_;
    const PlanMemory* memory_;
    TimePoint now_;
    std::vector<PlanJob> jobs_{};
    RangeList list_{};
    /// The rule of the last part's area.
    const PlanRule* rule_{nullptr};
    /// The last job takes equal addresses only.
    bool is_closed_{false};
};

bool may_join_write(const PlanPart& part)
{
    return part.mask == 0xFFFF && !part.is_piece;
}

/// Returns whether the address overlaps a range: the PLC must not decide which of two writes wins.
bool overlaps(const std::vector<PlanAddress>& ranges, const PlanAddress& address)
{
    return std::ranges::any_of(ranges, [&](const PlanAddress& range) {
        return range.area == address.area && range.offset < end_of(address) &&
               address.offset < end_of(range);
    });
}

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

void PlanRules::change(std::span<const PlanRule> rules)
{
    bool is_changed = false;
    for (const PlanRule& rule : rules) {
        const auto known = std::ranges::find(rules_, rule.area, &PlanRule::area);
        if (known != rules_.end() && *known != rule) {
            *known = rule;
            is_changed = true;
        }
    }
    version_ += is_changed ? 1U : 0U;
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
        return std::tie(a.is_alone, a.group, a.address, a.index) <
               std::tie(b.is_alone, b.group, b.address, b.index);
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

std::vector<PlanJob> lay_out_writes(std::span<const PlanPart> parts, std::size_t begin,
                                    std::size_t end, const PlanRules& rules)
{
    std::vector<PlanJob> jobs;
    RangeList list;
    for (std::size_t at = begin; at < end; ++at) {
        const PlanPart& part = parts[at];
        const PlanRule& rule = *rules.find(part.address.area);
        bool is_in = at > begin && may_join_write(part) && may_join_write(parts[at - 1]) &&
                     !overlaps(jobs.back().ranges, part.address);
        if (is_in) {
            std::vector<PlanAddress>& ranges = jobs.back().ranges;
            const PlanAddress& last = ranges.back();
            const bool follows =
                last.area == part.address.area && end_of(last) == part.address.offset;
            is_in = (follows && list.extend(ranges, std::uint64_t{last.width} + part.address.width,
                                            std::max(rule.max_write, 1U), rule)) ||
                    list.append(ranges, part.address, rule, rule.write);
        }
        if (!is_in) {
            jobs.push_back({at, at, {part.address}});
            list.begin(part.address, rule, rule.write);
        }
        jobs.back().end = at + 1;
    }
    return jobs;
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
