#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/detail/hand_over.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/image_memory.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::server {

namespace detail {
class ImageBuffer;
class ImageCopy;
class ImagePool;
class ImageSegments;
class ImageTimes;
class ImageWrites;
class StructureValues;
} // namespace detail

struct ImageOptions {
    /// Scans that ImagePins may hold at the same time. The image has as many buffers as this and
    /// the next number together, and two more, so that the task always finds one to publish into.
    std::uint32_t max_pins{8};
    /// Scans that wait for the server while items are sampled at each of them; one more buffer for
    /// each of them, and one extra.
    std::uint32_t max_queued_scans{4};
    /// Write calls that may wait for the scan's edge, of all clients together, and their bytes: as
    /// many as arrive during a slow scan. More answer Bad_TooManyOperations.
    std::uint32_t max_waiting_writes{1'024};
    std::size_t max_waiting_bytes{64U << 20U};
    /// The changes that the task applies at one scan's edge: single variables, array rows or texts,
    /// and their bytes. One call with more answers Bad_TooManyOperations; several calls that exceed
    /// it together are applied at several edges, each call at one.
    std::uint32_t max_changes_per_scan{32'768};
    std::uint32_t max_bytes_per_scan{1U << 20U};
    /// The number of times that variables may be added while the task runs.
    std::uint32_t max_additions{64};
    /// The time from scan to scan; zero if unknown. Items whose revised sampling interval is not
    /// longer are sampled at each scan, as those with an interval of 0 are: a timer of the same
    /// interval would miss scans and take others twice.
    Duration cycle{0};

    friend bool operator==(const ImageOptions&, const ImageOptions&) = default;
};

/// Variables that were added to an image.
struct ImageAddition {
    /// Handle of the first added variable; the rest follow consecutively.
    std::uint32_t first_handle{0};
    /// The memory that the task works in; its handles are those of the layout, from 0. It lives as
    /// long as the image.
    ImageMemory* memory{nullptr};
};

class ProcessImage;

/// Bytes that a client wrote into a variable, in the form of the image: from `offset` of the
/// variable's first byte on.
struct ImageWrite {
    std::uint32_t handle{0};
    std::uint32_t offset{0};
    std::span<const std::byte> bytes;
};

/// Persists clients' writes before they are acknowledged: see ImageSource::keep_writes. Called on
/// the server's thread.
class BUSBAR_API ImageWriteLog {
public:
    ImageWriteLog() = default;
    ImageWriteLog(const ImageWriteLog&) = delete;
    ImageWriteLog& operator=(const ImageWriteLog&) = delete;
    virtual ~ImageWriteLog() = default;

    /// Returns whether writes of the variable are persisted.
    [[nodiscard]] virtual bool keeps(const ProcessImage& image, std::uint32_t handle) const = 0;
    /// Persists the writes of one Write call that the task has applied and published, in this
    /// order; only of such variables, and at least one. A status other than Good becomes the result
    /// of these items, although the image has the values.
    [[nodiscard]] virtual StatusCode keep(const ProcessImage& image,
                                          std::span<const ImageWrite> writes) = 0;
};

/// Holds one published scan: everything read through it is from one point in time and does not
/// change. May be empty. Used by one thread at a time; keeps the image's memory alive.
class BUSBAR_API ImagePin {
public:
    ImagePin() = default;
    ImagePin(ImagePin&& other) noexcept
        : image_{std::move(other.image_)}, buffer_{std::exchange(other.buffer_, nullptr)},
          structures_{std::move(other.structures_)}
    {
    }
    ImagePin& operator=(ImagePin&& other) noexcept
    {
        release();
        image_ = std::move(other.image_);
        buffer_ = std::exchange(other.buffer_, nullptr);
        structures_ = std::move(other.structures_);
        return *this;
    }
    ~ImagePin() { release(); }

    [[nodiscard]] explicit operator bool() const { return buffer_ != nullptr; }
    /// The time of the scan, as the task set it.
    [[nodiscard]] DateTime time() const;
    /// The number of the scan, counted from 1.
    [[nodiscard]] std::uint64_t scan() const;
    /// Stores a variable's value in the slot, with the time of its last change. True if the slot
    /// points into the scan or the pin, so that the pin must be kept as long as the slot is used.
    /// `handle` must exist; Bad_WaitingForInitialData for one that was added after the scan. The
    /// pin keeps the encoding of structures, once for each variable.
    bool read(std::uint32_t handle, ReadSlot& slot) const;
    /// Call it when no filled slot is used any more, to free the encodings of structures in the
    /// pin.
    void recycle() const;
    /// Returns a copy of a variable's value.
    [[nodiscard]] Variant value(std::uint32_t handle) const;
    /// Returns a variable's bytes, as in ImageMemory; null for one that was added after the scan.
    [[nodiscard]] const std::byte* bytes(std::uint32_t handle) const;

private:
    friend class ProcessImage;
    friend class ImageSource;
    /// A variable's place, and the part of the scan with its layout; null if the scan does not have
    /// it.
    struct Found {
        const ImagePlace* place;
        const detail::ImageCopy* copy;
        /// The times of the layout, and the variable's index in it.
        const detail::ImageTimes* times;
        std::uint32_t index;
    };
    [[nodiscard]] Found find(std::uint32_t handle) const;
    /// Prefetches the place of a variable that is read soon, and then its value.
    void fetch_place(std::uint32_t handle) const;
    void fetch_value(std::uint32_t handle) const;
    ImagePin(std::shared_ptr<const ProcessImage> image, detail::ImageBuffer& buffer)
        : image_{std::move(image)}, buffer_{&buffer}
    {
    }
    void release();

    std::shared_ptr<const ProcessImage> image_;
    detail::ImageBuffer* buffer_{nullptr};
    /// Created on first use.
    mutable std::shared_ptr<detail::StructureValues> structures_;
};

/// The variables of a PLC task and their way to a server and back: once per scan, as a whole.
///
/// The task works in memory() and publishes a copy of it at the end of each scan. It never waits,
/// locks, allocates or frees: whatever readers do, a scan's begin_scan() and publish() take a
/// bounded number of steps, which grows with the image's size and with ImageOptions only.
///
/// Variables may stay in the runtime's own memory (ImageVariable::runtime): publish() gathers them
/// from there, and begin_scan() stores there what clients wrote.
///
/// Created by create() and shared by the task and all readers; the last owner frees it, which
/// should not be the task.
class BUSBAR_API ProcessImage : public std::enable_shared_from_this<ProcessImage> {
    struct Key {};

public:
    /// `layout` is copied.
    [[nodiscard]] static std::shared_ptr<ProcessImage> create(ImageLayout layout,
                                                              ImageOptions options = {});
    ProcessImage(Key, ImageLayout layout, ImageOptions options);
    ProcessImage(const ProcessImage&) = delete;
    ProcessImage& operator=(const ProcessImage&) = delete;
    ~ProcessImage();

    /// The layout of the initial variables; added ones have the next handles.
    [[nodiscard]] const ImageLayout& layout() const { return layout_; }
    [[nodiscard]] const ImageOptions& options() const { return options_; }

    // Called on the task's thread.

    /// Returns whether a variable may be written now: Good, or the item's result.
    using WriteGuard = FunctionRef<StatusCode(std::uint32_t handle)>;

    [[nodiscard]] ImageMemory& memory() { return memory_; }
    /// The scan's edge: applies clients' writes, all items of a Write call together.
    void begin_scan(WriteGuard guard);
    void begin_scan();
    /// Publishes the present memory to readers, with `time` as the source timestamp of every
    /// variable whose bytes differ from those of the previous scan; the others keep theirs (Part 4,
    /// 7.11.3). Then the Write calls of this scan are answered, so that a client which reads after
    /// its Write sees it.
    void publish(DateTime time);
    /// The task stops. Readers get the last scan with Uncertain_LastUsableValue (Part 8, 7.3.2);
    /// Writes, including those that wait, answer Bad_NoCommunication. The next publish() ends this
    /// state.
    void halt();

    // Called on a thread of the user other than the task's, one at a time.

    /// Stores the initial values of variables in their future memory. Variables in a runtime's
    /// memory are best left to the runtime, which may be using it.
    using FillMemory = FunctionRef<StatusCode(ImageMemory& memory)>;

    /// Adds variables while the task runs (W588, 6-2-2: online edit). They are
    /// created and filled here; the task adopts them at its next publish(), without waiting or
    /// allocating, and each scan has all of them or none. References to other variables stay valid,
    /// and added ones are never removed. Until then Reads answer Bad_WaitingForInitialData.
    ///
    /// Bad_TooManyOperations after max_additions, Bad_OutOfMemory if the image would be larger than
    /// an ImageLayout may be, Bad_OutOfRange for a variable of more bytes than max_bytes_per_scan,
    /// and the status of `fill`; nothing was added then.
    [[nodiscard]] Result<ImageAddition> add_variables(ImageLayout layout, FillMemory fill);

    // Called from any thread.

    /// The number of variables, and upper bound of their handles.
    [[nodiscard]] std::uint32_t size() const;
    /// Returns the place of a variable; `handle` must exist. Lives as long as the image.
    [[nodiscard]] const ImagePlace& place(std::uint32_t handle) const;
    /// True from the first publish() until halt().
    [[nodiscard]] bool is_running() const { return running_.load(std::memory_order_acquire); }
    /// Returns the latest scan; empty if there is none yet, or if the maximum number of pins is
    /// held. Takes a constant number of steps.
    [[nodiscard]] ImagePin pin() const;
    /// True from the first publish() on.
    [[nodiscard]] bool has_scan() const;

    // Called on the server's thread.

    /// Sets whether each scan is kept until next_scan() takes it, and the server woken for it. A
    /// scan is not kept while max_queued_scans are waiting.
    void follow_scans(bool follows);
    /// Returns the oldest scan that was kept; empty if there is none. Destroy it before the next
    /// call.
    [[nodiscard]] ImagePin next_scan();

private:
    friend class ImagePin;
    friend class ImageSource;

    ImageLayout layout_;
    ImageOptions options_;
    ImageMemory memory_;
    std::unique_ptr<detail::ImageSegments> segments_;
    std::unique_ptr<detail::ImagePool> pool_;
    std::unique_ptr<detail::ImageWrites> writes_;
    std::atomic<bool> running_{false};
    busbar::detail::WakerSlot waker_;
};

/// Serves a process image to a server; the handles are the layout's.
///
/// Every Read call's values come from one scan. A Write call's items are checked here and applied
/// together at a scan's edge; an array must have all its elements, and a read-only variable answers
/// Bad_NotWritable. Without any scan reads and writes answer Bad_NoCommunication, with too many
/// pins or waiting writes Bad_TooManyOperations.
///
/// Used on the server's thread. An image must not have two sources at the same time.
class BUSBAR_API ImageSource final : public DataSource {
public:
    explicit ImageSource(std::shared_ptr<ProcessImage> image);
    ~ImageSource() override;

    /// Answers every Write from here on only after `log` has persisted it; if null, none is
    /// persisted. It must outlive the source.
    void keep_writes(ImageWriteLog* log) { log_ = log; }

    [[nodiscard]] DataSourceOptions options() const override;
    void read(ReadBatch batch) override;
    void write(WriteBatch batch) override;
    void attach(Waker* waker) override;
    void handle_completions() override;
    [[nodiscard]] ProcessImage* process_image() override { return image_.get(); }

private:
    std::shared_ptr<ProcessImage> image_;
    ImageWriteLog* log_{nullptr};
};

} // namespace busbar::server
