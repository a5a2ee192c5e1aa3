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

/// What the value of a Variable or Argument comes down to: leaves, each of which can be mapped to a
/// label (seed 001, 8.2).
namespace busbar::controller {

struct ShapeLimits {
    /// Of an array: the product of its dimensions.
    std::size_t max_elements{1'000'000};
    /// Structures within one another; what lies deeper keeps its value.
    std::size_t max_structure_depth{20};
    /// Of one value.
    std::size_t max_leaves{1'000'000};

    /// The module's own (2.1 and 8.2).
    [[nodiscard]] static constexpr ShapeLimits rd81opc96() { return {10'240, 20, 25'000}; }
};

/// Why no label can be assigned (8.2).
enum class ShapeError : std::uint8_t {
    UnknownType,
    OtherType,    // below no built-in type, as Decimal
    AbstractType, // Number, Enumeration, Structure, ... themselves
    OptionSet,    // has OptionSetValues
    Union,
    OptionalFields,
    SubtypedStructure,   // "Subtype handling": an own one below or above another
    FieldRank,           // of a field: other than -1 and 1
    EnumerationParent,   // not right below Enumeration
    EnumerationMinusOne, // has a value of -1
    ArrayRank,           // the table of ValueRank and ArrayDimensions says no
    ArraySize,           // the product of the dimensions
    Depth,               // structures within one another
    TooManyLeaves,
};

struct ShapeRefusal {
    ShapeError error;
    /// What it is about, as leaf paths are: ".Inner.Mode"; empty for the value itself.
    std::string path;
    /// For the person who maps; printable.
    std::string text;
};

/// What an array is taken for if its rank or dimensions leave that open ("mapping array
/// specification", 9.5: Rank, Dim1 to Dim3).
struct MappingArray {
    /// As leaf paths are, but of the array: empty, ".Samples", "[2].Samples".
    std::string path;
    /// -1 or 1 to 3. Of use with ValueRank -3, -2 and 0 only; any other value, and one that the
    /// ValueRank forbids, counts as 1.
    std::int32_t rank{1};
    /// 0, and more than the limit, count as 1.
    std::array<std::uint32_t, 3> dimensions{};
};

/// A row and column of the table of ValueRank and ArrayDimensions.
enum class ArrayUse : std::uint8_t { No, Limited, Yes };
struct ArrayForm {
    ArrayUse use{ArrayUse::No};
    /// 0 for a scalar, else 1 to 3, as many as dimensions count.
    std::uint8_t rank{0};
    std::array<std::uint32_t, 3> dimensions{1, 1, 1};
    /// The product is past the limit: `use` is No.
    bool is_too_large{false};
    /// Limited and without MappingArray: takes no words (2.1, note 4).
    bool is_open{false};

    [[nodiscard]] std::size_t elements() const
    {
        return std::size_t{dimensions[0]} * dimensions[1] * dimensions[2];
    }
};
/// `chosen` may be null. An Argument has no Limited.
[[nodiscard]] BUSBAR_API ArrayForm array_form(std::int32_t value_rank,
                                              std::span<const std::uint32_t> array_dimensions,
                                              const MappingArray* chosen, bool is_argument,
                                              const ShapeLimits& limits = {});

/// What a node says of its value.
struct ValueDeclaration {
    NodeId data_type;
    std::int32_t value_rank{-1};
    std::span<const std::uint32_t> array_dimensions{};
    /// Of a Method's InputArguments.
    bool is_argument{false};
};

namespace detail {
struct ShapeNode;
}

/// The leaves of a value, in row-major order of elements and in the fields' order. Refers to the
/// DynamicTypes that it was made of. Movable; any thread may read it.
class BUSBAR_API ValueShape {
public:
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
    /// "" of a scalar, "[0]", "[1][2]", "[0].Member1", ".MemberA[0]". Periods, brackets and
    /// backslashes in the names of fields have a backslash before them.
    [[nodiscard]] std::string leaf_path(std::size_t leaf) const;
    /// The leaf of that path.
    [[nodiscard]] std::optional<std::size_t> find_leaf(std::string_view path) const;
    /// Fields that have no leaves, and why. They keep their values. Of elements that are alike the
    /// first one's.
    [[nodiscard]] std::span<const ShapeRefusal> kept_fields() const { return kept_; }
    /// 0 for a scalar.
    [[nodiscard]] std::size_t rank() const;
    /// As many as rank().
    [[nodiscard]] std::span<const std::uint32_t> dimensions() const;

    /// Fills a leaf: an object of the leaf's C++ type (as LabelConversion::read does) that holds
    /// what it had before. Good with nothing done leaves it so; anything bad ends assemble().
    using Fill = FunctionRef<StatusCode(std::size_t leaf, void* value)>;
    /// A value of this shape, its leaves filled in their order. `previous` is what leaves that are
    /// not filled keep; null, or of another shape: zeros. The first bad status of `fill`;
    /// Bad_EncodingError for structures without encoding.
    [[nodiscard]] Result<Variant> assemble(const Variant* previous, Fill fill) const;

    /// Is given a leaf as LabelConversion::write takes it; anything bad ends take_apart().
    using Take = FunctionRef<StatusCode(std::size_t leaf, const void* value)>;
    /// Bad_WriteNotSupported if the elements of a dimension, or the dimensions, are not as many as
    /// this shape's; Bad_TypeMismatch for another type; the first bad status of `take`.
    [[nodiscard]] StatusCode take_apart(const Variant& value, Take take) const;

    /// Words that count for "Variable data size (total)" (2.1, note 4).
    [[nodiscard]] std::size_t words() const;
    /// Bytes that count as a monitored item (8.1, CreateMonitoredItems).
    [[nodiscard]] std::size_t monitored_bytes() const;

private:
    ValueShape(std::unique_ptr<detail::ShapeNode> root, const binary::DynamicTypes& types,
               std::vector<ShapeRefusal> kept);

    std::unique_ptr<detail::ShapeNode> root_;
    const binary::DynamicTypes* types_;
    std::vector<ShapeRefusal> kept_;
};

/// Words that one value of the type counts as, 0 for one that no label can be assigned to.
[[nodiscard]] BUSBAR_API std::size_t words_of(LeafType leaf);
/// Bytes that one value of the type counts as when it is monitored.
[[nodiscard]] BUSBAR_API std::size_t monitored_bytes_of(BuiltInType type);

} // namespace busbar::controller
