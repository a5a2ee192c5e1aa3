#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <busbar/server/process_image.hpp>

#include "data_item.hpp"

namespace busbar::server::detail {

/// Items of one process image that are sampled together. It keeps the bytes that it saw last and
/// looks at an item only when they have changed, so that what stands still costs a comparison in
/// memory that lies in one piece.
class ImageWatch {
public:
    explicit ImageWatch(const ImageLayout& layout) : layout_{&layout} {}

    /// The item's place here. It is sampled next time, whatever its value is.
    [[nodiscard]] std::uint32_t add(DataItem& item, std::uint32_t handle);
    void remove(std::size_t place) { entries_[place].item = nullptr; }
    /// The item at `place` is sampled next time, whatever its value is.
    void sample_always(std::size_t place) { entries_[place].is_always = true; }
    [[nodiscard]] std::size_t size() const { return entries_.size(); }
    [[nodiscard]] DataItem* item(std::size_t place) const { return entries_[place].item; }

    struct Sample {
        /// Empty: no scan can be looked at, and `status` says why.
        const ImagePin& pin;
        StatusCode status;
        DateTime server_time;
        /// Only what was added since the last sample.
        bool is_only_new;
    };
    void sample(const Sample& sample);
    /// Scans were lost: what comes next tells of it (see DataItem::note_loss).
    void note_loss();

private:
    struct Entry {
        DataItem* item;
        std::uint32_t handle;
        /// Where its bytes lie in seen_, and how many.
        std::uint32_t seen;
        std::uint32_t size;
        bool is_always;
        bool is_new;
    };

    static void report(Entry& entry, const Sample& sample);
    [[nodiscard]] bool has_changed(const Entry& entry, const std::byte* now);

    const ImageLayout* layout_;
    std::vector<Entry> entries_;
    std::vector<std::byte> seen_;
    StatusCode last_status_;
};

} // namespace busbar::server::detail
