#include "sections.hpp"

#include <string_view>
#include <utility>
#include <vector>

#include "limit_keys.hpp"
#include "product/machine/program_file.hpp"

namespace busbar::product {

std::unique_ptr<controller::SimulatedLabels> make_labels(const LabelConfig& config)
{
    controller::Program program =
        config.program != nullptr ? *config.program : controller::Program{};
    return expect(controller::SimulatedLabels::create(std::move(program), config.options)
                      .transform_error([&](Problem problem) {
                          return in_file(std::move(problem), config.program_file,
                                         config.program != nullptr ? *config.program
                                                                   : controller::Program{});
                      }));
}

namespace {

/// Reads the PLC on the network that has the labels.
void read_field(const TomlTable& table, LabelConfig& labels)
{
    if (table.text("backend") != "slmp") {
        table.fail("backend", "\"slmp\"");
    }
    if (!labels.program_file.empty()) {
        table.refuse("program", "found a program besides a backend, expected one of them: the PLC "
                                "has the labels");
    }
    labels.field = std::make_shared<const backend::SlmpLabelsOptions>(read_slmp_labels(table));
    labels.field_text = keys_text(table, slmp_labels_keys());
}

} // namespace

void read_labels(const TomlTable& table, ControllerConfig& config)
{
    constexpr std::int64_t most_minutes{std::int64_t{24} * 60};
    std::vector<std::string_view> keys{"program",          "access_unit",    "waiting",
                                       "sampling",         "sampled_points", "utc_offset_minutes",
                                       "isolate_failures", "call_limit_ms",  "strict",
                                       "encoding",         "backend"};
    if (table.has("backend")) {
        const auto more = slmp_labels_keys();
        keys.insert(keys.end(), more.begin(), more.end());
    }
    table.allow(keys);
    LabelConfig& labels = config.labels;
    labels.program_file = read_program_path(table, "program");
    auto& options = labels.options;
    read_numbers(table, "labels", config);
    options.can_sample = table.flag("sampling", options.can_sample);
    labels.reading = read_reading(table);
    options.unserved = labels.reading.unserved;
    labels.may_leave_out_more =
        table.has("strict") && options.unserved == controller::Unserved::LeaveOut;
    labels.isolates_failures = table.flag("isolate_failures", false);
    if (table.has("utc_offset_minutes")) {
        labels.utc_offset = static_cast<std::int32_t>(
            table.integer("utc_offset_minutes", 0, -most_minutes, most_minutes));
    }
    if (table.has("backend")) {
        read_field(table, labels);
    }
    if (labels.program_file.empty()) {
        return;
    }
    if (config.machine.program != nullptr) {
        table.refuse("program", "found a program of labels besides that of [machine], expected one "
                                "of them");
    }
    auto file = read_labels_program(table, "program");
    labels.program_text = std::move(file.text);
    labels.program = std::move(file.program);
}

} // namespace busbar::product
