#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <span>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/server/image_structure.hpp>

namespace busbar::server {

/// A view of a structure in a task's memory, for access to single members. Never allocates.
///
/// Two pointers, to be copied as such; valid, with the references that it returns, as long as its
/// ImageMemory. Members are named by their index in ImageStructure::members(), and must be of the
/// requested type.
class BUSBAR_API StructureView {
public:
    StructureView(const ImageStructure& structure, std::byte* bytes)
        : structure_{&structure}, bytes_{bytes}
    {
    }

    [[nodiscard]] const ImageStructure& structure() const { return *structure_; }
    /// All its bytes, as ImageStructure describes.
    [[nodiscard]] std::span<std::byte> bytes() const { return {bytes_, structure_->size()}; }

    /// Returns a scalar, or the first element.
    template <ImageNumber T>
    [[nodiscard]] T& value(std::size_t member) const
    {
        return *pointer<T>(member);
    }
    /// Returns all elements in row-major order; one for a scalar.
    template <ImageNumber T>
    [[nodiscard]] std::span<T> values(std::size_t member) const
    {
        return {pointer<T>(member), structure_->members()[member].elements};
    }
    /// Returns a text; nothing if it is null.
    [[nodiscard]] std::optional<std::string_view> text(std::size_t member,
                                                       std::uint32_t element = 0) const;
    /// Returns false, with nothing changed, if the text is longer than the member's capacity.
    bool set_text(std::size_t member, std::optional<std::string_view> text,
                  std::uint32_t element = 0) const;
    /// Returns a structure within this one.
    [[nodiscard]] StructureView inner(std::size_t member, std::uint32_t element = 0) const
    {
        return {*structure_->members()[member].structure, address(member, element)};
    }

private:
    [[nodiscard]] std::byte* address(std::size_t member, std::uint32_t element) const
    {
        const ImagePlace& place = structure_->members()[member];
        return bytes_ + place.offset + std::size_t{element} * place.stride;
    }
    template <typename T>
    [[nodiscard]] T* pointer(std::size_t member) const
    {
        return std::launder(static_cast<T*>(static_cast<void*>(address(member, 0))));
    }

    const ImageStructure* structure_;
    std::byte* bytes_;
};

} // namespace busbar::server
