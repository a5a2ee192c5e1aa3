#include <busbar/controller/label_check.hpp>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <busbar/controller/mappable_parts.hpp>
#include <busbar/controller/model_set.hpp>
#include <busbar/controller/simulated_labels.hpp>
#include <busbar/core/text.hpp>

#include "table_columns.hpp"

namespace busbar::controller {

namespace {

using backend::LabelError;
using backend::LabelRequest;
using backend::ResolvedLabel;

struct LabelledPart {
    NodeId node;
    MappablePart part;
};

/// All labels of the mapping, in the order of their nodes.
std::vector<LabelledPart> labelled_parts(const ModelSet& models)
{
    const Mapping& mapping = models.mapping();
    std::vector<NodeId> nodes;
    for (const auto& each : mapping.variables) {
        nodes.push_back(each.first);
    }
    for (const auto& each : mapping.methods) {
        nodes.push_back(each.first);
    }
    std::sort(nodes.begin(), nodes.end());
    std::vector<LabelledPart> labelled;
    MappableParts parts{models};
    for (const NodeId& id : nodes) {
        const model::NodeIndex node = models.space().find(id);
        if (node == model::no_node) {
            continue; // check_mapping tells
        }
        for (MappablePart& part : parts.of(node)) {
            if (!part.label.empty()) {
                labelled.push_back({id, std::move(part)});
            }
        }
    }
    return labelled;
}

/// Takes the answer of one request.
class Answer final : public backend::LabelListener {
public:
    void done(std::unique_ptr<LabelRequest> request) override { request_ = std::move(request); }
    void labels_changed() override {}
    [[nodiscard]] std::vector<ResolvedLabel> labels()
    {
        return request_ != nullptr ? std::move(request_->labels) : std::vector<ResolvedLabel>{};
    }

private:
    std::unique_ptr<LabelRequest> request_;
};

std::vector<ResolvedLabel> resolve(SimulatedLabels& labels,
                                   const std::vector<LabelledPart>& labelled)
{
    auto request = std::make_unique<LabelRequest>();
    request->kind = LabelRequest::Kind::Resolve;
    for (const LabelledPart& each : labelled) {
        request->names.push_back(each.part.label);
    }
    Answer answer;
    labels.end_of_scan(DateTime{}); // a PLC that has not scanned yet does not answer
    labels.attach(&answer);
    labels.start(std::move(request));
    labels.end_of_scan(DateTime{});
    labels.attach(nullptr);
    return answer.labels();
}

std::string_view reason(LabelError error)
{
    switch (error) {
    case LabelError::Unknown:
        return "it has none of this name";
    case LabelError::NotAccessible:
        return "it is not published";
    case LabelError::Constant:
        return "it is CONSTANT";
    case LabelError::NotAName:
        return "it is an array, a structure or a bit as a whole";
    case LabelError::UnsupportedType:
        return "no label can have its type";
    case LabelError::None:
        break;
    }
    return {};
}

bool fits(const MappablePart& part, const backend::LabelKind& kind)
{
    return part.path == detail::handle_part
               ? is_handle_label(kind.type)
               : assignability(part.leaf, kind.type, kind.part) != Assignability::No;
}

} // namespace

Configured<ModelReports> check_labels(const ModelSet& models, Program program)
{
    auto labels = SimulatedLabels::create(std::move(program));
    if (!labels) {
        return Unexpected{std::move(labels.error())};
    }
    const std::vector<LabelledPart> labelled = labelled_parts(models);
    const std::vector<ResolvedLabel> resolved = resolve(**labels, labelled);
    ModelReports reports;
    const auto report = [&](ModelCode code, const LabelledPart& about, std::string_view why) {
        const std::string& path = about.part.path;
        reports.add({code, about.node, to_string(about.node) + (path.empty() ? "" : ": " + path),
                     printable(about.part.label) + ": " + std::string{why}});
    };
    for (std::size_t i = 0; i < labelled.size(); ++i) {
        const ResolvedLabel label = i < resolved.size() ? resolved[i] : ResolvedLabel{};
        if (label.error != LabelError::None) {
            report(ModelCode::LabelUnavailable, labelled[i], reason(label.error));
        } else if (!fits(labelled[i].part, label.kind)) {
            report(ModelCode::LabelOfWrongType, labelled[i],
                   "the part is " + (labelled[i].part.type.empty() ? "of a type without labels"
                                                                   : labelled[i].part.type));
        }
    }
    return reports;
}

} // namespace busbar::controller
