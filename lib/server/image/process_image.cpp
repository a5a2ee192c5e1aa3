#include <busbar/server/process_image.hpp>

#include <algorithm>
#include <cstring>

#include "core/fetch.hpp"
#include "image_pool.hpp"
#include "image_segments.hpp"
#include "image_types.hpp"
#include "image_writes.hpp"
#include "structure_values.hpp"

namespace busbar::server {

namespace {

constexpr std::uint32_t most_pins = 1024;

ImageOptions checked(ImageOptions options, const ImageLayout& layout)
{
    options.max_pins = std::clamp(options.max_pins, 1U, most_pins);
    options.max_queued_scans = std::clamp(options.max_queued_scans, 1U, most_pins);
    options.max_waiting_writes = std::max(options.max_waiting_writes, 1U);
    options.max_changes_per_scan = std::max(options.max_changes_per_scan, 1U);
    // Every variable can be written, even one as large as the image.
    options.max_bytes_per_scan =
        std::max(options.max_bytes_per_scan, static_cast<std::uint32_t>(layout.bytes()));
    return options;
}

template <typename T>
Variant borrowed_texts(const ImagePlace& place, const std::byte* from)
{
    if (!place.is_array()) {
        return Variant{detail::borrow_text<T>(from, place.capacity)};
    }
    Array<T> texts;
    texts.reserve(place.elements);
    for (std::uint32_t i = 0; i < place.elements; ++i) {
        texts.push_back(
            detail::borrow_text<T>(from + std::size_t{i} * place.stride, place.capacity));
    }
    return Variant::matrix(std::move(texts), Array<std::uint32_t>{place.dimensions});
}

Variant scalar(const ImagePlace& place, const std::byte* from)
{
    return detail::visit_image_type(
        place.type,
        [&](auto tag) {
            using T = typename decltype(tag)::type;
            if constexpr (detail::is_image_text<T>) {
                return borrowed_texts<T>(place, from);
            } else {
                T value{};
                std::memcpy(&value, from, sizeof value);
                return Variant{value};
            }
        },
        [] { return Variant{}; });
}

} // namespace

DateTime ImagePin::time() const
{
    return buffer_->time();
}

std::uint64_t ImagePin::scan() const
{
    return buffer_->scan();
}

ImagePin::Found ImagePin::find(std::uint32_t handle) const
{
    if (handle < image_->layout_.size()) {
        return {&image_->layout_[handle], &buffer_->copy(), &image_->pool_->times(), handle};
    }
    const std::uint32_t index = image_->segments_->segment_of(handle);
    const detail::ImageSegment& segment = (*image_->segments_)[index];
    const std::uint32_t local = handle - segment.first;
    return {&segment.layout[local],
            index < buffer_->segments() ? &segment.copies[buffer_->index()] : nullptr,
            &segment.times, local};
}

void ImagePin::fetch_place(std::uint32_t handle) const
{
    const Found found = find(handle);
    busbar::detail::fetch_object(*found.place);
    found.times->fetch(found.index);
}

void ImagePin::fetch_value(std::uint32_t handle) const
{
    const Found found = find(handle);
    if (found.copy != nullptr && found.place->in_arrays) {
        busbar::detail::fetch(&found.copy->array(*found.place));
    } else if (found.copy != nullptr) {
        busbar::detail::fetch(found.copy->plain(*found.place));
    }
}

bool ImagePin::read(std::uint32_t handle, ReadSlot& slot) const
{
    const auto [found, copy, times, index] = find(handle);
    if (copy == nullptr) {
        slot = status::Bad_WaitingForInitialData;
        slot.shared = nullptr;
        return false;
    }
    const ImagePlace& place = *found;
    slot.status = status::Good;
    slot.source_timestamp = times->last_change(index, buffer_->time());
    if (place.in_arrays) {
        slot.shared = &copy->array(place);
        return true;
    }
    if (place.is_structure()) {
        if (structures_ == nullptr) {
            structures_ = std::make_shared<detail::StructureValues>();
        }
        slot.shared = &structures_->value(handle, place, copy->plain(place));
        slot.status = slot.shared->is_null() ? status::Bad_EncodingError : status::Good;
        return true;
    }
    slot.shared = nullptr;
    slot.value = scalar(place, copy->plain(place));
    return place.is_text();
}

Variant ImagePin::value(std::uint32_t handle) const
{
    ReadSlot slot;
    read(handle, slot);
    const Variant& value = slot.shared != nullptr ? *slot.shared : slot.value;
    return Variant{value};
}

const std::byte* ImagePin::bytes(std::uint32_t handle) const
{
    const Found found = find(handle);
    return found.copy != nullptr ? found.copy->bytes(*found.place) : nullptr;
}

void ImagePin::recycle() const
{
    if (structures_ != nullptr) {
        structures_->recycle();
    }
}

void ImagePin::release()
{
    structures_.reset();
    if (buffer_ != nullptr) {
        image_->pool_->unpin(*std::exchange(buffer_, nullptr));
    }
    image_.reset();
}

std::shared_ptr<ProcessImage> ProcessImage::create(ImageLayout layout, ImageOptions options)
{
    return std::make_shared<ProcessImage>(Key{}, std::move(layout), options);
}

ProcessImage::ProcessImage(Key, ImageLayout layout, ImageOptions options)
    : layout_{std::move(layout)}, options_{checked(options, layout_)}, memory_{layout_},
      segments_{std::make_unique<detail::ImageSegments>(layout_, memory_, options_.max_additions)},
      pool_{std::make_unique<detail::ImagePool>(layout_, options_.max_pins,
                                                options_.max_queued_scans)},
      writes_{std::make_unique<detail::ImageWrites>(options_.max_waiting_writes,
                                                    options_.max_waiting_bytes)}
{
}

ProcessImage::~ProcessImage() = default;

void ProcessImage::begin_scan()
{
    begin_scan([](std::uint32_t) { return StatusCode{}; });
}

void ProcessImage::begin_scan(WriteGuard guard)
{
    // A call that came while the task was halting was not seen by halt() and has timed out;
    // applying it now would be a surprise.
    const bool is_first = !running_.load(std::memory_order_relaxed);
    std::size_t changes = 0;
    std::size_t bytes = 0;
    while (detail::ImageChanges* const call = writes_->next()) {
        changes += call->change_count();
        bytes += call->byte_count();
        if (is_first) {
            call->refuse(status::Bad_NoCommunication);
        } else if (changes > options_.max_changes_per_scan || bytes > options_.max_bytes_per_scan) {
            break; // left for the next edge; a single call is never too much
        } else {
            call->apply(guard);
        }
        writes_->begin();
    }
}

void ProcessImage::publish(DateTime time)
{
    const bool is_queued = pool_->publish(memory_, *segments_, time);
    running_.store(true, std::memory_order_release);
    if (writes_->finish() || is_queued) {
        waker_.wake();
    }
}

void ProcessImage::halt()
{
    running_.store(false, std::memory_order_release);
    while (detail::ImageChanges* const call = writes_->next()) {
        call->refuse(status::Bad_NoCommunication);
        writes_->begin();
    }
    writes_->finish();
    waker_.wake(); // followers of the scans must learn that there are none any more
}

ImagePin ProcessImage::pin() const
{
    detail::ImageBuffer* const buffer = pool_->pin();
    return buffer != nullptr ? ImagePin{shared_from_this(), *buffer} : ImagePin{};
}

Result<ImageAddition> ProcessImage::add_variables(ImageLayout layout, FillMemory fill)
{
    if (segments_->is_full()) {
        return busbar::fail(status::Bad_TooManyOperations);
    }
    if (layout.bytes() >
            ImageLayout::max_bytes - std::min(ImageLayout::max_bytes, segments_->bytes()) ||
        layout.size() > ImageLayout::max_variables - size()) {
        return busbar::fail(status::Bad_OutOfMemory);
    }
    for (const ImagePlace& one : layout.places()) {
        if (one.bytes() > options_.max_bytes_per_scan) {
            return busbar::fail(status::Bad_OutOfRange);
        }
    }
    auto segment = std::make_unique<detail::ImageSegment>(std::move(layout), size());
    if (const StatusCode filled = fill(segment->memory); !filled.is_good()) {
        return busbar::fail(filled);
    }
    segment->copies.reserve(pool_->size());
    while (segment->copies.size() < pool_->size()) {
        segment->copies.emplace_back(segment->layout);
    }
    const ImageAddition addition{segment->first, &segment->memory};
    segments_->add(std::move(segment));
    return addition;
}

std::uint32_t ProcessImage::size() const
{
    return segments_->size();
}

const ImagePlace& ProcessImage::place(std::uint32_t handle) const
{
    return *segments_->find(handle);
}

bool ProcessImage::has_scan() const
{
    return !pool_->is_empty();
}

void ProcessImage::follow_scans(bool follows)
{
    pool_->follow(follows);
}

ImagePin ProcessImage::next_scan()
{
    detail::ImageBuffer* const buffer = pool_->next_queued();
    return buffer != nullptr ? ImagePin{shared_from_this(), *buffer} : ImagePin{};
}

} // namespace busbar::server
