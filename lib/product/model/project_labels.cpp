#include "project_labels.hpp"

#include <algorithm>
#include <utility>

#include <busbar/controller/project_models.hpp>
#include <busbar/core/text_forms.hpp>

#include "core/json_writer.hpp"

namespace busbar::product {

namespace {

using controller::LabelDifference;

constexpr std::size_t most_named = 12;
constexpr std::size_t most_reported = 100;

bool is_usable(const LabelDifference& difference)
{
    return difference.code == controller::ModelCode::LabelConverted;
}

} // namespace

Configured<std::vector<LabelDifference>> label_differences(const controller::Project& project,
                                                           const backend::LabelBackend& plc)
{
    return controller::load_models(project).transform([&](const controller::ModelSet& models) {
        return controller::compare_labels(models, plc).value_or(std::vector<LabelDifference>{});
    });
}

Configured<void> check_usable(const std::vector<LabelDifference>& differences)
{
    std::string names;
    std::size_t unusable = 0;
    for (const LabelDifference& each : differences) {
        if (!is_usable(each) && unusable++ < most_named) {
            names += (names.empty() ? "" : "; ") + controller::text(each);
        }
    }
    if (unusable == 0) {
        return {};
    }
    if (unusable > most_named) {
        names += "; and " + std::to_string(unusable - most_named) + " more";
    }
    return misconfigured("project",
                         std::to_string(unusable) +
                             " of its labels cannot be used with the PLC's program: " + names);
}

std::string labels_report(const std::vector<LabelDifference>& differences)
{
    busbar::detail::JsonWriter json;
    json.begin_object();
    json.name("labels");
    json.begin_list();
    for (std::size_t i = 0; i < std::min(differences.size(), most_reported); ++i) {
        const LabelDifference& each = differences[i];
        const std::pair<const char*, std::string> members[] = {
            {"node", to_string(each.node)}, {"part", each.part},
            {"label", each.label},          {"expected", each.expected},
            {"found", each.found},          {"use", is_usable(each) ? "converted" : "refused"}};
        json.begin_object();
        for (const auto& [name, text] : members) {
            json.name(name);
            json.string(text);
        }
        json.end_object();
    }
    json.end_list();
    json.name("labelCount");
    json.word(std::to_string(differences.size()));
    json.end_object();
    return json.take();
}

} // namespace busbar::product
