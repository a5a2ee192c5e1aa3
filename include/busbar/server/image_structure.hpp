#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::server {

/// A structure of variables of a process image: its members one after another, as a C compiler lays
/// out a struct of the same members.
///
/// Each number is at a multiple of its size, a Guid and a text at a multiple of 4, a structure at a
/// multiple of what its members need; after the last member there is padding to a multiple of that.
/// A Boolean is a byte of 0 or 1, an enumeration an Int32, a DateTime an Int64 of 100 ns since
/// 1601. A text is a UInt32, its length or 2^32-1 if it is null, followed by as many bytes as its
/// capacity. Elements of arrays follow one another. So a task may keep a pointer to a struct of its
/// own.
///
/// On the wire it is the body of an ExtensionObject (Part 6, 5.2.6): the members in their order,
/// without optional ones. Never changed; any thread may read it.
class BUSBAR_API ImageStructure {
    struct Key {};

public:
    static constexpr std::size_t max_members = 10'000;
    /// Maximum nesting of structures.
    static constexpr std::size_t max_depth = 64;

    /// `encoding_id` is the DataType's "Default Binary"; null for a structure that is only used
    /// within others. Errors are those of ImageLayout::add, and Bad_OutOfRange also for no members
    /// and for more members or levels than the constants allow.
    [[nodiscard]] static Result<std::shared_ptr<const ImageStructure>>
    create(NodeId encoding_id, std::span<const ImageVariable> members);
    explicit ImageStructure(Key) {}

    [[nodiscard]] const NodeId& encoding_id() const { return encoding_id_; }
    /// The members in the order of `create`; their offsets are from the structure's first byte.
    [[nodiscard]] std::span<const ImagePlace> members() const { return members_; }
    /// Bytes of one value in the image.
    [[nodiscard]] std::uint32_t size() const { return size_; }
    [[nodiscard]] std::uint32_t alignment() const { return alignment_; }
    /// Maximum number of bytes of one value on the wire.
    [[nodiscard]] std::uint64_t max_wire_size() const { return max_wire_size_; }
    [[nodiscard]] bool has_texts() const { return has_texts_; }

private:
    [[nodiscard]] StatusCode add(const ImageVariable& member);

    NodeId encoding_id_;
    std::vector<ImagePlace> members_;
    std::uint32_t size_{0};
    std::uint32_t alignment_{1};
    std::uint64_t max_wire_size_{0};
    std::size_t depth_{1};
    bool has_texts_{false};
};

} // namespace busbar::server
