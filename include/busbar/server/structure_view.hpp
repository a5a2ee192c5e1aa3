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

/// A structure in a task's memory: how the task works with single members. Never allocates.
///
/// Two pointers, to be copied as such; valid, with the references that it gives, as long as the
/// ImageMemory that it is from. Members are named by their index in ImageStructure::members(), and
/// must be of the type that is asked for.
class BUSBAR_API StructureView {
public:
    StructureView(const ImageStructure& structure, std::byte* bytes)
        : structure_{&structure}, bytes_{bytes}
    {
    }

    [[nodiscard]] const ImageStructure& structure() const { return *structure_; }
    /// All of it, as ImageStructure says.
    [[nodiscard]] std::span<std::byte> bytes() const { return {bytes_, structure_->size()}; }

    /// A scalar, or the first element.
    template <ImageNumber T>
    [[nodiscard]] T& value(std::size_t member) const
    {
        return *pointer<T>(member);
    }
    /// All elements in row-major order; one if it is a scalar.
    template <ImageNumber T>
    [[nodiscard]] std::span<T> values(std::size_t member) const
    {
        return {pointer<T>(member), structure_->members()[member].elements};
    }
    /// A text; none if it is null.
    [[nodiscard]] std::optional<std::string_view> text(std::size_t member,
                                                       std::uint32_t element = 0) const;
    /// False, with nothing changed, if the text is longer than the member's capacity.
    bool set_text(std::size_t member, std::optional<std::string_view> text,
                  std::uint32_t element = 0) const;
    /// A structure within this one.
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
