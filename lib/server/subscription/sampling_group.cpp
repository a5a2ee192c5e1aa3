#include "sampling_group.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "sampler.hpp"
#include "sampling_context.hpp"
#include "server/data/read_results.hpp"
#include "subscription.hpp"

namespace busbar::server::detail {

struct SamplingGroup::Flight final : SourceCallOwner {
    Flight(SamplingGroup& g, std::size_t f, std::size_t count, bool late)
        : group{g}, first{f}, is_late{late}, call{g.sampler_.needs().sources, count}
    {
    }
    void call_completed() override { group.land(*this); }

    SamplingGroup& group;
    /// The member of the call's first operation.
    std::size_t first;
    bool is_late;
    /// Ranges that sources use.
    std::vector<std::shared_ptr<const NumericRange>> ranges;
    SourceRead call;
};

SamplingGroup::SamplingGroup(Sampler& sampler, Duration interval)
    : sampler_{sampler}, interval_{interval}, images_{sampler.memory()}, lookups_{sampler.lookups()}
{
}

SamplingGroup::~SamplingGroup()
{
    sampler_.timers().cancel(*this);
}

void SamplingGroup::add(ValueItem& item, TimePoint now)
{
    if (next_sample_ == no_deadline && interval_ != Duration::zero()) {
        sampler_.timers().set(*this, now + interval_);
        next_sample_ = now + interval_;
    }
    const ValueItem::Place place = put_in(item); // first, as it may fail
    if (item.group_ != nullptr) {
        item.group_->remove(item);
    }
    item.place_ = place;
    item.group_ = this;
    ++item_count_;
}

ValueItem::Place SamplingGroup::put_in(ValueItem& item)
{
    members_.push_back({&item});
    return {ValueItem::Place::no_image, static_cast<std::uint32_t>(members_.size() - 1)};
}

void SamplingGroup::take_out(ValueItem& item)
{
    if (item.place_.image != ValueItem::Place::no_image) {
        images_.remove(item.place_);
    } else {
        members_[item.place_.index].item = nullptr;
        ++holes_;
    }
}

void SamplingGroup::remove(ValueItem& item)
{
    take_out(item);
    item.stop();
    item.group_ = nullptr;
    --item_count_;
    set_use(item, {});
}

void SamplingGroup::rebind(ValueItem& item)
{
    const ValueItem::Place place = put_in(item); // first, as it may fail
    take_out(item);
    item.place_ = place;
}

void SamplingGroup::node_changed(ValueItem& item)
{
    if (item.place_.image != ValueItem::Place::no_image) {
        rebind(item);
    } else {
        members_[item.place_.index].binding = Binding::Unknown;
    }
}

void SamplingGroup::compact()
{
    if (!flights_.empty() || holes_ == 0) {
        return;
    }
    const auto fresh = members_.begin() + static_cast<std::ptrdiff_t>(first_new_);
    first_new_ -= static_cast<std::size_t>(std::count_if(
        members_.begin(), fresh, [](const Member& member) { return member.item == nullptr; }));
    std::erase_if(members_, [](const Member& member) { return member.item == nullptr; });
    for (std::size_t i = 0; i < members_.size(); ++i) {
        members_[i].item->place_.index = static_cast<std::uint32_t>(i);
    }
    holes_ = 0;
}

bool SamplingGroup::is_full_of_holes() const
{
    return holes_ > 1'000 && holes_ > members_.size() / 2;
}

/// Changes of an item's own node arrive in node_changed.
void SamplingGroup::notice_changes()
{
    const std::uint64_t lookups = sampler_.lookups();
    const bool is_outdated = lookups_ != lookups;
    if (is_outdated || images_.is_wasteful() || has_lost_source()) {
        members_.reserve(members_.size() + item_count_); // from here on nothing can fail
        images_.take_all([this](ValueItem& item) { item.place_ = put_in(item); });
    }
    for (std::size_t i = 0; is_outdated && i < members_.size(); ++i) {
        members_[i].binding = Binding::Unknown;
    }
    lookups_ = lookups;
}

void SamplingGroup::bind(std::size_t first)
{
    for (std::size_t i = first; i < members_.size(); ++i) {
        if (members_[i].item != nullptr && members_[i].binding == Binding::Unknown) {
            bind_one(i);
        }
    }
}

void SamplingGroup::note_source(ValueItem& item, const ReadPlan& plan)
{
    MonitoredHandles::Use use;
    if (plan.source != nullptr) {
        use = {plan.source_index, plan.handle};
    }
    set_use(item, use);
}

void SamplingGroup::set_use(ValueItem& item, const MonitoredHandles::Use& use)
{
    sampler_.monitored().change({item.used_source_, item.used_handle_}, use, interval_);
    item.used_source_ = use.source;
    item.used_handle_ = use.handle;
}

/// Look the member up only after planning: planning calls the AccessControl, which may move
/// members_.
void SamplingGroup::bind_one(std::size_t index)
{
    ValueItem& item = *members_[index].item;
    const model::AddressSpace& space = sampler_.needs().space;
    const ReadPlan plan = plan_sample(sampler_.needs(), item.subscription(), item.target());
    note_source(item, plan);
    Member& member = members_[index];
    if (plan.source == nullptr) { // it is looked up at each sample
        member.binding = Binding::AddressSpace;
        return item.stop();
    }
    const model::NodeIndex node = space.find(item.node_id());
    space.journal().watch(node, model::NodeAspect::Binding, item);
    sampler_.watch_roles(node);
    ProcessImage* const image = plan.source->process_image();
    if (image != nullptr && plan.handle < image->size()) {
        item.place_ =
            images_.add(item, *image, *plan.source, static_cast<std::uint32_t>(plan.handle));
        member.item = nullptr;
        ++holes_;
        return;
    }
    member.binding = Binding::Source;
    member.source = plan.source_index;
    member.handle = plan.handle;
    member.is_cut_by_source = item.range() != nullptr && plan.source->options().reads_ranges;
}

void SamplingGroup::ask_unbound(Flight& flight, std::size_t index)
{
    ValueItem& item = *members_[index].item;
    ReadPlan plan = plan_sample(sampler_.needs(), item.subscription(), item.target());
    note_source(item, plan);
    if (plan.source == nullptr) {
        flight.call.answer(index - flight.first) = std::move(plan.answer);
        return;
    }
    Member& member = members_[index];
    // It has a source by now; the next sample binds the item to it.
    member.binding = Binding::Unknown;
    member.is_cut_by_source = false;
    flight.call.ask(index - flight.first, plan.source_index, {plan.handle, nullptr});
}

void SamplingGroup::ask(Flight& flight, std::size_t index)
{
    const Member& member = members_[index];
    if (member.item == nullptr) {
        flight.call.answer(index - flight.first).status = status::Good;
        return;
    }
    if (member.binding != Binding::Source) {
        return ask_unbound(flight, index);
    }
    const NumericRange* range = nullptr;
    if (member.is_cut_by_source) {
        flight.ranges.push_back(member.item->shared_range());
        range = flight.ranges.back().get();
    }
    flight.call.ask(index - flight.first, member.source, {member.handle, range});
}

std::size_t SamplingGroup::first_in_flight() const
{
    std::size_t first = members_.size();
    for (const auto& flight : flights_) {
        first = std::min(first, flight->first);
    }
    return first;
}

void SamplingGroup::sample_members(std::size_t first, std::size_t end, TimePoint now, bool is_late)
{
    if (first >= end) {
        return;
    }
    // It counts as under way only when nothing can fail any more: as long as it does, no other one
    // begins.
    flights_.reserve(flights_.size() + 1);
    auto made = std::make_unique<Flight>(*this, first, end - first, is_late);
    Flight& flight = *made;
    for (std::size_t i = 0; i < flight.call.size(); ++i) {
        ask(flight, first + i);
    }
    if (!flight.ranges.empty()) { // sources may use them after the flight
        flight.call.kept_for_sources() =
            std::make_shared<std::vector<std::shared_ptr<const NumericRange>>>(flight.ranges);
    }
    if (flight.call.start(flight, now, [](ReadPart& part) { part.is_sample = true; })) {
        deliver(flight);
        return arm();
    }
    flights_.push_back(std::move(made));
}

void SamplingGroup::land(Flight& flight)
{
    const auto found = std::find_if(flights_.begin(), flights_.end(),
                                    [&](const auto& one) { return one.get() == &flight; });
    const std::unique_ptr<Flight> landed = std::move(*found);
    flights_.erase(found);
    deliver(*landed);
    arm();
}

void SamplingGroup::deliver(Flight& flight)
{
    const DateTime time = sampler_.needs().wall_time();
    for (std::size_t i = 0; i < flight.call.size(); ++i) {
        const Member& member = members_[flight.first + i];
        if (member.item == nullptr) {
            continue;
        }
        ReadSlot* const slot = flight.call.find_answer(i);
        if (slot != nullptr && member.item->range() != nullptr && !member.is_cut_by_source) {
            cut_range(*slot, *member.item->range());
        }
        const ReadSlot& sample = slot != nullptr ? *slot : flight.call.result(i);
        const bool is_overload = flight.is_late && sample.status == StatusCode{};
        busbar::detail::attempt([&] { // without memory for one item the others are still sampled
            member.item->sample(sample, is_overload ? status::Good_Overload : sample.status, time);
        });
    }
}

WatchedImages::Sample SamplingGroup::image_sample(bool is_only_new) const
{
    return {sampler_.needs().wall_time(), is_late_, is_only_new};
}

void SamplingGroup::sample_scan(const ImagePin& pin, TimePoint now, bool has_lost)
{
    notice_changes();
    compact();
    bind(0);
    if (has_lost) {
        images_.note_loss();
    }
    images_.sample(pin, image_sample(false));
    if (flights_.empty()) {
        first_new_ = members_.size();
        sample_members(0, members_.size(), now, false);
    }
}

void SamplingGroup::bind_new()
{
    if (!is_full_of_holes()) {
        notice_changes();
        compact();
        bind(first_new_);
    }
}

void SamplingGroup::sample_new(TimePoint now)
{
    if (!is_full_of_holes()) {
        images_.sample(image_sample(true));
        sample_new_members(now);
    }
}

void SamplingGroup::sample_new(const ImagePin& pin, TimePoint now)
{
    if (!is_full_of_holes()) {
        images_.sample(pin, image_sample(true));
        sample_new_members(now);
    }
}

void SamplingGroup::sample_new_members(TimePoint now)
{
    sample_members(first_new_, members_.size(), now, false);
    first_new_ = members_.size(); // if that fails they are still new
}

void SamplingGroup::sample(TimePoint now)
{
    notice_changes();
    compact();
    bind(0);
    actual_interval_ = last_sample_ == no_deadline ? Duration::zero() : now - last_sample_;
    last_sample_ = now;
    is_late_ = sampler_.is_overload(interval_, actual_interval_);
    images_.sample(image_sample(false));
    if (flights_.empty()) {
        first_new_ = members_.size();
    }
    sample_members(0, first_in_flight(), now, is_late_);
    sample_new_members(now);
}

void SamplingGroup::handle_flights(TimePoint now)
{
    for (std::size_t i = flights_.size(); i-- > 0;) {
        if (flights_[i]->call.handle_deadline(now)) {
            land(*flights_[i]);
        }
    }
}

void SamplingGroup::expire(TimePoint now)
{
    // Re-arm first, so that a throw below cannot stop the timer.
    sampler_.timers().set(*this, now + std::max<Duration>(interval_, std::chrono::milliseconds{1}));
    handle_flights(now);
    if (next_sample_ <= now) {
        // A source that has not answered is not called again. Waiting for the first value of new
        // items does not delay the others.
        if (flights_.empty() || first_in_flight() > 0) {
            // Items without memory are sampled next time; later timers still run.
            busbar::detail::attempt([&] { sample(now); });
        }
        next_sample_ += interval_;
        if (next_sample_ <= now) { // missed samples are not repeated
            next_sample_ = now + interval_;
        }
    }
    if (empty() && flights_.empty()) {
        return sampler_.remove(*this);
    }
    arm();
}

void SamplingGroup::arm()
{
    TimePoint first = next_sample_;
    for (const auto& flight : flights_) {
        first = std::min(first, flight->call.next_deadline());
    }
    sampler_.timers().set(*this, first);
}

} // namespace busbar::server::detail
