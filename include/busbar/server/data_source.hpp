#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/data_value.hpp>
#include <busbar/core/numeric_range.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/server/method.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::model {
struct BoundValue;
} // namespace busbar::model

/// What a PLC backend implements to give the server its values; `memory_source.hpp` is a whole one.
namespace busbar::server {

namespace detail {
class DataSources;
class ReadPart;
class SourceEntry;
class WritePart;
} // namespace detail

class ProcessImage;

/// One value that is asked for.
struct ReadItem {
    /// What the backend called the variable when its node was created.
    std::uint64_t handle{0};
    /// The part that is asked for, null for all of it. Always null unless the options of the source
    /// say that it cuts ranges; otherwise the server cuts them out of the whole value.
    const NumericRange* range{nullptr};
};

/// Where a source puts one answer: value, status and source timestamp. The server adds its own
/// timestamp and leaves out what the client did not ask for.
struct ReadSlot : DataValue {
    using DataValue::operator=;
    ReadSlot() : ReadSlot{status::Bad_NoCommunication} {}
    explicit ReadSlot(StatusCode code) : DataValue{code} {}

    /// Not null: the value is this one and not `value`. It saves the copy of arrays and structures
    /// that lie in memory which the batch keeps alive, see ReadBatch::keep_alive.
    const Variant* shared{nullptr};
};

/// One value to write.
struct WriteItem {
    std::uint64_t handle{0};
    /// The part to replace, null for all of it; always null unless the source's options say that
    /// it writes ranges. The value then has the shape of the range, not of the variable.
    const NumericRange* range{nullptr};
    /// Never null. Its value has the variable's data type and rank. Status and timestamps differ
    /// from Good and zero only where the variable's access level has StatusWrite and
    /// TimestampWrite. Copy what outlives the batch.
    const DataValue* data{nullptr};
};

/// The values that one service call wants of one source, of one point in time if it has such.
/// It owns its memory together with the server: items, slots and what keep_alive was given are
/// valid until the batch is completed or destroyed, even if client, session and server are long
/// gone. Complete it once, inline in DataSource::read or later, on any thread, but on one at a
/// time. Destroying it completes it with the slots as they are: one that was never filled answers
/// Bad_NoCommunication.
class BUSBAR_API ReadBatch {
public:
    explicit ReadBatch(detail::ReadPart& part);
    ReadBatch(ReadBatch&& other) noexcept;
    ReadBatch& operator=(ReadBatch&& other) noexcept;
    ~ReadBatch() { complete(); }

    [[nodiscard]] std::size_t size() const { return items_.size(); }
    [[nodiscard]] std::span<const ReadItem> items() const { return items_; }
    /// One slot for each item, in the same order.
    [[nodiscard]] std::span<ReadSlot> results() { return {slots_, items_.size()}; }
    /// A source that caches remote values may answer with one that is no older than this (Part 4,
    /// 5.11.2.2); zero asks for a new one.
    [[nodiscard]] std::chrono::milliseconds max_age() const { return max_age_; }
    /// True for what MonitoredItems of one sampling interval are sampled with, false for a Read.
    [[nodiscard]] bool is_sample() const { return is_sample_; }

    /// Holds `memory` as long as anything in the slots may be used: String::borrow,
    /// ByteString::borrow and ReadSlot::shared may point into it. For a batch that is completed
    /// inline that is until the answer is encoded, right after DataSource::read; if the answer
    /// waits for another source, the server copies first. Without this call, such a batch may also
    /// point at what only the server's thread changes or frees. Any thread may release it.
    void keep_alive(std::shared_ptr<const void> memory);

    /// Hands the slots to the server. The batch is empty afterwards; more calls do nothing.
    void complete();
    /// Completes with `status`, which must be bad, for each item.
    void fail(StatusCode status);

private:
    detail::ReadPart* part_;
    std::span<const ReadItem> items_;
    ReadSlot* slots_;
    std::chrono::milliseconds max_age_;
    bool is_sample_;
};

/// The values that one Write call has for one source, to be applied together if the source can do
/// that. A later item wins over an earlier one with the same handle.
/// In everything else like ReadBatch: a result that was never set answers Bad_NoCommunication.
class BUSBAR_API WriteBatch {
public:
    explicit WriteBatch(detail::WritePart& part);
    WriteBatch(WriteBatch&& other) noexcept;
    WriteBatch& operator=(WriteBatch&& other) noexcept;
    ~WriteBatch() { complete(); }

    [[nodiscard]] std::size_t size() const { return items_.size(); }
    [[nodiscard]] std::span<const WriteItem> items() const { return items_; }
    /// One status for each item, in the same order.
    [[nodiscard]] std::span<StatusCode> results() { return {results_, items_.size()}; }

    void complete();
    /// Completes with `status` for each item; Good is allowed. `reason` is CallResult::reason.
    void finish(StatusCode status, std::string reason = {});

private:
    detail::WritePart* part_;
    std::span<const WriteItem> items_;
    StatusCode* results_;
};

/// How a variable is monitored by the items of all clients together.
struct Monitoring {
    std::uint64_t handle{0};
    /// The shortest of their sampling intervals, as revised; zero where each scan of a process
    /// image is looked at. Nothing: the variable is not monitored any more.
    std::optional<Duration> interval;

    friend bool operator==(const Monitoring&, const Monitoring&) = default;
};

/// What a source can do and how much the server may ask of it; taken once, when it is added.
struct DataSourceOptions {
    /// The source returns the part that ReadItem::range names.
    bool reads_ranges{false};
    /// It replaces the part that WriteItem::range names; else that is Bad_WriteNotSupported.
    bool writes_ranges{false};
    /// Longer arrays than ArrayDimensions says are Bad_WriteNotSupported, else Bad_TypeMismatch.
    bool has_fixed_lengths{false};
    /// Bad_Shutdown, and Bad_TooManyOperations of Read and Write, for a batch is the ServiceResult.
    bool decides_services{false};
    /// A Write is done for all its items of this source or for none, whoever refuses one of them;
    /// those that the server would not have refused answer Bad_NoCommunication.
    bool all_or_nothing{false};
    /// How long a batch may take until its items answer Bad_Timeout; never more than the client's
    /// own timeout. The batch stays valid; its late completion is dropped.
    std::chrono::milliseconds timeout{5000};
    /// Batches and items that it may hold, also late ones; past them Bad_TooManyOperations.
    std::size_t max_batches{256};
    std::size_t max_items{1'000'000};
    /// Of monitored_size() of all MonitoredItems together; past it Bad_TooManyMonitoredItems.
    std::size_t max_monitored_size{SIZE_MAX};
    /// The server's own: is called while that is Suspended, has Failed or counts down, too.
    bool is_always_in_service{false};
};

/// A backend: a controller's memory, a bus, a remote PLC.
/// The server calls it from the server's thread only and never while a call is running. It must
/// not block: work that takes time keeps the batch and completes it later. An exception ends the
/// call that it comes from and nothing else: the items of that batch answer Bad_InternalError, and
/// the log names the function. Batches may outlive source and server.
///
/// Source and server may end in any order. A source that was given as a std::shared_ptr lives as
/// long as the server. One that was given as a reference detaches itself when it is destroyed, on
/// the server's thread and in none of its own calls: from then on nothing calls it, its Variables
/// answer Bad_NoCommunication, monitored items at their next sample, and its index is not given
/// again. No lock is taken for that.
/// Its virtual functions are inline: a library without RTTI would keep its typeinfo to itself.
class BUSBAR_API DataSource {
public:
    DataSource() = default;
    DataSource(const DataSource&) = delete;
    DataSource& operator=(const DataSource&) = delete;
    virtual ~DataSource() { detach(); }

    /// The index that nodes carry (NewVariable::source), of the server that the source was added to
    /// last; model::no_source before.
    [[nodiscard]] std::uint32_t index() const { return index_; }
    /// What AddressSpace::add_variable takes for a Variable that the backend calls `handle`. `like`
    /// is a value of its DataType, ValueRank and ArrayDimensions, and nothing else is done with it.
    /// The source must have been added: if not, this binds nothing and the Variable is refused.
    [[nodiscard]] model::BoundValue variable(std::uint64_t handle, const Variant& like) const;

    [[nodiscard]] virtual DataSourceOptions options() const { return {}; }
    /// Answers every item of the batch: with its value and source timestamp, or with a bad status,
    /// such as Bad_NoCommunication for a PLC that is not there. The same handle may come twice.
    virtual void read(ReadBatch batch) = 0;
    /// Applies every item of the batch. A read-only source does not override this.
    virtual void write(WriteBatch batch) { batch.finish(status::Bad_NotWritable); }
    /// Carries out every Method of the batch, in any order. A source without Methods does not
    /// override this.
    virtual void call(CallBatch batch) { batch.fail(status::Bad_NotImplemented); }

    /// What a MonitoredItem of the variable, or of a part of it, counts as until it is deleted, or
    /// the bad status that refuses it. Asked once, when the item is created.
    [[nodiscard]] virtual Result<std::size_t> monitored_size(std::uint64_t) const { return 0; }
    /// Tells which variables are monitored, for a backend that prepares for it: that begins a
    /// cyclic transfer, say. Each change is told once, with the shortest interval at that time: a
    /// variable begins, gets another interval, or ends; only what has begun can end, and it can
    /// begin again. One call has all that a service call changed, each handle once, in no order.
    ///
    /// Comes before the first read() for a new item, and otherwise at the end of what made the
    /// change: a request, the end of a session or Subscription, or the sample that finds the
    /// Variable bound elsewhere. Everything ends when the server is destroyed. Items that are
    /// disabled or whose user may not read do not count. Must not call the server; `changes` is
    /// valid until it returns.
    virtual void monitoring_changed(std::span<const Monitoring> /*changes*/) {}

    /// For a source whose own thread must not complete batches, since that may free memory: that
    /// thread calls the waker, and the server's thread then calls handle_completions(), which
    /// completes them. attach() is called with null before the waker ends; when that call returns,
    /// the source must no longer use it.
    virtual void attach(Waker* /*waker*/) {}
    virtual void handle_completions() {}
    /// Not null for a source whose values all lie in a process image, by the handles of its layout:
    /// monitored items are then sampled there, without a call of read().
    [[nodiscard]] virtual ProcessImage* process_image() { return nullptr; }

private:
    friend class detail::DataSources;
    friend class detail::SourceEntry;

    void detach();

    std::uint32_t index_{UINT32_MAX};
    /// What its servers find it by, made for the first of them; holds null when it is gone.
    std::shared_ptr<DataSource*> self_;
};

} // namespace busbar::server
