#pragma once

#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/server/image_layout.hpp>
#include <busbar/server/structure_view.hpp>

namespace busbar::server {

namespace detail {
class ImageGather;
} // namespace detail

/// The memory that a PLC task works in, laid out flat by an ImageLayout; variables that stay in a
/// runtime's memory are used there. The layout must outlive it.
///
/// References and spans stay valid as long as the object, so that a task can keep them from scan to
/// scan. Only store() and load() allocate. Belongs to one thread.
class BUSBAR_API ImageMemory {
public:
    /// All numbers are 0, all texts null, in structures too; a runtime's memory is left as it is.
    explicit ImageMemory(const ImageLayout& layout);

    [[nodiscard]] const ImageLayout& layout() const { return *layout_; }

    /// Returns a scalar, or the first element. `handle` must be a variable of this type, here and
    /// below.
    template <ImageNumber T>
    [[nodiscard]] T& value(std::uint32_t handle)
    {
        return *pointer<T>(handle);
    }
    /// Returns all elements in row-major order; one for a scalar.
    template <ImageNumber T>
    [[nodiscard]] std::span<T> values(std::uint32_t handle)
    {
        return {pointer<T>(handle), (*layout_)[handle].elements};
    }
    /// Returns a text of String, ByteString or XmlElement; nothing if it is null.
    [[nodiscard]] std::optional<std::string_view> text(std::uint32_t handle,
                                                       std::uint32_t element = 0) const;
    /// Returns false, with nothing changed, if the text is longer than the variable's capacity.
    bool set_text(std::uint32_t handle, std::optional<std::string_view> text,
                  std::uint32_t element = 0);
    /// Returns a structure, or an element of an array of structures.
    [[nodiscard]] StructureView structure(std::uint32_t handle, std::uint32_t element = 0)
    {
        const ImagePlace& place = (*layout_)[handle];
        return {*place.structure, bytes(place) + std::size_t{element} * place.stride};
    }

    /// Sets a variable to the value of a Variant of its type and dimensions; structures are
    /// ExtensionObjects of their encoding id. Bad_TypeMismatch if the Variant has others, also
    /// within a structure, Bad_OutOfRange for a text that is too long and an integer outside its
    /// range, Bad_DecodingError for a structure's body that ends too early or too late; nothing is
    /// changed then.
    [[nodiscard]] StatusCode store(std::uint32_t handle, const Variant& value);
    /// Returns a copy of a variable's value.
    [[nodiscard]] Variant load(std::uint32_t handle) const;

    /// Returns the bytes of a variable as the layout places them.
    [[nodiscard]] std::byte* bytes(const ImagePlace& place)
    {
        return place.runtime != nullptr
                   ? place.runtime
                   : (place.in_arrays ? arrays_.get() : plain_.get()) + place.offset;
    }
    [[nodiscard]] const std::byte* bytes(const ImagePlace& place) const
    {
        return place.runtime != nullptr
                   ? place.runtime
                   : (place.in_arrays ? arrays_.get() : plain_.get()) + place.offset;
    }

    /// The block of all variables that are not arrays of numbers and are in the image's own memory.
    [[nodiscard]] const std::byte* plain() const { return plain_.get(); }
    /// Copies the variables in a runtime's memory that are not arrays of numbers,
    /// ImageLayout::gathered_bytes() in all, to `to`.
    void gather(std::byte* to) const;

private:
    template <typename T>
    [[nodiscard]] T* pointer(std::uint32_t handle)
    {
        return std::launder(static_cast<T*>(static_cast<void*>(bytes((*layout_)[handle]))));
    }

    const ImageLayout* layout_;
    std::unique_ptr<std::byte[]> plain_;
    std::unique_ptr<std::byte[]> arrays_;
    std::shared_ptr<const detail::ImageGather> gather_;
};

} // namespace busbar::server
