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

/// What waits for batches; lives on the server's thread.
class PartOwner {
public:
    PartOwner() = default;
    PartOwner(const PartOwner&) = delete;
    PartOwner& operator=(const PartOwner&) = delete;

    /// `part`, for which the owner waited, is complete and its results may be read.
    virtual void part_completed(Part& part) = 0;

protected:
    ~PartOwner() = default;
};

/// What server and source share of one batch: where its answer goes.
///
/// It lies in memory that both hold, so that neither minds which of them goes first. Until it is
/// complete its results belong to the source, afterwards to the server; `state_` hands them over.
class Part {
public:
    Part() = default;
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

    // For the server's thread.

    /// Charges the source; false, and nothing is done, if it has as much as it may have.
    [[nodiscard]] bool admit(const std::shared_ptr<SourceEntry>& source, std::size_t item_count);
    /// `memory` owns this part. Called after admit() and before the source gets the batch.
    void start(std::shared_ptr<void> memory) { memory_ = std::move(memory); }
    /// Called behind the call of the source: true if the batch is complete, else `owner` is told
    /// when it is.
    [[nodiscard]] bool settle(PartOwner& owner);
    /// The owner waits no longer; its results are never read again.
    void abandon();
    [[nodiscard]] const SourceEntry& source() const { return *source_; }
    /// What the source said of the whole batch, Good if it filled the results.
    [[nodiscard]] StatusCode verdict() const { return verdict_; }
    /// False while the source may change what the part holds.
    [[nodiscard]] bool is_complete() const { return state_.load() == State::Complete; }

    // For the source, from any thread.

    /// True once nobody waits for it.
    [[nodiscard]] bool is_abandoned() const { return state_.load() == State::Abandoned; }
    /// The one call that ends what start() began. A bad `verdict` stands for every item.
    void complete(StatusCode verdict = status::Good);

    /// The CompletionQueue's.
    Part* next{nullptr};

private:
    friend class CompletionQueue;

    enum class State : std::uint8_t {
        Running,   // the source is being called, or was never
        Waiting,   // the owner waits for a completion through the queue
        Complete,  // the results are the server's
        Abandoned, // nobody waits
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
