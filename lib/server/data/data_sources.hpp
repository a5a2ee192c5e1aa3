#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/detail/hand_over.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::server::detail {

class Part;

/// Completed parts on their way from any thread to the server's: a push never blocks.
class CompletionQueue {
public:
    /// `waker` may be null; it must be valid until close().
    explicit CompletionQueue(Waker* waker) : waker_{waker} {}
    CompletionQueue(const CompletionQueue&) = delete;
    CompletionQueue& operator=(const CompletionQueue&) = delete;

    /// From any thread. Wakes the server if nothing was queued.
    void push(Part& part);
    /// On the server's thread: tells the owner of each part, in the order of completion. What an
    /// owner throws comes through; the others are told by the next call, for which the server is
    /// woken.
    void drain();
    /// On the server's thread: drops what is queued and what still comes. The Waker is not in use
    /// any more afterwards.
    void close();

private:
    static void drop(Part* first);

    busbar::detail::HandOver<Part> completed_;
    /// Those that drain() has taken, the oldest first.
    Part* told_next_{nullptr};
    std::atomic<bool> closed_{false};
    busbar::detail::WakerSlot waker_;
};

/// A source, while it is there, with what it was given and has not completed; shared with its
/// batches.
class SourceEntry {
public:
    /// `log` is used on the server's thread, while the server lives.
    SourceEntry(DataSource& source, std::shared_ptr<CompletionQueue> queue, LogSink& log);

    /// False once the source was destroyed. On the server's thread, as the destruction is.
    [[nodiscard]] bool is_attached() const { return *source_ != nullptr; }
    /// Good, or why nothing is asked of the source: Bad_NoCommunication once it is gone, or what
    /// DataSources::suspend said.
    [[nodiscard]] StatusCode obstacle() const
    {
        return is_attached() ? suspension_ : status::Bad_NoCommunication;
    }
    /// No obstacle for a source that is always in service. On the server's thread.
    void suspend(StatusCode status)
    {
        suspension_ = options_.is_always_in_service ? status::Good : status;
    }
    /// Calls `function(source)`; what it throws ends there, see busbar::detail::guarded.
    /// Bad_NoCommunication, and nothing is called, if the source is gone.
    template <typename Function>
    StatusCode guard(std::string_view callback, Function&& function) const
    {
        DataSource* const source = *source_;
        return source == nullptr
                   ? status::Bad_NoCommunication
                   : busbar::detail::guarded(*log_, callback, [&] { function(*source); });
    }
    /// Null if the source has none, or threw.
    [[nodiscard]] ProcessImage* process_image() const;
    [[nodiscard]] LogSink& log() const { return *log_; }
    [[nodiscard]] const DataSourceOptions& options() const { return options_; }
    [[nodiscard]] CompletionQueue& queue() { return *queue_; }

    /// On the server's thread; false if that were more than the options allow.
    [[nodiscard]] bool charge(std::size_t item_count);
    /// From any thread.
    void release(std::size_t item_count);
    /// What a new MonitoredItem of the variable counts as, which release_monitored() gives back.
    /// Bad if there can be none. Both on the server's thread.
    [[nodiscard]] Result<std::size_t> charge_monitored(std::uint64_t handle);
    void release_monitored(std::size_t size) { monitored_size_ -= size; }

private:
    /// The source's own, see DataSource.
    std::shared_ptr<DataSource* const> source_;
    DataSourceOptions options_;
    std::shared_ptr<CompletionQueue> queue_;
    LogSink* log_;
    StatusCode suspension_;
    std::atomic<std::size_t> batches_{0};
    std::atomic<std::size_t> items_{0};
    std::size_t monitored_size_{0};
};

/// The sources of a server; a node names its own by index. Lives on the server's thread.
class DataSources {
public:
    /// `log` gets what sources throw; null for none.
    explicit DataSources(Waker* waker, LogSink* log = nullptr)
        : waker_{waker}, log_{log != nullptr ? log : &no_log_},
          queue_{std::make_shared<CompletionQueue>(waker)}
    {
    }
    DataSources(const DataSources&) = delete;
    DataSources& operator=(const DataSources&) = delete;
    ~DataSources();

    /// The index that nodes are to carry; `source` may end first.
    std::uint32_t add(DataSource& source);
    /// The same with a source that this object keeps.
    std::uint32_t add(std::shared_ptr<DataSource> source);
    [[nodiscard]] std::size_t size() const { return entries_.size(); }
    /// Null for an index that add() never gave.
    [[nodiscard]] const std::shared_ptr<SourceEntry>* find(std::uint32_t index) const
    {
        return index < entries_.size() ? &entries_[index] : nullptr;
    }
    /// From now on nothing is asked of the sources, those that are to come too: it answers
    /// `status`. Good ends that. What they were asked before is not touched.
    void suspend(StatusCode status);
    /// Tells those who wait for batches that were completed meanwhile.
    void handle_completions();

private:
    NullLog no_log_;
    Waker* waker_;
    LogSink* log_;
    std::shared_ptr<CompletionQueue> queue_;
    StatusCode suspension_;
    std::vector<std::shared_ptr<DataSource>> kept_;
    std::vector<std::shared_ptr<SourceEntry>> entries_;
};

} // namespace busbar::server::detail
