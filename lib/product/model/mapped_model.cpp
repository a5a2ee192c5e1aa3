#include "mapped_model.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include <busbar/controller/mapped_nodes.hpp>
#include <busbar/core/text_forms.hpp>

#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

using controller::LabelUpdate;
using controller::MappedErrorCode;
using controller::SamplingMode;

constexpr const char* label_source = "labels";
/// Maximum number of lines about errors in one period.
constexpr std::size_t most_errors = 20;

std::string four_digits(MappedErrorCode code)
{
    std::array<char, 8> text{};
    std::snprintf(text.data(), text.size(), "%04X", static_cast<unsigned>(code));
    return text.data();
}

const char* text_of(MappedErrorCode code)
{
    switch (code) {
    case MappedErrorCode::Unavailable:
        return "there is no such label that can be used";
    case MappedErrorCode::WrongType:
        return "the label's type does not suit the node";
    case MappedErrorCode::OutOfRange:
        return "the label's value does not suit the node";
    case MappedErrorCode::TooManyPoints:
        return "there are too many points to sample in each scan";
    case MappedErrorCode::UnsampledDevice:
        return "the label lies where it cannot be sampled in each scan";
    case MappedErrorCode::SamplingUnsupported:
        return "the PLC cannot sample in each scan";
    }
    return "?";
}

SamplingMode mode_of(controller::ProjectSampling sampling)
{
    switch (sampling) {
    case controller::ProjectSampling::HighSpeedItems:
        return SamplingMode::MonitoredItems;
    case controller::ProjectSampling::HighSpeedVariables:
        return SamplingMode::AllVariables;
    case controller::ProjectSampling::Standard:
        break;
    }
    return SamplingMode::Standard;
}

bool has_ceilings(const controller::Project& project)
{
    return project.preset == "rd81opc96";
}

controller::MappedOptions options_of(const MappedModel::Needs& needs)
{
    controller::MappedOptions options;
    options.sampling = mode_of(needs.project.sampling);
    if (has_ceilings(needs.project)) {
        options.limits = controller::MappedLimits::rd81opc96();
    }
    options.conversion.utc_offset_minutes = needs.utc_offset_minutes;
    options.isolates_failures = needs.isolates_failures;
    options.call_limit = needs.call_limit;
    // The source's own timeout ends a Call that waits for longer.
    options.timeout = std::max(options.timeout, needs.call_limit + std::chrono::seconds{1});
    return options;
}

} // namespace

void LabelLog::label_update(LabelUpdate event)
{
    const std::string code = "event " + std::to_string(static_cast<unsigned>(event)) + ": ";
    last_.event_code = static_cast<std::uint16_t>(event);
    last_.event_time = clock_.now();
    switch (event) {
    case LabelUpdate::Started:
        begin_period(clock_.now());
        log_.write(LogLevel::Info, label_source,
                   code + "addresses and types of labels are asked for");
        break;
    case LabelUpdate::Finished:
        log_.write(LogLevel::Info, label_source, code + "addresses and types of labels are known");
        break;
    case LabelUpdate::Failed:
        log_.write(LogLevel::Error, label_source,
                   code + "labels cannot be used, nor can mapped nodes");
        break;
    }
}

void LabelLog::begin_period(DateTime now)
{
    if (untold_ != 0) {
        log_.write(LogLevel::Error, label_source,
                   std::to_string(untold_) + " more errors of labels were not told in the minute "
                                             "before");
    }
    begin_ = now;
    told_.clear();
    untold_ = 0;
}

void LabelLog::error(const controller::MappedError& error)
{
    constexpr std::int64_t minute = 600'000'000; // in 100 ns
    const DateTime now = clock_.now();
    if (now.ticks < begin_.ticks || now.ticks - begin_.ticks >= minute) {
        begin_period(now);
    }
    std::string line = "error " + four_digits(error.code) + "H: " + text_of(error.code);
    if (!error.label.empty()) {
        line += ": " + std::string{error.label};
    }
    if (error.node != nullptr) {
        line += " of " + to_string(*error.node);
    }
    last_.error_code = static_cast<std::uint16_t>(error.code);
    last_.error = line;
    last_.error_time = now;
    ++last_.error_count;
    if (told_.size() == most_errors || !told_.insert(line).second) {
        ++untold_;
        return;
    }
    if (told_.size() == most_errors) {
        line += "; more are only counted for a minute";
    }
    log_.write(LogLevel::Error, label_source, line);
}

namespace {

struct LastValue {
    const char* name;
    Variant (*value)(const LabelLog::Last&);
};

/// Its index is the handle.
constexpr std::array last_values{
    LastValue{"LastErrorCode", [](const LabelLog::Last& last) { return Variant{last.error_code}; }},
    LastValue{"LastError", [](const LabelLog::Last& last) { return Variant{String{last.error}}; }},
    LastValue{"LastErrorTime", [](const LabelLog::Last& last) { return Variant{last.error_time}; }},
    LastValue{"ErrorCount", [](const LabelLog::Last& last) { return Variant{last.error_count}; }},
    LastValue{"LastEventCode", [](const LabelLog::Last& last) { return Variant{last.event_code}; }},
    LastValue{"LastEventTime", [](const LabelLog::Last& last) { return Variant{last.event_time}; }},
};

} // namespace

void LabelLogNodes::read(server::ReadBatch batch)
{
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const std::uint64_t handle = batch.items()[i].handle;
        if (handle < last_values.size()) {
            batch.results()[i] =
                DataValue{last_values[handle].value(log_.last()), status::Good, clock_.now()};
        }
    }
    batch.complete();
}

void LabelLogNodes::add_to(model::AddressSpace& space, model::NodeIndex parent) const
{
    for (std::size_t i = 0; i < last_values.size(); ++i) {
        const Variant like = last_values[i].value(LabelLog::Last{.error = "-"});
        static_cast<void>(
            expect(space.add_variable(parent, {1, last_values[i].name}, variable(i, like)),
                   "the module's last errors"));
    }
}

MappedModel::MappedModel(const Needs& needs)
    : events_{needs.log, needs.clock}, source_{needs.labels, options_of(needs), &events_},
      status_{source_, needs.server, needs.clock}, last_{events_, needs.clock}
{
    server::Server& server = needs.server;
    model::AddressSpace& space = server.address_space();
    server.add_source(source_);
    server.add_source(status_);
    server.add_source(last_);
    source_.set_space(&space);
    const controller::ShapeLimits limits = has_ceilings(needs.project)
                                               ? controller::ShapeLimits::rd81opc96()
                                               : controller::ShapeLimits{};
    const auto mapped =
        controller::map_nodes(space, types_.of(space), needs.mapping, source_, limits);
    if (has_ceilings(needs.project)) {
        controller::refuse_unsupported(space, types_.of(space), source_, limits);
    }
    expect(controller::add_module_status_nodes(space, needs.module, 1, status_),
           "the module's buffer memory");
    last_.add_to(space, needs.module);
    variables_ = mapped.variables;
    for (const std::string& reason : mapped.left_out) {
        needs.log.write(LogLevel::Warning, label_source, "left out of the mapping: " + reason);
    }
    needs.log.write(LogLevel::Info, label_source,
                    std::to_string(mapped.variables) + " Variables and " +
                        std::to_string(mapped.methods) + " Methods are mapped to labels");
}

} // namespace busbar::product
