#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <busbar/core/detail/large_memory.hpp>

#include "data_part.hpp"

namespace busbar::server::detail {

/// Waits for a SourceCall that did not end at once; lives on the server's thread.
class SourceCallOwner {
public:
    SourceCallOwner() = default;
    SourceCallOwner(const SourceCallOwner&) = delete;
    SourceCallOwner& operator=(const SourceCallOwner&) = delete;

    /// Every operation has its result. The call may be destroyed from here.
    virtual void call_completed() = 0;

protected:
    ~SourceCallOwner() = default;
};

/// For vectors that grow with the size of a request.
template <typename T>
using LargeVector = std::vector<T, busbar::detail::LargeAllocator<T>>;
/// Where they take it from; may be null.
using Memory = busbar::detail::KeptMemory*;

struct ReadTraits {
    using Item = ReadItem;
    using Answer = ReadSlot;
    using Part = ReadPart;
    static constexpr std::string_view callback = "DataSource::read";
    static constexpr bool changes_something = false;
    static constexpr std::array service_results{status::Bad_Shutdown,
                                                status::Bad_TooManyOperations};
    static LargeVector<ReadSlot> answers(std::size_t count, Memory memory)
    {
        return LargeVector<ReadSlot>(count, LargeVector<ReadSlot>::allocator_type{memory});
    }
    static void send(DataSource& source, Part& part) { source.read(ReadBatch{part}); }
    /// Makes an answer own what it points at.
    static void own(ReadSlot& slot)
    {
        const Variant& value = slot.shared != nullptr ? *slot.shared : slot.value;
        slot.value = Variant{value};
        slot.shared = nullptr;
    }
    static void release(Part& part) { part.kept_alive.reset(); }
};

struct WriteTraits {
    using Item = WriteItem;
    using Answer = StatusCode;
    using Part = WritePart;
    static constexpr std::string_view callback = "DataSource::write";
    static constexpr bool changes_something = true;
    static constexpr std::array service_results{status::Bad_Shutdown,
                                                status::Bad_TooManyOperations};
    static LargeVector<StatusCode> answers(std::size_t count, Memory memory)
    {
        return LargeVector<StatusCode>(count, status::Bad_NoCommunication,
                                       LargeVector<StatusCode>::allocator_type{memory});
    }
    static void send(DataSource& source, Part& part) { source.write(WriteBatch{part}); }
    static void own(StatusCode&) {}
    static void release(Part&) {}
};

/// One service call's operations on their way to the sources and back, in a constant number of
/// allocations: a batch for each source, and answers of the server itself.
///
/// First each operation is passed to ask() or answer(), or to neither and then has no result. Then
/// start() is called, and result() has the answers as soon as waiting() is false. Lives on the
/// server's thread; destroying it leaves the batches to their sources.
template <typename Traits>
class SourceCall final : private PartOwner {
public:
    using Item = typename Traits::Item;
    using Answer = typename Traits::Answer;
    using Part = typename Traits::Part;

    SourceCall(DataSources& sources, std::size_t count)
        : sources_{&sources}, block_{std::make_shared<Block>(count, sources.memory())},
          place_(count, allocator<std::uint32_t>()), source_of_{allocator<std::uint32_t>()},
          groups_(sources.size())
    {
        block_->items.reserve(count);
    }
    ~SourceCall() { abandon(); }

    [[nodiscard]] std::size_t size() const { return place_.size(); }

    /// Passes operation `index` to a source, whose index find() knows.
    void ask(std::size_t index, std::uint32_t source, const Item& item)
    {
        Group& group = group_of(source);
        if (group.size != block_->items.size()) {
            note_source(source);
        }
        place_[index] = static_cast<std::uint32_t>(block_->items.size());
        block_->items.push_back(item);
        last_source_ = source;
        ++group.size;
    }
    /// Returns the place for the server's own answer to operation `index`.
    [[nodiscard]] Answer& answer(std::size_t index)
    {
        const std::size_t place = size() - ++answered_;
        place_[index] = static_cast<std::uint32_t>(place);
        return block_->answers[place];
    }
    /// Takes back every ask(), before start(). Answers stay, as does what sources were refused.
    void take_back()
    {
        for (std::uint32_t& place : place_) {
            place = place < block_->items.size() ? 0 : place;
        }
        block_->items.clear();
        source_of_.clear();
        for (Group& group : groups_) {
            group.size = 0;
        }
    }
    /// Returns whether operation `index` has an answer of the server itself, before start().
    [[nodiscard]] bool is_answered(std::size_t index) const
    {
        return place_[index] >= size() - answered_;
    }
    /// Drops the present and future operations of `source`, which answer `status`.
    void refuse(std::uint32_t source, StatusCode status) { group_of(source).refusal = status; }

    /// Gives every source its batch; `prepare(part)` sees each before. True if all are answered;
    /// else `owner` is notified later, once.
    template <typename Prepare>
    [[nodiscard]] bool start(SourceCallOwner& owner, TimePoint now, Prepare prepare)
    {
        now_ = now;
        group();
        owner_ = &owner;
        for (std::uint32_t i = 0; i < groups_.size(); ++i) {
            if (groups_[i].size != 0) {
                send(groups_[i], *sources_->find(i), prepare);
            }
        }
        if (waiting()) {
            own_answers();
        }
        return !waiting();
    }
    [[nodiscard]] bool waiting() const { return waiting_ != 0; }
    /// The time when the first of the pending sources is late.
    [[nodiscard]] TimePoint next_deadline() const
    {
        TimePoint first = no_deadline;
        for (const Group& group : groups_) {
            first = group.waiting ? std::min(first, group.deadline) : first;
        }
        return first;
    }
    /// Answers Bad_Timeout for the sources that are late; true if nothing is pending any more.
    [[nodiscard]] bool handle_deadline(TimePoint now)
    {
        for (Group& group : groups_) {
            if (group.waiting && group.deadline <= now) {
                block_->parts[group.part].abandon();
                stop_waiting(group);
                fail(group, status::Bad_Timeout);
            }
        }
        return !waiting();
    }
    /// The result of operation `index`; only when waiting() is false.
    [[nodiscard]] const Answer& result(std::size_t index) const
    {
        const std::uint32_t place = place_[index];
        return place < size() ? block_->answers[place] : failures_[place - size()];
    }
    /// The result of operation `index` at any time; null if it has none yet, or its source may
    /// still change it.
    [[nodiscard]] const Answer* find_result(std::size_t index) const
    {
        const std::uint32_t place = place_[index];
        if (place >= size() - answered_) {
            return &result(index);
        }
        const auto is_of = [&](const Group& group) {
            return place >= group.first && place - group.first < group.size;
        };
        const auto found = std::find_if(groups_.begin(), groups_.end(), is_of);
        if (owner_ == nullptr || found == groups_.end()) {
            return nullptr;
        }
        const Part& part = block_->parts[found->part];
        return part.is_complete() && part.verdict() == StatusCode{} ? &result(index) : nullptr;
    }
    /// The answer of operation `index`, for which find_result() is null though its source will not
    /// change it any more.
    [[nodiscard]] const Answer& settled_answer(std::size_t index) const
    {
        return block_->answers[place_[index]];
    }
    /// True if the whole batch of operation `index` failed, or is late: its result is not that of
    /// the operation.
    [[nodiscard]] bool has_failed(std::size_t index) const { return place_[index] >= size(); }
    /// The batch of operation `index`, once its source has completed it; null for one that was
    /// answered here, or whose source is late.
    [[nodiscard]] const Part* part_of(std::size_t index) const
    {
        const std::uint32_t place = place_[index];
        const auto is_of = [&](const Group& group) {
            return place == group.failure_place ||
                   (place >= group.first && place - group.first < group.size);
        };
        const auto found = std::find_if(groups_.begin(), groups_.end(), is_of);
        const bool is_there = found != groups_.end() && block_->parts != nullptr;
        const Part* const part = is_there ? &block_->parts[found->part] : nullptr;
        return part != nullptr && part->is_complete() ? part : nullptr;
    }
    /// The answer of an operation as above, to be changed; null if the whole batch failed.
    [[nodiscard]] Answer* find_answer(std::size_t index)
    {
        const std::uint32_t place = place_[index];
        return place < size() ? &block_->answers[place] : nullptr;
    }
    /// Bad if a source that decides services failed its batch with a status that is the service's
    /// (DataSourceOptions::decides_services). For calls that change something only if everything
    /// was for that source: changes by other sources must be reported.
    [[nodiscard]] StatusCode service_result() const
    {
        for (std::uint32_t i = 0; i < groups_.size(); ++i) {
            const Group& group = groups_[i];
            const bool counts = group.size != 0 && group.failure.is_bad() &&
                                (!Traits::changes_something || group.size == size());
            if (counts && (*sources_->find(i))->options().decides_services &&
                std::find(Traits::service_results.begin(), Traits::service_results.end(),
                          group.failure) != Traits::service_results.end()) {
                return group.failure;
            }
        }
        return status::Good;
    }
    /// Memory that the sources keep as long as they may use the call's memory.
    [[nodiscard]] std::shared_ptr<const void>& kept_for_sources() { return block_->kept; }

private:
    struct Block {
        Block(std::size_t count, Memory memory)
            : items{typename LargeVector<Item>::allocator_type{memory}}, answers{Traits::answers(
                                                                             count, memory)}
        {
        }

        LargeVector<Item> items;
        LargeVector<Answer> answers;
        std::unique_ptr<Part[]> parts;
        std::shared_ptr<const void> kept;
    };
    struct Group {
        std::uint32_t size{0};
        std::uint32_t first{0};
        std::uint32_t part{0};
        bool waiting{false};
        StatusCode refusal;
        StatusCode failure;
        /// The place of its operations' answer if it failed.
        std::uint32_t failure_place{UINT32_MAX};
        TimePoint deadline{no_deadline};
    };

    template <typename T>
    [[nodiscard]] busbar::detail::LargeAllocator<T> allocator() const
    {
        return busbar::detail::LargeAllocator<T>{sources_->memory()};
    }
    /// Returns the group of a source, also of one that was added since the request began. Valid
    /// until the next call.
    [[nodiscard]] Group& group_of(std::uint32_t source)
    {
        if (source >= groups_.size()) {
            groups_.resize(std::size_t{source} + 1);
        }
        return groups_[source];
    }
    /// Records the source of the next item, and at first those of the previous ones.
    void note_source(std::uint32_t source)
    {
        if (source_of_.empty()) {
            source_of_.reserve(size());
        }
        source_of_.resize(block_->items.size(), last_source_);
        source_of_.push_back(source);
    }
    /// Sorts the items by source; usually they are in order already.
    void group()
    {
        std::uint32_t first = 0;
        std::uint32_t used = 0;
        for (Group& group : groups_) {
            group.first = first;
            first += group.size;
            group.part = used;
            used += group.size != 0 ? 1 : 0;
        }
        if (used != 0) {
            block_->parts = std::make_unique<Part[]>(used);
        }
        if (used > 1) {
            failures_.reserve(used);
            sort_items();
        }
    }
    void sort_items()
    {
        std::vector<std::uint32_t> next(groups_.size());
        for (std::size_t i = 0; i < groups_.size(); ++i) {
            next[i] = groups_[i].first;
        }
        LargeVector<Item> sorted(block_->items.size(), allocator<Item>());
        LargeVector<std::uint32_t>& place_of = source_of_;
        for (std::size_t i = 0; i < sorted.size(); ++i) {
            const std::uint32_t place = next[source_of_[i]]++;
            sorted[place] = block_->items[i];
            place_of[i] = place;
        }
        for (std::uint32_t& place : place_) {
            place = place < sorted.size() ? place_of[place] : place;
        }
        block_->items = std::move(sorted);
    }
    template <typename Prepare>
    void send(Group& group, const std::shared_ptr<SourceEntry>& source, Prepare& prepare)
    {
        Part& part = block_->parts[group.part];
        if (group.refusal != StatusCode{}) {
            return fail(group, group.refusal);
        }
        if (const StatusCode obstacle = source->obstacle(); obstacle.is_bad()) {
            return fail(group, obstacle);
        }
        if (!part.admit(source, group.size)) {
            return fail(group, status::Bad_TooManyOperations);
        }
        part.items = std::span{block_->items}.subspan(group.first, group.size);
        part.results = block_->answers.data() + group.first;
        prepare(part);
        part.start(block_);
        const StatusCode thrown = source->guard(
            Traits::callback, [&](DataSource& called) { Traits::send(called, part); });
        if (thrown.is_bad()) { // even if the batch is complete
            part.abandon();
            return fail(group, thrown);
        }
        if (part.settle(*this)) {
            return take_verdict(group, part);
        }
        group.waiting = true;
        group.deadline = now_ + source->options().timeout;
        ++waiting_;
    }
    void part_completed(detail::Part& part) override
    {
        for (Group& group : groups_) {
            if (group.waiting && &block_->parts[group.part] == &part) {
                stop_waiting(group);
                take_verdict(group, block_->parts[group.part]);
                if (waiting()) {
                    own_answers(group);
                }
                break;
            }
        }
        if (!waiting()) {
            owner_->call_completed();
        }
    }
    /// A pending call must not refer to objects of a source or of the address space.
    void own_answers()
    {
        for (std::size_t i = size() - answered_; i < size(); ++i) {
            Traits::own(block_->answers[i]);
        }
        for (Group& group : groups_) {
            if (group.size != 0 && !group.waiting) {
                own_answers(group);
            }
        }
    }
    void own_answers(const Group& group)
    {
        if (group.failure == StatusCode{}) {
            for (Answer& answer : std::span{block_->answers}.subspan(group.first, group.size)) {
                Traits::own(answer);
            }
            Traits::release(block_->parts[group.part]);
        }
    }
    void stop_waiting(Group& group)
    {
        group.waiting = false;
        --waiting_;
    }
    void take_verdict(Group& group, const Part& part)
    {
        if (part.verdict() != StatusCode{}) {
            fail(group, part.verdict());
        }
    }
    /// Leaves the group's answers alone, since the source may still use them: all its operations
    /// get one common answer.
    void fail(Group& group, StatusCode status)
    {
        group.failure = status;
        const auto place = static_cast<std::uint32_t>(size() + failures_.size());
        group.failure_place = place;
        failures_.emplace_back(status);
        for (std::uint32_t& p : place_) {
            if (p >= group.first && p - group.first < group.size) {
                p = place;
            }
        }
    }
    void abandon()
    {
        for (const Group& group : groups_) {
            if (group.waiting) {
                block_->parts[group.part].abandon();
            }
        }
    }

    DataSources* sources_;
    SourceCallOwner* owner_{nullptr};
    std::shared_ptr<Block> block_;
    /// The place of each operation's answer: in the block's answers, or after them in failures_.
    LargeVector<std::uint32_t> place_;
    /// The source of each item; empty as long as all items have the last one.
    LargeVector<std::uint32_t> source_of_;
    std::uint32_t last_source_{0};
    std::vector<Group> groups_;
    std::vector<Answer> failures_;
    std::size_t answered_{0};
    std::size_t waiting_{0};
    TimePoint now_;
};

using SourceRead = SourceCall<ReadTraits>;
using SourceWrite = SourceCall<WriteTraits>;

} // namespace busbar::server::detail
