#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <busbar/backend/label.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/built_in_type.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/variant.hpp>

/// The types of labels that can hold a node's value, and the conversion (manual of model mode,
/// 8.2).
namespace busbar::controller {

/// The type of one value of a node: a scalar, an element of an array or a field. Subtypes of
/// built-in types count as these.
struct LeafType {
    BuiltInType built_in{BuiltInType::Null};
    /// An Int32 that is an enumeration, which has a table of its own in the manual.
    bool is_enumeration{false};

    friend bool operator==(const LeafType&, const LeafType&) = default;
};

/// A cell of the tables "Data types of labels": a dash, a circle and a circle with a dot.
enum class Assignability : std::uint8_t { No, Checked, Same };

/// Looks a leaf and a label up in these tables.
[[nodiscard]] BUSBAR_API Assignability assignability(LeafType leaf, backend::LabelType type,
                                                     backend::TimerPart part);
/// Returns whether a Method's Handle can be mapped to such a label ("Method assignment").
[[nodiscard]] constexpr bool is_handle_label(backend::LabelType type)
{
    return type == backend::LabelType::UnsignedWord;
}

/// Whether a label can be the quality of a Variable or the Done of a Method, which is 0 or not.
[[nodiscard]] BUSBAR_API bool is_quality_label(backend::LabelType type);
/// Whether values can be scaled (Scaling): numbers, but for enumerations, and labels with numbers.
[[nodiscard]] BUSBAR_API bool is_scalable(LeafType leaf);
[[nodiscard]] BUSBAR_API bool is_scalable(backend::LabelType type, backend::TimerPart part);

/// Facts about the PLC that values depend on.
struct ConversionOptions {
    /// Minutes that the PLC's clock is ahead of UTC, for DateTime: a label holds it as seconds
    /// since 2000-01-01 00:00:00 by that clock. 0: its clock shows UTC.
    std::int32_t utc_offset_minutes{0};
};

/// Converts the values of one leaf to and from one label. Created once for each mapping; converting
/// looks nothing up, and allocates for texts only. A plain value; any thread may use it.
class BUSBAR_API LabelConversion {
public:
    /// Returns nothing where assignability() returns No.
    [[nodiscard]] static std::optional<LabelConversion>
    of(LeafType leaf, const backend::LabelKind& label, const ConversionOptions& options = {});

    /// Returns a conversion whose value is `offset + factor * label`. Nothing unless is_scalable()
    /// is true for both.
    [[nodiscard]] static std::optional<LabelConversion>
    scaled(LeafType leaf, const backend::LabelKind& label, double factor, double offset);

    /// The size of the label in bytes, see backend::size_of().
    [[nodiscard]] std::size_t label_size() const { return label_size_; }
    [[nodiscard]] LeafType leaf() const { return leaf_; }

    /// Converts a label's bytes, label_size() of them, to a value: an object of the leaf's C++
    /// type, see built_in_type_of. Good, or Bad_OutOfRange if the type cannot hold the value, which
    /// is then unchanged.
    ///
    /// A text ends at its first zero. Bytes that are not Shift-JIS, and half a surrogate pair,
    /// become U+FFFD: a client sees the rest of the text, and that something is wrong with it.
    StatusCode read(const std::byte* label, void* value) const
    {
        return functions_.read(*this, label, value);
    }
    /// Converts a value to a label's bytes. Good, or Bad_OutOfRange if the label cannot hold the
    /// value; its bytes are then undefined. Bad_OutOfRange also for a text that is not UTF-8.
    ///
    /// A text that is too long is cut between two characters; the rest of the label is zero.
    StatusCode write(const void* value, std::byte* label) const
    {
        return functions_.write(*this, value, label);
    }

    /// Like the above, with a Variant. Bad_InternalError if `label` has another size.
    [[nodiscard]] Result<Variant> read(std::span<const std::byte> label) const;
    /// Also Bad_TypeMismatch for a Variant that is not a scalar of the leaf's type.
    [[nodiscard]] StatusCode write(const Variant& value, std::span<std::byte> label) const;

    // For the functions that convert.

    [[nodiscard]] std::size_t characters() const { return characters_; }
    [[nodiscard]] std::int64_t offset_seconds() const { return offset_seconds_; }
    [[nodiscard]] double factor() const { return factor_; }
    [[nodiscard]] double offset() const { return offset_; }

    using Read = StatusCode (*)(const LabelConversion&, const std::byte* label, void* value);
    using Write = StatusCode (*)(const LabelConversion&, const void* value, std::byte* label);
    /// The two directions: from a label, and to it.
    struct Functions {
        Read read;
        Write write;
    };

private:
    LabelConversion(LeafType leaf, Functions functions, const backend::LabelKind& label,
                    const ConversionOptions& options);

    Functions functions_;
    LeafType leaf_;
    std::uint32_t label_size_;
    /// For a text, the number of characters that are used ("valid number of characters").
    std::uint32_t characters_;
    std::int64_t offset_seconds_;
    double factor_{1};
    double offset_{0};
};

} // namespace busbar::controller
