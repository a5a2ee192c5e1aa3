#include <busbar/controller/project_models.hpp>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include <busbar/backend/label_name.hpp>
#include <busbar/controller/mapping_check.hpp>
#include <busbar/controller/node_roles.hpp>

namespace busbar::controller {

namespace {

Problem first_error(const std::string& name, const ModelReports& reports)
{
    for (const ModelReport& report : reports.list()) {
        if (rule_of(report.code).result == ReportResult::Error) {
            return {.where = report.where.empty() ? name : report.where, .text = text(report)};
        }
    }
    return {.where = name, .text = "cannot be imported"};
}

} // namespace

ModelLimits model_limits(const Project& project)
{
    return project.preset == "rd81opc96" ? rd81opc96_model() : ModelLimits{};
}

Configured<ModelSet> load_models(const Project& project, ModelReports* reports)
{
    ModelSet models{model_limits(project)};
    for (const ProjectModel& model : project.models) {
        auto imported = models.import({model.name, model.text});
        if (!imported) {
            return Unexpected{first_error(model.name, imported.error())};
        }
        if (reports != nullptr) {
            reports->add(std::move(imported->reports));
        }
    }
    return models;
}

void keep_models(const ModelSet& models, Project& project)
{
    std::vector<std::string> texts = models.export_texts();
    std::vector<ProjectModel> kept;
    for (std::size_t i = 0; i < texts.size(); ++i) {
        kept.push_back({models.files()[i].name, std::move(texts[i])});
    }
    project.models = std::move(kept);
}

Configured<void> check_models(const Project& project)
{
    return load_models(project).transform([](const ModelSet&) {});
}

Configured<void> check_mapped_models(const Project& project)
{
    return load_models(project).and_then([&](const ModelSet& models) -> Configured<void> {
        const MappingCheck check = check_project_mapping(project, models);
        if (check.reports.has_errors()) {
            return Unexpected{first_error("mapping", check.reports)};
        }
        return {};
    });
}

MappingCheck check_project_mapping(const Project& project, const ModelSet& models)
{
    const bool has_preset = !project.preset.empty();
    const auto check_label = [has_preset](std::string_view label) -> std::optional<Problem> {
        if (const auto name = backend::parse_label_name(label); !name) {
            return name.error();
        }
        return has_preset ? backend::check_label_characters(label) : std::nullopt;
    };
    MappingCheck check = check_mapping(models, check_label);
    check.reports.add(check_roles(models));
    return check;
}

} // namespace busbar::controller
