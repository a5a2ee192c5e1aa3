#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/data_value.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/numeric_range.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/server/method.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::model {
struct BoundValue;
} // namespace busbar::model

/// The interface of a PLC backend to the server; memory_source.hpp has a complete one.
namespace busbar::server {

namespace detail {
class DataSources;
class ReadPart;
class SourceEntry;
class WritePart;
} // namespace detail

class ProcessImage;

/// One requested value.
struct ReadItem {
    /// The backend's handle of the variable, set when its node was created.
    std::uint64_t handle{0};
    /// The requested part, null for the whole value. Always null unless the options of the source
    /// say that it reads ranges; otherwise the server cuts them out of the whole value.
    const NumericRange* range{nullptr};
};

/// The place for one answer: value, status and source timestamp. The server adds its own timestamp
/// and leaves out what the client did not request.
struct ReadSlot : DataValue {
    using DataValue::operator=;
    ReadSlot() : ReadSlot{status::Bad_NoCommunication} {}
    explicit ReadSlot(StatusCode code) : DataValue{code} {}

    /// If not null, the value is this one and not `value`. It saves copying arrays and structures
    /// in memory that the batch keeps alive, see ReadBatch::keep_alive.
    const Variant* shared{nullptr};
};

/// One value to write.
struct WriteItem {
    std::uint64_t handle{0};
    /// The part to replace, null for the whole value; always null unless the source's options say
    /// that it writes ranges. The value then has the shape of the range, not of the variable.
    const NumericRange* range{nullptr};
    /// Never null. Its value has the variable's data type and rank. Status and timestamps differ
    /// from Good and zero only if the variable's access level has StatusWrite and TimestampWrite.
    /// Copy what must outlive the batch.
    const DataValue* data{nullptr};
};

/// The values that one service call requests from one source, of one point in time if the source
/// has such. It owns its memory together with the server: items, slots and the memory of keep_alive
/// are valid until the batch is completed or destroyed, even if client, session and server are gone
/// before. Complete it once, inline in DataSource::read or later, on any thread, one at a time.
/// Destroying it completes it with the present slots; one never filled answers Bad_NoCommunication.
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
    /// 5.11.2.2); zero requests a new one.
    [[nodiscard]] std::chrono::milliseconds max_age() const { return max_age_; }
    /// True for samples of MonitoredItems with one sampling interval, false for a Read.
    [[nodiscard]] bool is_sample() const { return is_sample_; }

    /// Holds `memory` as long as anything in the slots may be used: String::borrow,
    /// ByteString::borrow and ReadSlot::shared may point into it. For a batch that is completed
    /// inline that is until the answer is encoded, right after DataSource::read; if the answer
    /// waits for another source, the server copies first. Without this call, such a batch may also
    /// point at memory that only the server's thread changes or frees. Any thread may release it.
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
/// that. A later item wins over an earlier one with the same handle. Otherwise like ReadBatch: a
/// result that was never set answers Bad_NoCommunication.
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
    /// See CallBatch::is_abandoned.
    [[nodiscard]] bool is_abandoned() const;

    void complete();
    /// Completes with `status` for each item; Good is allowed. `reason` is CallResult::reason.
    void finish(StatusCode status, std::string reason = {});

private:
    detail::WritePart* part_;
    std::span<const WriteItem> items_;
    StatusCode* results_;
};

/// Says how a variable is monitored by the items of all clients together.
struct Monitoring {
    std::uint64_t handle{0};
    /// The shortest of their revised sampling intervals; zero if each scan of a process image is
    /// sampled. Nothing: the variable is not monitored any more.
    std::optional<Duration> interval;

    friend bool operator==(const Monitoring&, const Monitoring&) = default;
};

/// The abilities of a source, and the requests that it accepts; copied when it is added.
struct DataSourceOptions {
    /// The source returns the part that ReadItem::range names.
    bool reads_ranges{false};
    /// It replaces the part that WriteItem::range names; else that is Bad_WriteNotSupported.
    bool writes_ranges{false};
    /// Arrays longer than ArrayDimensions, also in fields, are Bad_WriteNotSupported, else
    /// Bad_TypeMismatch.
    bool has_fixed_lengths{false};
    /// Bad_Shutdown, and Bad_TooManyOperations of Read and Write, become the ServiceResult.
    bool decides_services{false};
    /// A Write is applied to all its items of this source or to none, also if the server refuses
    /// one; items that it would not have refused answer Bad_NoCommunication.
    bool all_or_nothing{false};
    /// The time after which the items of a batch answer Bad_Timeout; never more than the client's
    /// own timeout. The batch stays valid; its late completion is dropped.
    std::chrono::milliseconds timeout{5000};
    /// Batches and items that it holds, late ones included; beyond: Bad_TooManyOperations.
    std::size_t max_batches{256};
    std::size_t max_items{1'000'000};
    /// The sum of all monitored_size() of items; beyond it Bad_TooManyMonitoredItems.
    std::size_t max_monitored_size{SIZE_MAX};
    /// A source of the server itself: called also while that is Suspended, Failed or counts down.
    bool is_always_in_service{false};
};

/// A backend: a controller's memory, a bus, a remote PLC. The server calls it from the server's
/// thread only and never while a call is running. It must not block: a source that needs time keeps
/// the batch and completes it later. An exception ends the call that it comes from and nothing
/// else: the items of that batch answer Bad_InternalError, and the log names the function. Batches
/// may outlive source and server.
///
/// Source and server may end in any order. A source that was added as a std::shared_ptr lives as
/// long as the server. One that was added as a reference detaches itself when it is destroyed, on
/// the server's thread and in none of its own calls: from then on it is not called, its Variables
/// answer Bad_NoCommunication, monitored items at their next sample, and its index is not used
/// again. No lock is taken for that.
///
/// Its virtual functions are inline: a library without RTTI would keep its typeinfo to itself.
class BUSBAR_API DataSource {
public:
    DataSource() = default;
    DataSource(const DataSource&) = delete;
    DataSource& operator=(const DataSource&) = delete;
    virtual ~DataSource() { detach(); }

    /// Its index for NewVariable::source in the last server it was added to; else no_source.
    [[nodiscard]] std::uint32_t index() const { return index_; }
    /// Returns the argument of AddressSpace::add_variable for a Variable that the backend calls
    /// `handle`. `like` only gives its DataType, ValueRank and ArrayDimensions. The source must
    /// have been added: if not, this binds nothing and the Variable is refused.
    [[nodiscard]] model::BoundValue variable(std::uint64_t handle, const Variant& like) const;

    [[nodiscard]] virtual DataSourceOptions options() const { return {}; }
    /// Answers every item of the batch: with its value and source timestamp, or with a bad status,
    /// such as Bad_NoCommunication for a PLC that cannot be reached. Handles may repeat.
    virtual void read(ReadBatch batch) = 0;
    /// Applies every item of the batch. A read-only source does not override this.
    virtual void write(WriteBatch batch) { batch.finish(status::Bad_NotWritable); }
    /// Carries out every Method of the batch, in any order. Not overridden without Methods.
    virtual void call(CallBatch batch) { batch.fail(status::Bad_NotImplemented); }

    /// Returns the size that a MonitoredItem of the variable, or of a part of it, counts until it
    /// is deleted, or the bad status that refuses it. Called once, when the item is created.
    [[nodiscard]] virtual Result<std::size_t> monitored_size(std::uint64_t) const { return 0; }
    /// Reports which variables are monitored, for a backend that prepares for it, for example by
    /// starting a cyclic transfer. Each change is reported once, with the shortest interval at that
    /// time: a variable begins, gets another interval, or ends; only a variable that has begun can
    /// end, and it can begin again. One call has everything that a service call changed, each
    /// handle once, in no particular order.
    ///
    /// It precedes the first read() for a new item, and otherwise comes at the end of the operation
    /// that made the change: a request, the end of a session or Subscription, or the sample that
    /// finds the Variable bound elsewhere. Everything ends when the server is destroyed. Items that
    /// are disabled or whose user may not read do not count. Must not call the server; `changes` is
    /// valid until it returns.
    virtual void monitoring_changed(std::span<const Monitoring> /*changes*/) {}

    /// For a source whose own thread must not complete batches, since that may free memory: that
    /// thread calls the waker, and the server's thread then calls handle_completions(), which
    /// completes them. attach() is called with null before the waker ends; when that call returns,
    /// the source must no longer use it.
    virtual void attach(Waker* /*waker*/) {}
    virtual void handle_completions() {}
    /// Not null for a source whose values are all in a process image, by the handles of its layout:
    /// monitored items are then sampled there, without a call of read().
    [[nodiscard]] virtual ProcessImage* process_image() { return nullptr; }

private:
    friend class detail::DataSources;
    friend class detail::SourceEntry;

    void detach();

    std::uint32_t index_{UINT32_MAX};
    /// The handle by which its servers find it; holds null when the source is destroyed.
    std::shared_ptr<DataSource*> self_;
};

} // namespace busbar::server
