#pragma once

#include <string>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_check.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

/// The labels of a project that the PLC which runs has not, or has of another type than their nodes
/// (SH-082679, 8.2 and 8.3). None where the PLC has to be asked for its labels: the server does
/// that once the project counts. A problem is one of the project's models. Takes time in proportion
/// to the project; any thread.
[[nodiscard]] Configured<std::vector<controller::LabelDifference>>
label_differences(const controller::Project& project, const backend::LabelBackend& plc);

/// The problem names the labels that cannot be used, up to a dozen, with node, expected and found
/// type. Those whose values are converted where they are in range can.
[[nodiscard]] Configured<void>
check_usable(const std::vector<controller::LabelDifference>& differences);

/// {"labels": [{"node", "part", "label", "expected", "found", "use"}], "labelCount"}: the first 100
/// of so many; "use" is "converted" or "refused".
[[nodiscard]] std::string
labels_report(const std::vector<controller::LabelDifference>& differences);

} // namespace busbar::product
