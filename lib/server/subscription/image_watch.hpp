#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <busbar/server/process_image.hpp>

#include "value_item.hpp"

namespace busbar::server::detail {

/// Items of one process image that are sampled together. It keeps the last bytes of each variable,
/// once for all items of it, and samples an item only when they have changed, so that unchanged
/// variables cost a comparison in contiguous memory.
class ImageWatch {
public:
    /// Both must outlive this. `account` pays for the kept bytes. Items of a variable that it
    /// cannot pay for are sampled each time.
    ImageWatch(const ProcessImage& image, MemoryAccount& account)
        : image_{&image}, account_{&account}
    {
    }
    ImageWatch(const ImageWatch&) = delete;
    ImageWatch& operator=(const ImageWatch&) = delete;
    ~ImageWatch() { account_->release(charged_); }

    /// Adds the item and returns its place. It is sampled next time, whatever its value is. Without
    /// memory for it, nothing is counted or charged.
    [[nodiscard]] std::uint32_t add(ValueItem& item, std::uint32_t handle);
    void remove(std::size_t place);
    /// The item at `place` is sampled next time, whatever its value is.
    void sample_always(std::size_t place) { entries_[place].is_always = true; }
    [[nodiscard]] std::size_t size() const { return entries_.size(); }
    [[nodiscard]] ValueItem* item(std::size_t place) const { return entries_[place].item; }
    /// True if removed items take so much memory that the watch should be created again.
    [[nodiscard]] bool is_wasteful() const;

    struct Sample {
        /// If empty, no scan can be read, and `status` is the reason.
        const ImagePin& pin;
        StatusCode status;
        DateTime server_time;
        /// Samples only items that were added since the last sample.
        bool is_only_new;
    };
    /// Without memory for an item, the others are sampled, and this throws.
    void sample(const Sample& sample);
    /// Scans were lost: the next values report it (see ValueItem::note_loss).
    void note_loss();

private:
    struct Variable {
        std::uint32_t handle;
        std::uint32_t users;
        /// Offset of its bytes in seen_, if they are kept.
        std::size_t seen;
        std::uint32_t bytes;
        bool is_kept;
        /// No sample has read it yet.
        bool is_fresh;
        bool has_changed;
        /// The sample for which has_changed is valid.
        std::uint64_t round;
    };
    struct Entry {
        ValueItem* item;
        /// Index of its variable.
        std::uint32_t variable;
        bool is_always;
        bool is_new;
        /// There was no memory for its value.
        bool is_left_out;
    };

    [[nodiscard]] std::uint32_t variable_of(std::uint32_t handle);
    /// Adds a variable without items.
    [[nodiscard]] std::uint32_t add_variable(std::uint32_t handle);
    void report(Entry& entry, const Sample& sample);
    /// Returns true if there was memory for it.
    bool try_report(Entry& entry, const Sample& sample);
    void report_left_out(const Sample& sample);
    [[nodiscard]] bool has_changed(Variable& variable, const Sample& sample);

    const ProcessImage* image_;
    MemoryAccount* account_;
    std::size_t charged_{0};
    std::vector<Entry> entries_;
    std::size_t holes_{0};
    std::vector<Variable> variables_;
    /// By handle.
    std::unordered_map<std::uint32_t, std::uint32_t> known_;
    std::vector<std::byte> seen_;
    /// Bytes of variables without items.
    std::size_t unused_bytes_{0};
    std::uint64_t round_{0};
    StatusCode last_status_;
};

} // namespace busbar::server::detail
