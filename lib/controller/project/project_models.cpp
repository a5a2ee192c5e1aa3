#include <busbar/controller/project_models.hpp>

#include <algorithm>
#include <utility>

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

} // namespace busbar::controller
