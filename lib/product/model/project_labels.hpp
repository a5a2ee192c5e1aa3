#pragma once

#include <string>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_check.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

/// Lists the labels of a project that the running PLC does not have, or has with another type than
/// their nodes (SH-082679, 8.2 and 8.3). Empty if the PLC must be asked for its labels, which the
/// server does later. Fails if the project's models are not valid. Takes time in proportion to the
/// project; thread-safe.
[[nodiscard]] Configured<std::vector<controller::LabelDifference>>
label_differences(const controller::Project& project, const backend::LabelBackend& plc);

/// Fails with a list of the labels that cannot be used, up to a dozen, with node, expected and
/// found type. Labels whose values are converted within their range can be used.
[[nodiscard]] Configured<void>
check_usable(const std::vector<controller::LabelDifference>& differences);

/// Writes {"labels": [{"node", "part", "label", "expected", "found", "use"}], "labelCount"} with
/// the first 100 labels; "use" is "converted" or "refused".
[[nodiscard]] std::string
labels_report(const std::vector<controller::LabelDifference>& differences);

} // namespace busbar::product
