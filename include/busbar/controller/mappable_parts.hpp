#pragma once

#include <string>
#include <vector>

#include <busbar/controller/label_conversion.hpp>
#include <busbar/controller/mapping_check.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/model/space_reader.hpp>

namespace busbar::controller {

/// A part of a node that can have a label, or has one (seed 001, 9.4 and 9.5).
struct MappablePart {
    /// As the column Part of a mapping table has it: empty for a scalar, ".A", "[0].A", "Handle",
    /// "Input[0]".
    std::string path{};
    /// Of its value: "Int16", "Enumeration"; empty for a label where none can be.
    std::string type{};
    /// Empty if it has none.
    std::string label{};
    /// What assignability() asks for; no built-in type where no label can be.
    LeafType leaf{};
};

/// What there is to map in a project, node by node. Refers to the ModelSet, whose nodes must stay
/// as they are; its mapping may change.
class BUSBAR_API MappableParts {
public:
    explicit MappableParts(const ModelSet& models);

    /// The parts of a Variable's value in their order; of a Method its Handle and the parts of its
    /// InputArguments. Those that cannot have a label but have one come last. None for a node that
    /// cannot be mapped.
    [[nodiscard]] std::vector<MappablePart> of(model::NodeIndex node);
    /// Why of() gives no part that can have a label; empty if it gives one. Printable.
    [[nodiscard]] std::string why_none(model::NodeIndex node);

private:
    const ModelSet& models_;
    NodePlaces places_;
    model::DataTypes types_;
};

} // namespace busbar::controller
