#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <busbar/server/data_source.hpp>
#include <busbar/server/process_image.hpp>

#include "image_segments.hpp"

namespace busbar::server::detail {

/// One Write call as the PLC task applies it: checked, and cut into runs of bytes.
///
/// Made and destroyed on the server's thread; while it waits, the task reads it and sets results,
/// and never touches the batch.
class ImageChanges {
public:
    ImageChanges(WriteBatch batch, const ImageSegments& variables);

    /// Checks all items and stores them. False, and none may be applied, if they exceed
    /// `max_changes` runs or `max_bytes`.
    [[nodiscard]] bool add_all(std::uint32_t max_changes, std::uint32_t max_bytes);
    [[nodiscard]] bool empty() const { return items_.empty(); }
    [[nodiscard]] std::size_t change_count() const { return changes_.size(); }
    [[nodiscard]] std::size_t byte_count() const { return bytes_.size(); }
    /// Bytes that it takes while it waits.
    [[nodiscard]] std::size_t memory() const
    {
        return bytes_.size() + changes_.size() * sizeof(Change) + items_.size() * sizeof(Item);
    }

    /// Called by the task: for each item calls `guard(handle)`, and if that is Good, applies the
    /// item's bytes.
    template <typename Guard>
    void apply(Guard&& guard)
    {
        for (Item& item : items_) {
            item.result = guard(item.handle);
            if (item.result.is_good()) {
                copy(item);
            }
        }
    }
    /// Called by the task: no item is applied.
    void refuse(StatusCode status)
    {
        for (Item& item : items_) {
            item.result = status;
        }
    }

    /// Lets `log` persist what the task has applied; items that it cannot persist get its status.
    void keep(ImageWriteLog& log, const ProcessImage& image);
    /// Reports the result of each item to the client.
    void complete();
    void fail(StatusCode status) { batch_.finish(status); }
    /// Drops the call, whose results are not needed any more.
    void drop() { const WriteBatch dropped = std::move(batch_); }

private:
    struct Item {
        std::uint32_t index; // in the batch
        std::uint32_t handle;
        std::uint32_t first; // in changes_
        std::uint32_t count;
        StatusCode result;
    };
    /// A run of bytes, from bytes_ to a variable.
    struct Change {
        std::uint32_t to; // offset from the variable's first byte
        std::uint32_t from;
        std::uint32_t size;
    };

    /// Has no effect if it fails.
    [[nodiscard]] StatusCode add(const WriteItem& item);
    [[nodiscard]] StatusCode add_checked(const WriteItem& item);
    [[nodiscard]] StatusCode add_whole(const ImagePlace& place, const Variant& value);
    [[nodiscard]] StatusCode add_range(const ImagePlace& place, const NumericRange& range,
                                       const Variant& value);
    template <typename T>
    [[nodiscard]] StatusCode add_elements(const ImagePlace& place, const NumericRange& range,
                                          const Variant& value);
    template <typename T>
    [[nodiscard]] StatusCode add_element(const ImagePlace& place, std::size_t element,
                                         const T& value);
    template <typename T>
    [[nodiscard]] StatusCode add_each(const ImagePlace& place, std::span<const T> values);
    /// Adds bytes to be filled in, for the place `to` bytes after the variable's first; they belong
    /// to the previous change if they follow it.
    std::byte* grow(std::size_t to, std::size_t size);
    void copy(const Item& item) const;
    [[nodiscard]] bool is_too_much() const;

    WriteBatch batch_;
    const ImageSegments* variables_;
    std::size_t max_changes_{0};
    std::size_t max_bytes_{0};
    std::size_t first_of_item_{0};
    std::vector<Item> items_;
    std::vector<Change> changes_;
    std::vector<std::byte> bytes_;
};

} // namespace busbar::server::detail
