#include <busbar/controller/label_check.hpp>

#include <utility>

#include <busbar/controller/model_set.hpp>
#include <busbar/controller/simulated_labels.hpp>
#include <busbar/core/text.hpp>

namespace busbar::controller {

namespace {

using backend::LabelError;
using backend::ResolvedLabel;

struct LabelledPart {
    NodeId node;
    MappablePart part;
};

/// Collects all labels of the mapping in the order of their nodes.
std::vector<LabelledPart> labelled_parts(const ModelSet& models)
{
    std::vector<LabelledPart> labelled;
    MappableParts parts{models};
    for (const NodeId& id : mapped_nodes(models.mapping())) {
        const model::NodeIndex node = models.space().find(id);
        if (node == model::no_node) {
            continue; // check_mapping reports it
        }
        for (MappablePart& part : parts.of(node)) {
            if (!part.label.empty()) {
                labelled.push_back({id, std::move(part)});
            }
        }
    }
    return labelled;
}

std::string_view reason(LabelError error)
{
    switch (error) {
    case LabelError::Unknown:
        return "the PLC has no label of this name";
    case LabelError::NotAccessible:
        return "the PLC does not publish it";
    case LabelError::Constant:
        return "it is CONSTANT in the PLC";
    case LabelError::NotAName:
        return "it is an array, a structure or a bit as a whole";
    case LabelError::UnsupportedType:
        return "it is of a type in the PLC that no label can have";
    case LabelError::None:
        break;
    }
    return {};
}

/// Compares a label with its part; nothing if their values are the same.
std::optional<LabelDifference> difference_of(const LabelledPart& about, const ResolvedLabel& label)
{
    const LabelTypes types = label_types_for(about.part);
    LabelDifference difference{.node = about.node,
                               .part = about.part.path,
                               .label = about.part.label,
                               .expected = types.same.empty() ? types.checked : types.same,
                               .found = {},
                               .code = ModelCode::LabelUnavailable};
    if (label.error != LabelError::None) {
        difference.found = reason(label.error);
        return difference;
    }
    const Assignability use = label_use(about.part, label.kind.type, label.kind.part);
    // Some types have no label with the same values: an SByte is always converted.
    if (use == Assignability::Same || (use == Assignability::Checked && types.same.empty())) {
        return std::nullopt;
    }
    difference.found = declaration_of(label.kind);
    difference.code =
        use == Assignability::No ? ModelCode::LabelOfWrongType : ModelCode::LabelConverted;
    return difference;
}

/// Describes a difference: "found STRING(20), expected INT".
std::string finding(const LabelDifference& difference)
{
    const bool is_there = difference.code != ModelCode::LabelUnavailable;
    return (is_there ? "found " : "") + difference.found + ", expected " +
           (difference.expected.empty() ? "none, as no label can have the value"
                                        : difference.expected);
}

} // namespace

std::string text(const LabelDifference& difference)
{
    return printable(difference.label) + " of " + to_string(difference.node) +
           (difference.part.empty() ? "" : ": " + printable(difference.part)) + ": " +
           finding(difference);
}

std::optional<std::vector<LabelDifference>> compare_labels(const ModelSet& models,
                                                           const backend::LabelBackend& plc)
{
    const std::vector<LabelledPart> labelled = labelled_parts(models);
    std::vector<std::string> names;
    names.reserve(labelled.size());
    for (const LabelledPart& each : labelled) {
        names.push_back(each.part.label);
    }
    const auto labels = plc.look_up(names);
    if (!labels || labels->size() != labelled.size()) {
        return std::nullopt;
    }
    std::vector<LabelDifference> differences;
    for (std::size_t i = 0; i < labelled.size(); ++i) {
        if (auto difference = difference_of(labelled[i], (*labels)[i])) {
            differences.push_back(*std::move(difference));
        }
    }
    return differences;
}

Configured<ModelReports> check_labels(const ModelSet& models, Program program)
{
    const auto labels = SimulatedLabels::create(std::move(program));
    if (!labels) {
        return Unexpected{labels.error()};
    }
    const auto differences = compare_labels(models, **labels);
    ModelReports reports;
    for (const LabelDifference& each : *differences) {
        reports.add({each.code, each.node,
                     to_string(each.node) + (each.part.empty() ? "" : ": " + printable(each.part)),
                     printable(each.label) + ": " + finding(each)});
    }
    return reports;
}

} // namespace busbar::controller
