#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <busbar/server/data_source.hpp>

#include "data_sources.hpp"

namespace busbar::server::detail {

class Part;

/// Waits for batches; lives on the server's thread.
class PartOwner {
public:
    PartOwner() = default;
    PartOwner(const PartOwner&) = delete;
    PartOwner& operator=(const PartOwner&) = delete;

    /// `part`, which the owner waited for, is complete and its results may be read.
    virtual void part_completed(Part& part) = 0;

protected:
    ~PartOwner() = default;
};

/// The common state of server and source for one batch: the destination of its answer.
///
/// It is in memory that both hold, so that either may be destroyed first. Until it is complete its
/// results belong to the source, afterwards to the server; `state_` hands them over.
class Part {
public:
    Part() = default;
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

    // Called on the server's thread.

    /// Charges the source; false, with nothing done, if it already has its maximum.
    [[nodiscard]] bool admit(const std::shared_ptr<SourceEntry>& source, std::size_t item_count);
    /// `memory` owns this part. Called after admit() and before the source gets the batch.
    void start(std::shared_ptr<void> memory) { memory_ = std::move(memory); }
    /// Call after the call of the source: true if the batch is complete, else `owner` is notified
    /// when it is.
    [[nodiscard]] bool settle(PartOwner& owner);
    /// The owner no longer waits; the results are never read.
    void abandon();
    [[nodiscard]] const SourceEntry& source() const { return *source_; }
    /// The source's status for the whole batch, Good if it filled the results.
    [[nodiscard]] StatusCode verdict() const { return verdict_; }
    /// False while the source may change the part.
    [[nodiscard]] bool is_complete() const { return state_.load() == State::Complete; }

    // Called by the source, on any thread.

    /// True once its owner no longer waits.
    [[nodiscard]] bool is_abandoned() const { return state_.load() == State::Abandoned; }
    /// Ends what start() began; called once. A bad `verdict` applies to every item.
    void complete(StatusCode verdict = status::Good);

    /// Used by the CompletionQueue.
    Part* next{nullptr};

private:
    friend class CompletionQueue;

    enum class State : std::uint8_t {
        Running,   // the source is being called, or was never called
        Waiting,   // the owner waits for a completion through the queue
        Complete,  // the results belong to the server
        Abandoned, // its owner no longer waits
    };

    std::atomic<State> state_{State::Running};
    StatusCode verdict_;
    std::size_t item_count_{0};
    std::shared_ptr<SourceEntry> source_;
    std::shared_ptr<void> memory_;
    PartOwner* owner_{nullptr};
};

class ReadPart : public Part {
public:
    std::span<const ReadItem> items;
    ReadSlot* results{nullptr};
    std::chrono::milliseconds max_age{0};
    bool is_sample{false};
    std::shared_ptr<const void> kept_alive;
};

class WritePart : public Part {
public:
    std::span<const WriteItem> items;
    StatusCode* results{nullptr};
    std::string reason;
};

} // namespace busbar::server::detail
