#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/controller/label_conversion.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/model/space_reader.hpp>

/// The structure of a Variable's or Argument's value: leaves, each of which can be mapped to a
/// label (SH-082679, 8.2).
namespace busbar::controller {

/// The limits of a value that is taken apart.
struct ShapeLimits {
    /// Elements of an array: the product of its dimensions.
    std::size_t max_elements{1'000'000};
    /// Nested structures; deeper parts keep their values.
    std::size_t max_structure_depth{20};
    /// Leaves of one value.
    std::size_t max_leaves{1'000'000};

    /// The limits of the module itself (2.1 and 8.2).
    [[nodiscard]] static constexpr ShapeLimits rd81opc96() { return {10'240, 20, 25'000}; }
};

/// The reason why no label can be assigned (8.2).
enum class ShapeError : std::uint8_t {
    UnknownType,
    OtherType,    // not below a built-in type, such as Decimal
    AbstractType, // Number, Enumeration, Structure, ... themselves
    OptionSet,    // has OptionSetValues
    Union,
    OptionalFields,
    SubtypedStructure,   // "Subtype handling": an own type below or above another
    FieldRank,           // of a field: other than -1 and 1
    EnumerationParent,   // not directly below Enumeration
    EnumerationMinusOne, // has a value of -1
    ArrayRank,           // the table of ValueRank and ArrayDimensions forbids it
    ArraySize,           // the product of the dimensions
    Depth,               // nested structures
    TooManyLeaves,
};

/// The reason why a value cannot be taken apart.
struct ShapeRefusal {
    ShapeError error;
    /// The path of the part as in leaf paths: ".Inner.Mode"; empty for the value itself.
    std::string path;
    /// A name for the person who maps; printable.
    std::string text;
};

/// The assumed rank and dimensions of an array whose declaration leaves them open ("mapping array
/// specification", 9.5: Rank, Dim1 to Dim3).
struct MappingArray {
    /// The path of the array, written like leaf paths: empty, ".Samples", "[2].Samples".
    std::string path;
    /// -1 or 1 to 3. Used with ValueRank -3, -2 and 0 only; any other value, and one that the
    /// ValueRank forbids, counts as 1.
    std::int32_t rank{1};
    /// 0, and more than the limit, count as 1.
    std::array<std::uint32_t, 3> dimensions{};
};

/// The cells in the table of ValueRank and ArrayDimensions.
enum class ArrayUse : std::uint8_t { No, Limited, Yes };
/// The way in which an array is mapped to labels.
struct ArrayForm {
    ArrayUse use{ArrayUse::No};
    /// 0 for a scalar, otherwise 1 to 3, the number of dimensions that are used.
    std::uint8_t rank{0};
    std::array<std::uint32_t, 3> dimensions{1, 1, 1};
    /// The product exceeds the limit: `use` is No.
    bool is_too_large{false};
    /// Limited and without MappingArray: takes no words (2.1, note 4).
    bool is_open{false};

    [[nodiscard]] std::size_t elements() const
    {
        return std::size_t{dimensions[0]} * dimensions[1] * dimensions[2];
    }
};
/// `chosen` may be null. An Argument is never Limited.
[[nodiscard]] BUSBAR_API ArrayForm array_form(std::int32_t value_rank,
                                              std::span<const std::uint32_t> array_dimensions,
                                              const MappingArray* chosen, bool is_argument,
                                              const ShapeLimits& limits = {});

/// The declaration of a node's value.
struct ValueDeclaration {
    NodeId data_type;
    std::int32_t value_rank{-1};
    std::span<const std::uint32_t> array_dimensions{};
    /// For a Method's InputArguments.
    bool is_argument{false};
};

namespace detail {
struct ShapeNode;
}

/// The leaves of a value, in row-major order of elements and in the fields' order. Refers to the
/// DynamicTypes that it was created from. Movable; any thread may read it.
class BUSBAR_API ValueShape {
public:
    /// Takes the values of a Variable or an Argument apart, as it is declared.
    [[nodiscard]] static Expected<ValueShape, ShapeRefusal>
    of(const model::SpaceReader& space, const binary::DynamicTypes& types,
       const ValueDeclaration& declaration, std::span<const MappingArray> arrays = {},
       const ShapeLimits& limits = {});
    ValueShape(ValueShape&&) noexcept;
    ValueShape& operator=(ValueShape&&) noexcept;
    ~ValueShape();

    [[nodiscard]] std::size_t leaf_count() const;
    /// `leaf` is below leaf_count().
    [[nodiscard]] LeafType leaf_type(std::size_t leaf) const;
    /// "" for a scalar, "[0]", "[1][2]", "[0].Member1", ".MemberA[0]". Periods, brackets and
    /// backslashes in the names of fields are preceded by a backslash.
    [[nodiscard]] std::string leaf_path(std::size_t leaf) const;
    /// Returns the leaf with that path.
    [[nodiscard]] std::optional<std::size_t> find_leaf(std::string_view path) const;
    /// Fields without leaves, and the reasons. They keep their values. For equal elements only the
    /// first one's.
    [[nodiscard]] std::span<const ShapeRefusal> kept_fields() const { return kept_; }
    /// 0 for a scalar.
    [[nodiscard]] std::size_t rank() const;
    /// rank() numbers.
    [[nodiscard]] std::span<const std::uint32_t> dimensions() const;

    /// Fills a leaf: an object of the leaf's C++ type (as for LabelConversion::read) with its
    /// previous value. Good without a change keeps it; a bad status ends assemble().
    using Fill = FunctionRef<StatusCode(std::size_t leaf, void* value)>;
    /// Returns a value of this shape, with its leaves filled in their order. Leaves that are not
    /// filled keep the value in `previous`; if that is null, or of another shape: zeros. Fails with
    /// the first bad status of `fill`, or Bad_EncodingError for structures without encoding.
    [[nodiscard]] Result<Variant> assemble(const Variant* previous, Fill fill) const;

    /// Gets a leaf as for LabelConversion::write; a bad status ends take_apart().
    using Take = FunctionRef<StatusCode(std::size_t leaf, const void* value)>;
    /// Bad_WriteNotSupported if the number of dimensions or of their elements differs from this
    /// shape's; Bad_TypeMismatch for another type; the first bad status of `take`.
    [[nodiscard]] StatusCode take_apart(const Variant& value, Take take) const;

    /// The words that count towards "Variable data size (total)" (2.1, note 4).
    [[nodiscard]] std::size_t words() const;
    /// The bytes that it counts as a monitored item (8.1, CreateMonitoredItems).
    [[nodiscard]] std::size_t monitored_bytes() const;

private:
    ValueShape(std::unique_ptr<detail::ShapeNode> root, const binary::DynamicTypes& types,
               std::vector<ShapeRefusal> kept);

    std::unique_ptr<detail::ShapeNode> root_;
    const binary::DynamicTypes* types_;
    std::vector<ShapeRefusal> kept_;
};

/// Returns the words of one value of the type, 0 for a type without labels.
[[nodiscard]] BUSBAR_API std::size_t words_of(LeafType leaf);
/// Returns the bytes of one value of the type when it is monitored.
[[nodiscard]] BUSBAR_API std::size_t monitored_bytes_of(BuiltInType type);

} // namespace busbar::controller
