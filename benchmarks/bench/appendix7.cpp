#include "appendix7.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "appendix7_client.hpp"
#include "appendix7_figures.hpp"
#include "mapped_plant.hpp"
#include "mapped_startup.hpp"

namespace busbar::bench {

using controller::SamplingMode;

namespace {

constexpr std::array modes{SamplingMode::Standard, SamplingMode::MonitoredItems,
                           SamplingMode::AllVariables};
constexpr std::string_view mapped_namespace = "ns=2;s=";
constexpr std::string_view plain_namespace = "ns=3;s=";
constexpr int startup_rounds = 3;

/// All that is asked of it, and no more.
MappedModel served(const SevenOptions& options)
{
    MappedModel model;
    model.objects = std::min(model.objects, (options.most + model.variables - 1) / model.variables);
    return model;
}

class SevenRun {
public:
    explicit SevenRun(const SevenOptions& options) : options_{options} {}

    [[nodiscard]] Configured<std::vector<SevenRow>> run()
    {
        for (const SamplingMode mode : modes) {
            if (wants(options_.modes, mode_name(mode))) {
                auto done = services(mode).and_then([&] { return startups(mode); });
                if (!done) {
                    return Unexpected{std::move(done).error()};
                }
            }
        }
        return std::move(rows_);
    }

private:
    [[nodiscard]] static bool wants(const std::vector<std::string>& wanted, std::string_view name)
    {
        return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    }
    [[nodiscard]] bool wants_load(std::string_view load) const
    {
        return wants(options_.only, load == "startup" ? "startup" : std::string{load} + 's');
    }
    [[nodiscard]] Configured<void> services(SamplingMode mode);
    [[nodiscard]] Configured<void> service(SevenClient& client, SamplingMode mode,
                                           const ServiceFigures& figures);
    [[nodiscard]] Configured<void> startups(SamplingMode mode);

    const SevenOptions& options_;
    std::vector<SevenRow> rows_;
};

Configured<void> SevenRun::services(SamplingMode mode)
{
    std::unique_ptr<MappedPlant> plant;
    std::optional<SevenClient> client;
    for (const ServiceFigures& figures : service_figures) {
        if (figures.mode != mode_name(mode) || !wants_load(figures.load)) {
            continue;
        }
        if (plant == nullptr) {
            auto started = MappedPlant::start(served(options_), mode);
            if (!started) {
                return Unexpected{std::move(started).error()};
            }
            plant = *std::move(started);
            client.emplace();
            if (const auto opened = client->open(plant->url()); !opened) {
                return misconfigured("client", "cannot connect", opened.error());
            }
        }
        if (auto done = service(*client, mode, figures); !done) {
            return done;
        }
    }
    return {};
}

Configured<void> SevenRun::service(SevenClient& client, SamplingMode mode,
                                   const ServiceFigures& figures)
{
    for (const auto& [variables, manual_ms] : figures.columns) {
        if (variables == 0 || variables > options_.most) {
            continue;
        }
        SevenRow row;
        row.load = figures.load;
        row.mode = mode;
        row.variables = variables;
        row.objects = served(options_).objects;
        row.rounds = options_.rounds;
        row.manual_ms = manual_ms > 0 ? std::optional{manual_ms} : std::nullopt;
        const auto measured =
            client.measure_ms(figures.load, mapped_namespace, variables, options_.rounds);
        const auto floor =
            measured ? client.measure_ms(figures.load, plain_namespace, variables, options_.rounds)
                     : measured;
        if (!floor) {
            return misconfigured(row.load + ' ' + std::to_string(variables),
                                 measured ? "failed without model mode" : "failed", floor.error());
        }
        row.measured_ms = *measured;
        row.floor_ms = *floor;
        rows_.push_back(std::move(row));
    }
    return {};
}

Configured<void> SevenRun::startups(SamplingMode mode)
{
    for (const StartupFigures& figures : startup_figures) {
        const MappedModel model{.objects = figures.objects,
                                .variables = figures.variables,
                                .files = figures.files,
                                .is_mapped = figures.is_mapped};
        if (!wants_load("startup") || model.variable_count() > options_.most) {
            continue;
        }
        SevenRow row;
        row.load = "startup";
        row.mode = mode;
        row.variables = model.variable_count();
        row.objects = model.objects;
        row.files = model.files;
        row.is_mapped = model.is_mapped;
        row.rounds = std::min(options_.rounds, startup_rounds);
        row.manual_ms = figures.seconds.at(static_cast<std::size_t>(mode)) * 1e3;
        const auto started = measure_mapped_startup(model, mode, row.rounds);
        if (!started) {
            return Unexpected{started.error()};
        }
        row.measured_ms = started->mapped_ms;
        row.floor_ms = started->plain_ms;
        rows_.push_back(std::move(row));
    }
    return {};
}

} // namespace

std::string_view mode_name(SamplingMode mode)
{
    constexpr std::array<std::string_view, 3> names{"standard", "items", "all"};
    return names.at(static_cast<std::size_t>(mode));
}

Configured<std::vector<SevenRow>> measure_appendix7(const SevenOptions& options)
{
    return SevenRun{options}.run();
}

} // namespace busbar::bench
