#pragma once

#include <string>
#include <vector>

#include <busbar/controller/label_conversion.hpp>
#include <busbar/controller/mapping_check.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/model/space_reader.hpp>

namespace busbar::controller {

/// A part of a node that can have a label, or has one (SH-082679, 9.4 and 9.5).
struct MappablePart {
    /// The text in column Part of a mapping table: empty for a scalar, ".A", "[0].A", "Quality",
    /// "Handle", "Done", "Input[0]", "Output[0]".
    std::string path{};
    /// The type of its value: "Int16", "Enumeration"; empty if the part cannot have a label but has
    /// one.
    std::string type{};
    /// Empty if it has none.
    std::string label{};
    /// The argument for assignability(); no built-in type if the part cannot have a label.
    LeafType leaf{};
    /// The label's numbers are scaled.
    bool is_scaled{false};
};

/// Lists the mappable parts of a project, node by node. Refers to the ModelSet, whose nodes must
/// not change; its mapping may.
class BUSBAR_API MappableParts {
public:
    explicit MappableParts(const ModelSet& models);

    /// Returns the parts of a Variable's value in their order, and its Quality if that has a label;
    /// for a Method its Handle, Done if it has OutputArguments or a label for it, and the parts of
    /// its arguments. Those that cannot have a label but have one come last. Returns none for a
    /// node that cannot be mapped.
    [[nodiscard]] std::vector<MappablePart> of(model::NodeIndex node);
    /// Returns why of() gives no part that can have a label; empty if it gives one. Printable.
    [[nodiscard]] std::string why_none(model::NodeIndex node);

private:
    const ModelSet& models_;
    NodePlaces places_;
    model::DataTypes types_;
};

} // namespace busbar::controller
