#pragma once

#include <cstdint>
#include <vector>

#include "document.hpp"
#include "load_plan.hpp"

namespace busbar::nodeset {

/// Repairs the nodes of a Document's lenient files, so that a LoadPlan accepts them. Every repair
/// is noted in the Document.
class Mender {
public:
    /// `plan` is for looking up: nothing of it may have been checked.
    Mender(Document& document, const LoadPlan& plan);

    void mend();

private:
    [[nodiscard]] bool is_mended(const Node& node) const;
    void drop_references(Node& node);
    /// Returns why a reference cannot stay, empty if it can.
    [[nodiscard]] std::string fault(const Node& node, const Reference& reference) const;
    void find_types();
    void find_types(Node& node);
    /// Returns false if the node has another one already.
    [[nodiscard]] bool note_type(const Node& node, const Reference& reference);
    void add_supertype(Node& node);
    void add_type_definition(Node& node);
    void check_data_type(Node& node);
    void repair(model::NodeSetRule rule, const Node& node, std::string done, std::uint32_t line = 0)
    {
        document_.add_repair(rule, document_.problem(node, std::move(done), line));
    }

    Document& document_;
    const LoadPlan& plan_;
    /// Each is indexed by position in the document, and null until it is known.
    std::vector<NodeId> supertypes_;
    std::vector<NodeId> type_definitions_;
};

} // namespace busbar::nodeset
