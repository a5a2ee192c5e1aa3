#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/model/nodeset.hpp>
#include <busbar/model/space_reader.hpp>

#include "document.hpp"

namespace busbar::nodeset {

/// The node that a NodeId of a document refers to: one of its nodes, or one of the AddressSpace.
struct Target {
    const Node* node{nullptr};
    model::NodeIndex index{model::no_node};

    [[nodiscard]] bool exists() const { return node != nullptr || index != model::no_node; }
};

/// Checks that the nodes of a Document can be added to an AddressSpace, whose namespaces come first
/// in the Document. Finds all errors except unreadable values.
class LoadPlan {
public:
    LoadPlan(const Document& document, const model::SpaceReader& space);

    void check();
    [[nodiscard]] const std::vector<Problem>& errors() const { return errors_; }
    [[nodiscard]] const std::vector<Problem>& notes() const { return notes_; }
    void add_error(Problem error);
    void add_note(Problem note);
    /// True for a node of namespace 0 that the AddressSpace already has.
    [[nodiscard]] bool is_skipped(const Node& node) const;
    [[nodiscard]] Target find(const NodeId& id) const;
    [[nodiscard]] std::string text(const NodeId& id) const;
    [[nodiscard]] NodeClass class_of(const Target& target) const;

private:
    [[nodiscard]] std::size_t position(const Node& node) const
    {
        return static_cast<std::size_t>(&node - document_.nodes().data());
    }
    [[nodiscard]] bool is_abstract(const Target& target) const;

    void fail(const Node& node, std::string message, std::uint32_t line = 0);
    void check_names(const Node& node);
    void check_data_type(const Node& node);
    void check_reference(const Node& node, const Reference& reference);
    void check_type_definition(const Node& node, const Reference& reference);
    void check_supertype(const Node& node, const Reference& reference);
    void check_definitions();
    void note_field_types(const Node& node);

    // Shapes (load_plan_shape.cpp)
    [[nodiscard]] bool is_below(const NodeId& reference_type, std::uint32_t base);
    void check_type_levels();
    [[nodiscard]] const Node* type_above(const Node& node) const;
    void check_circles();
    void collect_children(std::vector<std::vector<std::uint32_t>>& children,
                          std::vector<std::uint32_t>& parent_counts);

    const Document& document_;
    const model::SpaceReader& space_;
    std::vector<Problem> errors_;
    std::vector<Problem> notes_;
    /// Supertypes by position of the node; null until known.
    std::vector<NodeId> supertypes_;
    std::vector<NodeId> type_definitions_;
    std::unordered_map<NodeId, bool> is_hierarchical_;
    std::unordered_map<NodeId, bool> is_has_child_;
};

/// Returns the models that a Document requires and that neither it nor the AddressSpace has, or
/// only in an older version (Part 6, F.5). An older version for a lenient file is a repair.
[[nodiscard]] std::vector<Problem> missing_models(Document& document,
                                                  const model::SpaceReader& space);

} // namespace busbar::nodeset
