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
    /// Its number in the shape.
    std::uint32_t leaf{0};
    /// The number of the node, see MappedTable::node_of.
    std::uint32_t node{0};
    /// Raw: of what is told by its bytes, 0 or not.
    enum class Use : std::uint8_t { Value, Handle, Raw };
    Use use{Use::Value};
    /// Behind the index of its scaling, from 1 on; 0: it is not scaled.
    std::uint32_t scaling{0};
    LeafType type{};

    // What it was resolved to.

    std::uint64_t address{0};
    std::uint32_t words{0};
    bool is_unsampled_device{false};
    std::optional<LabelConversion> conversion{};
};

/// The leaves of one value: neighbours in the table.
struct LeafRange {
    std::uint32_t first{0};
    std::uint32_t count{0};
    /// Bytes and words of all of them.
    std::size_t bytes{0};
    std::size_t words{0};
};

/// All that is mapped, and what it was resolved to.
class MappedTable {
public:
    struct Variable {
        /// What it takes in a request that reads.
        [[nodiscard]] std::size_t count() const { return range.count + quality.count; }
        [[nodiscard]] std::size_t words() const { return range.words + quality.words; }
        [[nodiscard]] std::size_t bytes() const { return range.bytes + quality.bytes; }

        std::shared_ptr<const ValueShape> shape;
        LeafRange range;
        /// Of one leaf, or none.
        LeafRange quality;
        bool is_readable{true};
        /// A label of it cannot be used, where that fails no other.
        bool is_broken{false};
        /// What it had last, and when; no time before it was read or written.
        Variant kept;
        DateTime time;
        /// Not monitored: nothing.
        std::optional<Duration> interval;
        /// In the bytes that are sampled in each scan.
        std::uint32_t sampled_at{not_sampled};
    };
    struct Argument {
        std::shared_ptr<const ValueShape> shape;
        LeafRange range;
    };
    struct Method {
        /// Of one leaf, or none.
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

    /// The names of all labels in the order of the leaves. Lent to the request that resolves them.
    [[nodiscard]] std::vector<std::string>& names() { return names_; }
    [[nodiscard]] std::span<const MappedLeaf> leaves() const { return leaves_; }
    [[nodiscard]] const NodeId& node_of(const MappedLeaf& leaf) const { return nodes_[leaf.node]; }
    [[nodiscard]] std::string_view name_of(const MappedLeaf& leaf) const
    {
        return names_[static_cast<std::size_t>(&leaf - leaves_.data())];
    }
    [[nodiscard]] std::vector<Variable>& variables() { return variables_; }
    [[nodiscard]] const std::vector<Variable>& variables() const { return variables_; }
    /// Null for a handle that is none.
    [[nodiscard]] Variable* variable(std::uint64_t handle);
    [[nodiscard]] Method* method(std::uint64_t handle);

    /// Takes what the labels have become, one for each leaf; false if some cannot be used, which
    /// `observer`, that may be null, is told. Where failures are isolated those break their nodes.
    [[nodiscard]] bool resolve(std::span<const backend::ResolvedLabel> labels,
                               const MappedOptions& options, MappedObserver* observer);

    /// Adds the places of a value to a request, whose bytes grow.
    void add_places(const LeafRange& range, backend::LabelRequest& request) const;
    /// The same of its value and quality.
    void add_places(const Variable& variable, backend::LabelRequest& request) const;
    /// How good the Variable's value is; `bytes` hold it and then its quality.
    [[nodiscard]] StatusCode quality_of(const Variable& variable, const std::byte* bytes) const;
    /// A value of `bytes`, which hold what add_places made places for. `previous` may be null.
    /// Bad_OutOfRange sets `culprit`.
    [[nodiscard]] Result<Variant> decode(const ValueShape& shape, const LeafRange& range,
                                         const std::byte* bytes, const Variant* previous,
                                         const MappedLeaf** culprit) const;
    /// A value to bytes, as many as the range has.
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
    /// False if a label of it cannot be used; the range then takes nothing.
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
