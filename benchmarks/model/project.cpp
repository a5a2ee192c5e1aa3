#include "project.hpp"

#include <span>
#include <utility>

#include <busbar/controller/mapping_check.hpp>
#include <busbar/controller/project_compare.hpp>
#include <busbar/controller/project_models.hpp>
#include <busbar/controller/project_store.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "figures.hpp"
#include "spaces.hpp"

namespace busbar::bench {

using namespace controller;

namespace {

enum Phase : std::size_t { Import, Check, Export, Write, Verify };

template <typename Work>
auto timed(double& microseconds, Work&& work)
{
    const auto begin = Clock::now();
    auto result = std::forward<Work>(work)();
    microseconds = elapsed_us(begin);
    return result;
}

/// One project on its way through all phases.
class ProjectRun {
public:
    ProjectRun(const MappedModel& model, bool is_limited)
    {
        project_.preset = is_limited ? "rd81opc96" : "";
        project_.security.allows_anonymous = true;
        project_.models = model_files(model);
        point_.nodes = model.node_count();
        point_.mapped = model.variable_count();
        point_.files = project_.models.size();
        point_.is_limited = is_limited;
        for (const ProjectModel& each : project_.models) {
            point_.file_bytes += each.text.size();
        }
    }

    [[nodiscard]] Configured<ProjectPoint> run()
    {
        return import()
            .and_then([&] { return write(); })
            .and_then([&] { return verify(); })
            .transform([&] { return point_; });
    }

private:
    [[nodiscard]] Configured<void> import();
    [[nodiscard]] Configured<void> check(const ModelSet& models);
    [[nodiscard]] Configured<void> write();
    [[nodiscard]] Configured<void> verify();
    [[nodiscard]] double& phase(Phase which) { return point_.phase_us.at(which); }

    Project project_;
    ProjectPoint point_;
    storage::MemoryStorage storage_;
    ProjectStore store_{storage_, "project", check_models};
};

Configured<void> ProjectRun::import()
{
    const std::size_t before = heap_in_use();
    const auto models = timed(phase(Import), [&] { return load_models(project_); });
    if (!models) {
        return Unexpected{models.error()};
    }
    point_.held_bytes = heap_in_use() - before;
    if (auto checked = check(*models); !checked) {
        return checked;
    }
    // Not what is written: with the Signs it may be more than the preset takes.
    Project exported;
    phase(Export) = 0;
    timed(phase(Export), [&] {
        keep_models(*models, exported);
        return true;
    });
    return exported.models.size() == point_.files ? Configured<void>{}
                                                  : misconfigured("export", "models are missing");
}

Configured<void> ProjectRun::check(const ModelSet& models)
{
    const MappingCheck found = timed(phase(Check), [&] { return check_mapping(models); });
    if (!found.reports.is_empty()) {
        return misconfigured("check", text(found.reports.list().front()));
    }
    return found.counters.labels == point_.mapped && found.counters.variables == point_.mapped
               ? Configured<void>{}
               : misconfigured("check", "Variables were not found");
}

Configured<void> ProjectRun::write()
{
    if (auto recovered = store_.recover(); !recovered) {
        return recovered;
    }
    forget_peak();
    const double before = peak_megabytes();
    auto written = timed(phase(Write), [&] {
        return document_of(project_).and_then([&](const std::string& document) {
            return store_.replace(std::as_bytes(std::span{document}));
        });
    });
    point_.most_bytes = static_cast<std::size_t>((peak_megabytes() - before) * 1'024 * 1'024);
    return written;
}

Configured<void> ProjectRun::verify()
{
    const auto differences =
        timed(phase(Verify), [&]() -> Configured<std::vector<ProjectDifference>> {
            return store_.document()
                .and_then([](const std::string& file) { return read_project(file, "store"); })
                .transform([&](const Project& there) {
                    auto all = setting_differences(project_, there);
                    const auto models = model_differences(project_, there);
                    all.insert(all.end(), models.begin(), models.end());
                    return all;
                });
        });
    if (!differences) {
        return Unexpected{differences.error()};
    }
    return differences->empty() ? Configured<void>{}
                                : misconfigured(differences->front().where, "differs");
}

} // namespace

Configured<std::vector<ProjectPoint>> measure_projects(const ProjectOptions& options)
{
    std::vector<ProjectPoint> points;
    for (const MappedModel* const model : {&options.limited, &options.open}) {
        auto point = ProjectRun{*model, model == &options.limited}.run();
        if (!point) {
            return Unexpected{std::move(point).error()};
        }
        points.push_back(*point);
    }
    return points;
}

} // namespace busbar::bench
