#include <busbar/server/process_image.hpp>

#include <algorithm>

#include "core/fetch.hpp"
#include "image_pool.hpp"
#include "image_writes.hpp"

namespace busbar::server {

ImageSource::ImageSource(std::shared_ptr<ProcessImage> image) : image_{std::move(image)} {}

ImageSource::~ImageSource()
{
    image_->waker_.wake(); // items that follow the scans must be notified
    attach(nullptr);
    image_->writes_->drop_batches();
}

DataSourceOptions ImageSource::options() const
{
    DataSourceOptions options;
    // The server cuts ranges out of the shared value.
    options.writes_ranges = true;
    // The image limits the number of waiting writes; a Read, done at once, goes past them.
    options.max_batches = std::size_t{image_->options().max_waiting_writes} + 2;
    return options;
}

void ImageSource::read(ReadBatch batch)
{
    ImagePin pin = image_->pin();
    if (!pin) {
        const bool is_empty = image_->pool_->is_empty();
        return batch.fail(is_empty ? status::Bad_NoCommunication : status::Bad_TooManyOperations);
    }
    const auto items = batch.items();
    const auto slots = batch.results();
    // Part 8, 7.3.2: the task that updated the values has stopped.
    const StatusCode quality =
        image_->is_running() ? status::Good : status::Uncertain_LastUsableValue;
    bool is_borrowed = false;
    const std::uint32_t size = image_->size();
    // The address of a value is known when its place is in the cache, so both are prefetched, one
    // after the other.
    const auto fetch = [&](std::size_t next, void (ImagePin::*part)(std::uint32_t) const) {
        if (next < items.size() && items[next].handle < size) {
            (pin.*part)(static_cast<std::uint32_t>(items[next].handle));
        }
    };
    for (std::size_t i = 0; i < items.size(); ++i) {
        fetch(i + 2 * busbar::detail::fetched_ahead, &ImagePin::fetch_place);
        fetch(i + busbar::detail::fetched_ahead, &ImagePin::fetch_value);
        if (items[i].handle >= size) {
            slots[i].status = status::Bad_NodeIdUnknown;
            continue;
        }
        is_borrowed |= pin.read(static_cast<std::uint32_t>(items[i].handle), slots[i]);
        if (!slots[i].status.is_bad()) {
            slots[i].status = quality;
        }
    }
    if (is_borrowed) {
        batch.keep_alive(std::make_shared<const ImagePin>(std::move(pin)));
    }
    batch.complete();
}

void ImageSource::write(WriteBatch batch)
{
    handle_completions();
    const ImageOptions& options = image_->options();
    auto call = std::make_unique<detail::ImageChanges>(std::move(batch), *image_->segments_);
    if (!image_->is_running()) {
        return call->fail(status::Bad_NoCommunication);
    }
    if (image_->writes_->is_full() ||
        !call->add_all(options.max_changes_per_scan, options.max_bytes_per_scan) ||
        !image_->writes_->has_room_for(*call)) {
        return call->fail(status::Bad_TooManyOperations);
    }
    if (call->empty()) {
        return call->complete();
    }
    image_->writes_->push(std::move(call));
}

void ImageSource::attach(Waker* waker)
{
    image_->waker_.set(waker);
}

void ImageSource::handle_completions()
{
    while (const std::unique_ptr<detail::ImageChanges> call = image_->writes_->collect()) {
        if (log_ != nullptr) {
            call->keep(*log_, *image_);
        }
        call->complete();
    }
}

} // namespace busbar::server
