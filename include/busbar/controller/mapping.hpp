#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>

/// Maps nodes to labels of a PLC (SH-082679, 9.5), as plain values: model mode reads
/// them from information model files (mapping_extensions.hpp), checks them (mapping_check.hpp),
/// shows them as a table (mapping_table.hpp) and serves them.
namespace busbar::controller {

/// The dimensions for mapping a Variable with an unknown number of elements (manual of model mode,
/// 9.5, Mapping array specification).
struct ArraySpecification {
    /// Nothing is specified; the dimensions are then ignored.
    static constexpr std::int32_t none = 0;

    /// -1 for a scalar, otherwise 1 to 3 dimensions.
    std::int32_t rank{none};
    /// Elements of each dimension, the outermost first; 0 if the Variable itself gives the number.
    std::array<std::uint32_t, 3> dimensions{};

    friend bool operator==(const ArraySpecification&, const ArraySpecification&) = default;
};

/// A Variable, an Argument, or a part of one: an element of an array or a field of a structure.
///
/// An element of an array of several dimensions is itself not an array: its parts are the elements
/// of the next dimension. Whether it is a structure is stored with the array, whose innermost
/// elements then have the fields as parts.
struct MappedPart {
    /// The kind of part.
    enum class Kind : std::uint8_t {
        Whole,   // the value of a Variable or an Argument
        Element, // an element of an array, by its number
        Field,   // a field of a structure, by its name
    };

    Kind kind{Kind::Whole};
    /// For an Element its index, which counts from 0; for an Argument its position among the
    /// InputArguments.
    std::uint32_t number{0};
    /// The name of a Field.
    std::string name{};
    /// The name of a label; empty if there is none, as for everything that has parts.
    std::string label{};
    bool is_array{false};
    bool is_structure{false};
    ArraySpecification specification{};
    std::vector<MappedPart> parts{};

    friend bool operator==(const MappedPart&, const MappedPart&) = default;
};

/// Converts numbers of labels to those of a Variable: linearly, `raw_low` to `low`, `raw_high` to
/// `high`, and likewise beyond these.
struct Scaling {
    double raw_low{0};
    /// Equal to raw_low if nothing is scaled.
    double raw_high{0};
    double low{0};
    /// Equal to low if the EURange of the Variable is meant (Part 8, 5.3.2.3).
    double high{0};

    [[nodiscard]] bool is_set() const { return raw_low != raw_high; }
    [[nodiscard]] bool has_range() const { return low != high; }
    friend bool operator==(const Scaling&, const Scaling&) = default;
};
/// Returns "0..27648=0..100", or "0..27648" for the EURange; empty if it is not set.
[[nodiscard]] BUSBAR_API std::string to_text(const Scaling& scaling);
/// Returns nothing for any other text, for numbers that are not finite and for a range of one
/// number.
[[nodiscard]] BUSBAR_API std::optional<Scaling> parse_scaling(std::string_view text);

/// The mapping of a Variable.
struct DataMapping {
    MappedPart value{};
    /// The sign in the file; empty if it had none. Changing the mapping does not change it: it is
    /// computed again when the mapping is written.
    std::string sign{};
    /// A label that says how good the value is: 0 is Good, anything else of 16 bits or less
    /// Bad_DeviceFailure, and of 32 bits a StatusCode. Empty: it is as good as the label's own.
    std::string quality{};
    Scaling scaling{};

    friend bool operator==(const DataMapping&, const DataMapping&) = default;
};

/// The mapping of a Method.
struct MethodMapping {
    /// The label whose bit 0 signals a call to the program; empty if there is none.
    std::string handle{};
    /// In ascending order of their numbers; InputArguments that are not mapped are omitted.
    std::vector<MappedPart> arguments{};
    /// Like DataMapping::sign.
    std::string sign{};
    /// The label that the program sets when the Method is done: a Call is answered then, with the
    /// OutputArguments. If empty, it is answered when the handle is set.
    std::string done{};
    /// The parts of the OutputArguments, like `arguments`.
    std::vector<MappedPart> outputs{};

    friend bool operator==(const MethodMapping&, const MethodMapping&) = default;
};

/// The complete mapping of a project.
struct Mapping {
    std::unordered_map<NodeId, DataMapping> variables{};
    std::unordered_map<NodeId, MethodMapping> methods{};

    friend bool operator==(const Mapping&, const Mapping&) = default;
};

/// Returns the number of labels in a part and its parts: units of mapped data (manual of model
/// mode, 2.1).
[[nodiscard]] BUSBAR_API std::size_t count_labels(const MappedPart& part);
[[nodiscard]] BUSBAR_API std::size_t count_labels(const DataMapping& variable);
[[nodiscard]] BUSBAR_API std::size_t count_labels(const MethodMapping& method);
[[nodiscard]] BUSBAR_API std::size_t count_labels(const Mapping& mapping);

/// Returns the nodes that are mapped, in the order of their NodeIds, each once.
[[nodiscard]] BUSBAR_API std::vector<NodeId> mapped_nodes(const Mapping& mapping);

/// Removes parts without labels, and array specifications without mapped elements, as saving and
/// exporting do (SH-082679, 9.5). Sorts elements and arguments by their numbers; fields
/// stay in their order.
BUSBAR_API void drop_unmapped(MappedPart& part);
BUSBAR_API void drop_unmapped(Mapping& mapping);

/// Returns a sign of a mapping's content, without its node and its `sign`: "busbar-" and 32
/// hexadecimal digits of a SHA-256. Reveals changes by other tools; does not prove who made them.
[[nodiscard]] BUSBAR_API std::string sign_of(const DataMapping& mapping);
[[nodiscard]] BUSBAR_API std::string sign_of(const MethodMapping& mapping);
/// Returns true for results of sign_of; signs of other tools cannot be checked.
[[nodiscard]] BUSBAR_API bool is_own_sign(std::string_view sign);

/// Returns the name of a part below `parent` in reports and tables: "[1][0].Name". Periods,
/// brackets and backslashes in the names of fields are preceded by a backslash.
[[nodiscard]] BUSBAR_API std::string part_path(std::string_view parent, const MappedPart& part);

} // namespace busbar::controller
