#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include <busbar/core/api.hpp>
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
class ImageWrites;
class StructureValues;
} // namespace detail

struct ImageOptions {
    /// Scans that ImagePins may hold at the same time. The image has as many buffers as this and
    /// the next number together, and two more, so that the task always finds one to publish into.
    std::uint32_t max_pins{8};
    /// Scans that wait for the server while items are sampled at each of them; one more buffer for
    /// each of them, and one besides.
    std::uint32_t max_queued_scans{4};
    /// Write calls that may wait for the scan's edge, of all clients together, and the bytes that
    /// they may take: as many as arrive during a slow scan. More answer Bad_TooManyOperations.
    std::uint32_t max_waiting_writes{1'024};
    std::size_t max_waiting_bytes{64U << 20U};
    /// What the task applies at one scan's edge: single variables, array rows or texts, and their
    /// bytes. One call with more answers Bad_TooManyOperations; if several calls together have
    /// more, they are applied at several edges, each call at one.
    std::uint32_t max_changes_per_scan{32'768};
    std::uint32_t max_bytes_per_scan{1U << 20U};
    /// How often variables may be added while the task runs.
    std::uint32_t max_additions{64};

    friend bool operator==(const ImageOptions&, const ImageOptions&) = default;
};

/// Variables that were added to an image.
struct ImageAddition {
    /// Theirs are this and the next ones.
    std::uint32_t first_handle{0};
    /// What the task works in; its handles are those of the layout, from 0. It lives as long as the
    /// image.
    ImageMemory* memory{nullptr};
};

class ProcessImage;

/// Bytes that a client wrote into a variable, as they lie in the image: from `offset` of the
/// variable's first byte on.
struct ImageWrite {
    std::uint32_t handle{0};
    std::uint32_t offset{0};
    std::span<const std::byte> bytes;
};

/// Keeps what clients write, before they learn that it was written: see ImageSource::keep_writes.
/// Called on the server's thread.
class BUSBAR_API ImageWriteLog {
public:
    ImageWriteLog() = default;
    ImageWriteLog(const ImageWriteLog&) = delete;
    ImageWriteLog& operator=(const ImageWriteLog&) = delete;
    virtual ~ImageWriteLog() = default;

    /// Whether writes of the variable are kept.
    [[nodiscard]] virtual bool keeps(const ProcessImage& image, std::uint32_t handle) const = 0;
    /// What the task has applied of one Write call, and published, in this order; of such variables
    /// only, and never nothing. Other than Good is what the client is told of these items, although
    /// the image has them.
    [[nodiscard]] virtual StatusCode keep(const ProcessImage& image,
                                          std::span<const ImageWrite> writes) = 0;
};

/// Holds one published scan: everything read through it is from one point in time and does not
/// change. Empty if there is none. Used by one thread at a time; keeps the image's memory alive.
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
    /// The time of the scan, as the task gave it.
    [[nodiscard]] DateTime time() const;
    /// The number of the scan, counted from 1.
    [[nodiscard]] std::uint64_t scan() const;
    /// Puts a variable's value into the slot, with the scan's time. True if the slot points into
    /// the scan or the pin, so that the pin has to be kept as long as the slot is used. `handle`
    /// must exist; Bad_WaitingForInitialData for one that was added after the scan. The pin keeps
    /// what structures are on the wire, of each variable once.
    bool read(std::uint32_t handle, ReadSlot& slot) const;
    /// No slot that was filled is used any more: what the pin keeps of structures may go.
    void recycle() const;
    /// A copy of a variable's value.
    [[nodiscard]] Variant value(std::uint32_t handle) const;
    /// A variable's bytes, as ImageMemory has them; null for one that was added after the scan.
    [[nodiscard]] const std::byte* bytes(std::uint32_t handle) const;

private:
    friend class ProcessImage;
    friend class ImageSource;
    /// A variable's place, and what the scan has of its layout; null if that is nothing.
    struct Found {
        const ImagePlace* place;
        const detail::ImageCopy* copy;
    };
    [[nodiscard]] Found find(std::uint32_t handle) const;
    /// Has the place of a variable fetched that is read soon, and then what lies there.
    void fetch_place(std::uint32_t handle) const;
    void fetch_value(std::uint32_t handle) const;
    ImagePin(std::shared_ptr<const ProcessImage> image, detail::ImageBuffer& buffer)
        : image_{std::move(image)}, buffer_{&buffer}
    {
    }
    void release();

    std::shared_ptr<const ProcessImage> image_;
    detail::ImageBuffer* buffer_{nullptr};
    /// Made when it is needed.
    mutable std::shared_ptr<detail::StructureValues> structures_;
};

/// The variables of a PLC task and how they get to a server and back: once per scan, as a whole.
///
/// The task works in memory() and publishes a copy of it at the end of each scan. It never waits,
/// locks, allocates or frees: whatever readers do, a scan's begin_scan() and publish() take a
/// bounded number of steps, which grows with the image's size and with ImageOptions only.
///
/// Variables may stay in memory of the runtime's own (ImageVariable::runtime): publish() gathers
/// them from there, and begin_scan() puts there what clients wrote.
///
/// Made by create() and shared by the task and by everyone who reads; whoever drops it last frees
/// it, which should not be the task.
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

    /// Of the variables that it was made with; those that were added have the next handles.
    [[nodiscard]] const ImageLayout& layout() const { return layout_; }
    [[nodiscard]] const ImageOptions& options() const { return options_; }

    // For the task's thread.

    /// Says whether a variable may be written now: Good, or the item's result.
    using WriteGuard = FunctionRef<StatusCode(std::uint32_t handle)>;

    [[nodiscard]] ImageMemory& memory() { return memory_; }
    /// The scan's edge: applies what clients wrote, all items of a Write call together.
    void begin_scan(WriteGuard guard);
    void begin_scan();
    /// Makes the memory, as it is now, what readers see, with `time` as source timestamp. Then the
    /// Write calls of this scan are answered, so that a client which reads after its Write sees it.
    void publish(DateTime time);
    /// The task stops. Readers get the last scan with Uncertain_LastUsableValue (Part 8, 7.3.2);
    /// Writes, including those that wait, answer Bad_NoCommunication. The next publish() ends this
    /// state.
    void halt();

    // From a thread of the user's that is not the task's, one at a time.

    /// Puts the initial values of variables into the memory they will have. What stays in a
    /// runtime's memory is best left to the runtime, which may be using it.
    using FillMemory = FunctionRef<StatusCode(ImageMemory& memory)>;

    /// Adds variables while the task runs (seed 000, 6-2-2: online edit). They are made and filled
    /// here; the task takes them in at its next publish(), without waiting or allocating, and each
    /// scan has all of them or none. References into other variables stay valid, and what was added
    /// is never taken away. Until then Reads answer Bad_WaitingForInitialData.
    ///
    /// Bad_TooManyOperations after max_additions, Bad_OutOfMemory if the image would be larger than
    /// an ImageLayout may be, Bad_OutOfRange for a variable of more bytes than max_bytes_per_scan,
    /// and what `fill` gives; nothing was added then.
    [[nodiscard]] Result<ImageAddition> add_variables(ImageLayout layout, FillMemory fill);

    // From any thread.

    /// How many variables there are; their handles are smaller.
    [[nodiscard]] std::uint32_t size() const;
    /// Where a variable lies; `handle` must exist. Lives as long as the image.
    [[nodiscard]] const ImagePlace& place(std::uint32_t handle) const;
    /// True from the first publish() until halt().
    [[nodiscard]] bool is_running() const { return running_.load(std::memory_order_acquire); }
    /// The latest scan; empty if there is none yet, or if as many pins are held as are allowed.
    /// Takes a constant number of steps.
    [[nodiscard]] ImagePin pin() const;
    /// True from the first publish() on.
    [[nodiscard]] bool has_scan() const;

    // For the server's thread.

    /// Sets whether each scan is kept until next_scan() takes it, and the server woken for it. A
    /// scan that finds max_queued_scans waiting is not kept.
    void follow_scans(bool follows);
    /// The oldest scan that was kept; empty if there is none. Destroy it before the next call.
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
/// together at a scan's edge; an array must have all its elements, and what is read-only answers
/// Bad_NotWritable. Without any scan reads and writes answer Bad_NoCommunication, with too many
/// pins or waiting writes Bad_TooManyOperations.
///
/// Lives on the server's thread. An image must not have two sources at the same time.
class BUSBAR_API ImageSource final : public DataSource {
public:
    explicit ImageSource(std::shared_ptr<ProcessImage> image);
    ~ImageSource() override;

    /// Every Write from here on is answered after `log` has kept it; null: none is. It must outlive
    /// the source.
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
