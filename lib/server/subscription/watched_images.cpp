#include "watched_images.hpp"

#include <algorithm>

namespace busbar::server::detail {

std::size_t WatchedImages::find_or_add(ProcessImage& image, const SourceEntry& source)
{
    const auto found = std::find_if(images_.begin(), images_.end(), [&](const Image& known) {
        return known.image.get() == &image && known.source == &source;
    });
    if (found == images_.end()) {
        images_.push_back(
            {image.shared_from_this(), &source, std::make_unique<ImageWatch>(image, memory_)});
        return images_.size() - 1;
    }
    return static_cast<std::size_t>(found - images_.begin());
}

ValueItem::Place WatchedImages::add(ValueItem& item, ProcessImage& image, const SourceEntry& source,
                                    std::uint32_t handle)
{
    const std::size_t place = find_or_add(image, source);
    return {static_cast<std::uint32_t>(place), images_[place].watch->add(item, handle)};
}

bool WatchedImages::has_lost_source() const
{
    return std::any_of(images_.begin(), images_.end(),
                       [](const Image& image) { return !image.source->is_attached(); });
}

bool WatchedImages::is_wasteful() const
{
    return std::any_of(images_.begin(), images_.end(),
                       [](const Image& image) { return image.watch->is_wasteful(); });
}

void WatchedImages::sample(Image& image, const ImagePin& pin, const Sample& sample)
{
    if (const StatusCode obstacle = image.source->obstacle(); obstacle.is_bad()) {
        return image.watch->sample({{}, obstacle, sample.server_time, sample.is_only_new});
    }
    const StatusCode no_pin =
        image.image->has_scan() ? status::Bad_TooManyOperations : status::Bad_NoCommunication;
    const StatusCode running = sample.is_late ? status::Good_Overload : status::Good;
    // Part 8, 7.3.2: the task that updated the values has stopped.
    const StatusCode status =
        !pin ? no_pin : (image.image->is_running() ? running : status::Uncertain_LastUsableValue);
    image.watch->sample({pin, status, sample.server_time, sample.is_only_new});
}

void WatchedImages::sample(const Sample& sample)
{
    for (Image& image : images_) {
        WatchedImages::sample(image, image.image->pin(), sample);
    }
}

void WatchedImages::sample(const ImagePin& pin, const Sample& sample)
{
    for (Image& image : images_) {
        WatchedImages::sample(image, pin, sample);
    }
}

void WatchedImages::note_loss()
{
    for (Image& image : images_) {
        image.watch->note_loss();
    }
}

} // namespace busbar::server::detail
