#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/controller/mapped_source.hpp>

namespace busbar::controller::detail {

/// A label that a leaf of a value is mapped to.
struct MappedLeaf {
    /// Index in the shape.
    std::uint32_t leaf{0};
    /// Index of the node, see MappedTable::node_of.
    std::uint32_t node{0};
    /// Raw leaves are only compared with 0.
    enum class Use : std::uint8_t { Value, Handle, Raw };
    Use use{Use::Value};
    /// Index of the scaling plus one; 0 without scaling.
    std::uint32_t scaling{0};
    LeafType type{};

    // Result of resolving the label.

    std::uint64_t address{0};
    std::uint32_t words{0};
    bool is_unsampled_device{false};
    std::optional<LabelConversion> conversion{};
};

/// The leaves of one value, which are adjacent in the table.
struct LeafRange {
    std::uint32_t first{0};
    std::uint32_t count{0};
    /// Size of all leaves in bytes and in words.
    std::size_t bytes{0};
    std::size_t words{0};
};

/// All mapped Variables and Methods, with the results of resolving their labels.
class MappedTable {
public:
    struct Variable {
        /// Number of leaves to read.
        [[nodiscard]] std::size_t count() const { return range.count + quality.count; }
        [[nodiscard]] std::size_t words() const { return range.words + quality.words; }
        [[nodiscard]] std::size_t bytes() const { return range.bytes + quality.bytes; }

        std::shared_ptr<const ValueShape> shape;
        LeafRange range;
        /// One leaf or none.
        LeafRange quality;
        bool is_readable{true};
        /// One of its labels cannot be used, and only this node fails for it.
        bool is_broken{false};
        /// The last value and its time; no time if it was never read or written.
        Variant kept;
        DateTime time;
        /// Empty if the Variable is not monitored.
        std::optional<Duration> interval;
        /// Offset in the bytes that are sampled in each scan.
        std::uint32_t sampled_at{not_sampled};
    };
    struct Argument {
        std::shared_ptr<const ValueShape> shape;
        LeafRange range;
    };
    struct Method {
        /// One leaf or none.
        LeafRange handle;
        LeafRange done;
        std::vector<Argument> arguments;
        std::vector<Argument> outputs;
        bool has_outputs{false};
        bool is_broken{false};
        bool is_running{false};
    };
    static constexpr std::uint32_t not_sampled = UINT32_MAX;

    [[nodiscard]] std::uint64_t add(MappedVariable variable);
    [[nodiscard]] std::uint64_t add(MappedMethod method);

    /// Names of all labels in the order of the leaves. The request that resolves them borrows this.
    [[nodiscard]] std::vector<std::string>& names() { return names_; }
    [[nodiscard]] std::span<const MappedLeaf> leaves() const { return leaves_; }
    [[nodiscard]] const NodeId& node_of(const MappedLeaf& leaf) const { return nodes_[leaf.node]; }
    [[nodiscard]] std::string_view name_of(const MappedLeaf& leaf) const
    {
        return names_[static_cast<std::size_t>(&leaf - leaves_.data())];
    }
    [[nodiscard]] std::vector<Variable>& variables() { return variables_; }
    [[nodiscard]] const std::vector<Variable>& variables() const { return variables_; }
    /// Null for an unknown handle.
    [[nodiscard]] Variable* variable(std::uint64_t handle);
    [[nodiscard]] Method* method(std::uint64_t handle);

    /// Takes over the resolved labels, one for each leaf. False if some cannot be used, which is
    /// reported to `observer`, if not null. With isolated failures, those only break their nodes.
    [[nodiscard]] bool resolve(std::span<const backend::ResolvedLabel> labels,
                               const MappedOptions& options, MappedObserver* observer);

    /// Adds the places of a value to a request, and room for its bytes.
    void add_places(const LeafRange& range, backend::LabelRequest& request) const;
    /// The same for a value and its quality.
    void add_places(const Variable& variable, backend::LabelRequest& request) const;
    /// Decodes the quality of the Variable's value; `bytes` hold the value followed by the quality.
    [[nodiscard]] StatusCode quality_of(const Variable& variable, const std::byte* bytes) const;
    /// Decodes a value from `bytes`, which have the layout that add_places made. `previous` may be
    /// null. Sets `culprit` on Bad_OutOfRange.
    [[nodiscard]] Result<Variant> decode(const ValueShape& shape, const LeafRange& range,
                                         const std::byte* bytes, const Variant* previous,
                                         const MappedLeaf** culprit) const;
    /// Encodes a value into as many bytes as the range has.
    [[nodiscard]] StatusCode encode(const ValueShape& shape, const LeafRange& range,
                                    const Variant& value, std::byte* bytes) const;

private:
    [[nodiscard]] LeafRange add_leaves(const ValueShape& shape, std::vector<std::string>& labels,
                                       std::uint32_t scaling = 0);
    [[nodiscard]] LeafRange add_leaf(std::string label, MappedLeaf::Use use, LeafType type);
    void add_argument(MappedArgument& argument, std::vector<Argument>& to);
    [[nodiscard]] std::optional<LabelConversion>
    conversion_of(const MappedLeaf& leaf, const backend::LabelKind& kind,
                  const ConversionOptions& options) const;
    [[nodiscard]] bool resolve_one(MappedLeaf& leaf, const backend::ResolvedLabel& label,
                                   const ConversionOptions& options, MappedObserver* observer);
    /// False if one of its labels cannot be used; the range then takes no bytes.
    [[nodiscard]] bool measure(LeafRange& range) const;
    void measure_all();

    std::vector<MappedLeaf> leaves_;
    std::vector<std::string> names_;
    std::vector<NodeId> nodes_;
    std::vector<Scaling> scalings_;
    std::vector<Variable> variables_;
    std::vector<Method> methods_;
};

} // namespace busbar::controller::detail
