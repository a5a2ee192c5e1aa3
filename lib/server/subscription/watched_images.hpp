#pragma once

#include <memory>
#include <vector>

#include "image_watch.hpp"
#include "server/data/data_sources.hpp"

namespace busbar::server::detail {

/// The process images of one sampling group's items, with a watch of each.
class WatchedImages {
public:
    /// The context of a sample in addition to the scan.
    struct Sample {
        DateTime server_time;
        /// It is later than it should be.
        bool is_late;
        /// Only items that were added since the last sample.
        bool is_only_new;
    };

    /// `memory` pays for the watches and must outlive this object.
    explicit WatchedImages(MemoryAccount& memory) : memory_{memory} {}

    /// Samples the item, which is the variable `handle` of the image of `source`, from now on.
    [[nodiscard]] ValueItem::Place add(ValueItem& item, ProcessImage& image,
                                       const SourceEntry& source, std::uint32_t handle);
    void remove(ValueItem::Place place) { images_[place.image].watch->remove(place.index); }
    /// Passes all items to `take` and drops the images.
    template <typename Take>
    void take_all(Take take);

    /// Returns true if the source of an image is destroyed.
    [[nodiscard]] bool has_lost_source() const;
    /// Returns true if a watch has more removed items than present ones. It does not shrink:
    /// take_all() and add() again.
    [[nodiscard]] bool is_wasteful() const;

    /// Samples the newest scan of each.
    void sample(const Sample& sample);
    /// Samples the pinned scan, for a group that follows one image.
    void sample(const ImagePin& pin, const Sample& sample);
    /// Scans were not sampled.
    void note_loss();

private:
    struct Image {
        /// The source may drop it before the server does.
        std::shared_ptr<ProcessImage> image;
        const SourceEntry* source;
        std::unique_ptr<ImageWatch> watch;
    };

    [[nodiscard]] std::size_t find_or_add(ProcessImage& image, const SourceEntry& source);
    static void sample(Image& image, const ImagePin& pin, const Sample& sample);

    MemoryAccount& memory_;
    std::vector<Image> images_;
};

template <typename Take>
void WatchedImages::take_all(Take take)
{
    for (const Image& image : images_) {
        for (std::size_t i = 0; i < image.watch->size(); ++i) {
            if (ValueItem* const item = image.watch->item(i)) {
                take(*item);
            }
        }
    }
    images_.clear();
}

} // namespace busbar::server::detail
