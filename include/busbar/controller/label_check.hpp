#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_conversion.hpp>
#include <busbar/controller/mappable_parts.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// Checks whether the labels of a project are those of a PLC, before a server asks the PLC. In the
/// target busbar::model_mode, which needs pugixml.
namespace busbar::controller {

class ModelSet;

/// A type that labels are declared as in a PLC's program, see LabelProgram.
struct DeclaredLabelType {
    /// "UINT, WORD"
    const char* text;
    backend::LabelType type;
    backend::TimerPart part{backend::TimerPart::None};
};
/// The number of types that a label can be declared with.
inline constexpr std::size_t declared_label_type_count = 16;
/// Returns all of them.
[[nodiscard]] BUSBAR_API const std::array<DeclaredLabelType, declared_label_type_count>&
declared_label_types();
/// Returns "STRING(20)", "TIMER .N".
[[nodiscard]] BUSBAR_API std::string declaration_of(const backend::LabelKind& kind);

/// Returns assignability() of the part's value; for a Handle, a Quality and a scaled value Same or
/// No.
[[nodiscard]] BUSBAR_API Assignability label_use(const MappablePart& part, backend::LabelType type,
                                                 backend::TimerPart timer);

/// Lists of declared types ("INT; UINT, WORD"), by how they suit a part of a node (manual of model
/// mode, 8.2).
struct LabelTypes {
    std::string same{};
    /// Types whose values suit where they are in the range of both.
    std::string checked{};
};
/// Returns the types of labels that a part can be mapped to.
[[nodiscard]] BUSBAR_API LabelTypes label_types_for(const MappablePart& part);

/// A label whose type differs from the one that has the values of its part.
struct LabelDifference {
    NodeId node{};
    /// Like MappablePart::path.
    std::string part{};
    std::string label{};
    /// "UINT, WORD": types with the same values, or if there are none, those whose range may hold
    /// them; empty where no label fits.
    std::string expected{};
    /// "STRING(20)"; the reason why the label cannot be used if `code` is LabelUnavailable.
    std::string found{};
    /// LabelUnavailable (1921H), LabelOfWrongType (1A00H), or LabelConverted: its values count
    /// where they are in range.
    ModelCode code{};
};
/// Returns "Line.Name of ns=1;i=5: [0].A: found STRING(20), expected INT". Printable.
[[nodiscard]] BUSBAR_API std::string text(const LabelDifference& difference);

/// Returns all labels of the project that differ, in the order of their nodes. Nothing if the PLC
/// does not know its labels without being asked, see LabelBackend::look_up.
[[nodiscard]] BUSBAR_API std::optional<std::vector<LabelDifference>>
compare_labels(const ModelSet& models, const backend::LabelBackend& plc);

/// The same with the program of a PLC, as reports: where a server would report the errors 1921H and
/// 1A00H (SH-082679, 8.3). A problem is one with the program.
[[nodiscard]] BUSBAR_API Configured<ModelReports> check_labels(const ModelSet& models,
                                                               Program program);

} // namespace busbar::controller
