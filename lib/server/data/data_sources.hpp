#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/detail/hand_over.hpp>
#include <busbar/core/detail/large_memory.hpp>
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

    /// Called from any thread. Wakes the server if the queue was empty.
    void push(Part& part);
    /// Called on the server's thread: notifies the owner of each part, in the order of completion.
    /// An owner's exception is passed on; the next call, for which the server is woken, notifies
    /// the others.
    void drain();
    /// Called on the server's thread: drops present and future parts. The Waker is not in use any
    /// more afterwards.
    void close();

private:
    static void drop(Part* first);

    busbar::detail::HandOver<Part> completed_;
    /// Parts that drain() has taken, the oldest first.
    Part* told_next_{nullptr};
    std::atomic<bool> closed_{false};
    busbar::detail::WakerSlot waker_;
};

/// A source with the batches that it has not completed; shared with these batches.
class SourceEntry {
public:
    /// `log` is used on the server's thread, while the server lives.
    SourceEntry(DataSource& source, std::shared_ptr<CompletionQueue> queue, LogSink& log);

    /// False once the source was destroyed. Called on the server's thread, on which the destruction
    /// happens too.
    [[nodiscard]] bool is_attached() const { return *source_ != nullptr; }
    /// Good, or the reason why the source is not called: Bad_NoCommunication once it is destroyed,
    /// or the status of DataSources::suspend.
    [[nodiscard]] StatusCode obstacle() const
    {
        return is_attached() ? suspension_ : status::Bad_NoCommunication;
    }
    /// Has no effect on a source that is always in service. Called on the server's thread.
    void suspend(StatusCode status)
    {
        suspension_ = options_.is_always_in_service ? status::Good : status;
    }
    /// Calls `function(source)` and catches its exceptions, see busbar::detail::guarded.
    /// Bad_NoCommunication, without a call, if the source is destroyed.
    template <typename Function>
    StatusCode guard(std::string_view callback, Function&& function) const
    {
        DataSource* const source = *source_;
        return source == nullptr
                   ? status::Bad_NoCommunication
                   : busbar::detail::guarded(*log_, callback, [&] { function(*source); });
    }
    /// Returns null if the source has none, or threw.
    [[nodiscard]] ProcessImage* process_image() const;
    [[nodiscard]] LogSink& log() const { return *log_; }
    [[nodiscard]] const DataSourceOptions& options() const { return options_; }
    [[nodiscard]] CompletionQueue& queue() { return *queue_; }

    /// Called on the server's thread; false if the options do not allow more.
    [[nodiscard]] bool charge(std::size_t item_count);
    /// Called from any thread.
    void release(std::size_t item_count);
    /// Returns the size that a new MonitoredItem of the variable counts, which release_monitored()
    /// returns. Fails if there can be none. Both are called on the server's thread.
    [[nodiscard]] Result<std::size_t> charge_monitored(std::uint64_t handle);
    void release_monitored(std::size_t size) { monitored_size_ -= size; }

private:
    /// Owned by the source, see DataSource.
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
    /// `log` gets exceptions of sources, and `memory` keeps that of large requests; both may be
    /// null.
    explicit DataSources(Waker* waker, LogSink* log = nullptr,
                         busbar::detail::KeptMemory* memory = nullptr)
        : waker_{waker}, log_{log != nullptr ? log : &no_log_}, memory_{memory},
          queue_{std::make_shared<CompletionQueue>(waker)}
    {
    }
    DataSources(const DataSources&) = delete;
    DataSources& operator=(const DataSources&) = delete;
    ~DataSources();

    /// Returns the index that nodes refer to; `source` may end first.
    std::uint32_t add(DataSource& source);
    /// Adds a source that this object keeps.
    std::uint32_t add(std::shared_ptr<DataSource> source);
    [[nodiscard]] std::size_t size() const { return entries_.size(); }
    [[nodiscard]] busbar::detail::KeptMemory* memory() const { return memory_; }
    /// Returns null for an index that add() never returned.
    [[nodiscard]] const std::shared_ptr<SourceEntry>* find(std::uint32_t index) const
    {
        return index < entries_.size() ? &entries_[index] : nullptr;
    }
    /// From now on no source, including future ones, is called: requests answer `status`. Good ends
    /// that. Pending batches are not affected.
    void suspend(StatusCode status);
    /// Notifies the owners of batches that were completed meanwhile.
    void handle_completions();

private:
    NullLog no_log_;
    Waker* waker_;
    LogSink* log_;
    busbar::detail::KeptMemory* memory_;
    std::shared_ptr<CompletionQueue> queue_;
    StatusCode suspension_;
    std::vector<std::shared_ptr<DataSource>> kept_;
    std::vector<std::shared_ptr<SourceEntry>> entries_;
};

} // namespace busbar::server::detail
