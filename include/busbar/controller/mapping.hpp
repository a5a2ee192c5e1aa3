#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>

/// Which labels of a PLC are the values of which nodes (seed 001, 9.5), as plain values: model mode
/// reads them from information model files (mapping_extensions.hpp), checks them
/// (mapping_check.hpp), shows them as a table (mapping_table.hpp) and serves them.
namespace busbar::controller {

/// The dimensions that a Variable of an unknown number of elements is mapped with (seed 001, 9.5,
/// Mapping array specification).
struct ArraySpecification {
    /// Nothing is specified; the dimensions do not count then.
    static constexpr std::int32_t none = 0;

    /// -1 for a scalar, else 1 to 3 dimensions.
    std::int32_t rank{none};
    /// Elements of each dimension, the outermost first; 0 where the Variable says it itself.
    std::array<std::uint32_t, 3> dimensions{};

    friend bool operator==(const ArraySpecification&, const ArraySpecification&) = default;
};

/// A Variable, an Argument, or a part of one: an element of an array or a field of a structure.
///
/// An element of an array of several dimensions is itself no array: its parts are the elements of
/// the next dimension. Whether it is a structure is said at the array, whose innermost elements
/// then have the fields as parts.
struct MappedPart {
    enum class Kind : std::uint8_t {
        Whole,   // the value of a Variable or an Argument
        Element, // of an array, by its number
        Field,   // of a structure, by its name
    };

    Kind kind{Kind::Whole};
    /// Of an Element its index, which counts from 0; of an Argument its place among the
    /// InputArguments.
    std::uint32_t number{0};
    /// Of a Field.
    std::string name{};
    /// The name of a label; empty if there is none. What has parts has none.
    std::string label{};
    bool is_array{false};
    bool is_structure{false};
    ArraySpecification specification{};
    std::vector<MappedPart> parts{};

    friend bool operator==(const MappedPart&, const MappedPart&) = default;
};

/// Of a Variable.
struct DataMapping {
    MappedPart value{};
    /// As the file had it; empty if it had none. Whoever changes the value leaves it: it is made
    /// anew when the mapping is written.
    std::string sign{};

    friend bool operator==(const DataMapping&, const DataMapping&) = default;
};

/// Of a Method.
struct MethodMapping {
    /// The label whose bit 0 tells the program of a call; empty if there is none.
    std::string handle{};
    /// By their numbers in ascending order; of InputArguments that are not mapped there is none.
    std::vector<MappedPart> arguments{};
    /// As DataMapping::sign.
    std::string sign{};

    friend bool operator==(const MethodMapping&, const MethodMapping&) = default;
};

/// All that is mapped in a project.
struct Mapping {
    std::unordered_map<NodeId, DataMapping> variables{};
    std::unordered_map<NodeId, MethodMapping> methods{};

    friend bool operator==(const Mapping&, const Mapping&) = default;
};

/// How many labels a part and its parts have: units of mapped data (seed 001, 2.1).
[[nodiscard]] BUSBAR_API std::size_t count_labels(const MappedPart& part);
[[nodiscard]] BUSBAR_API std::size_t count_labels(const MethodMapping& method);
[[nodiscard]] BUSBAR_API std::size_t count_labels(const Mapping& mapping);

/// Takes away parts without any label in them, and array specifications that nothing is mapped
/// under: what saving and exporting leave out (seed 001, 9.5). Sorts elements and arguments by
/// their numbers; fields stay in their order.
BUSBAR_API void drop_unmapped(MappedPart& part);
BUSBAR_API void drop_unmapped(Mapping& mapping);

/// Of a mapping's content, whatever its node and its `sign`: "busbar-" and 32 hexadecimal digits
/// of a SHA-256. Finds changes by other tools; proves nothing about who made them.
[[nodiscard]] BUSBAR_API std::string sign_of(const DataMapping& mapping);
[[nodiscard]] BUSBAR_API std::string sign_of(const MethodMapping& mapping);
/// True for what sign_of makes: signs of other tools say nothing to this one.
[[nodiscard]] BUSBAR_API bool is_own_sign(std::string_view sign);

/// What a part is called in reports and tables, below `parent`: "[1][0].Name". Periods, brackets
/// and backslashes in the names of fields have a backslash before them.
[[nodiscard]] BUSBAR_API std::string part_path(std::string_view parent, const MappedPart& part);

} // namespace busbar::controller
