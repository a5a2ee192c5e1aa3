#include "label_plant.hpp"

#include <utility>

#include "product/configuration/sections.hpp"
#include "product/machine/program_change.hpp"
#include "product/machine/program_file.hpp"

namespace busbar::product {

namespace {

bool is_same(const std::shared_ptr<const std::string>& one,
             const std::shared_ptr<const std::string>& other)
{
    return one == other || (one != nullptr && other != nullptr && *one == *other);
}

} // namespace

LabelPlant::LabelPlant(const ControllerConfig& config, const WallClock& clock,
                       controller::ThreadMaker& threads)
    : clock_{clock}, labels_{make_labels(config.labels)}, program_text_{config.labels.program_text}
{
    plcs_.push_back(make_plc(config));
    current_ = plcs_.front().get();
    task_.emplace(*current_, clock, config.scan, config.realtime_priority, &threads);
    task_->after_scan([this](DateTime time) { end_of_scan(time); });
}

std::unique_ptr<controller::Plc> LabelPlant::make_plc(const ControllerConfig& config) const
{
    const auto program = labels_->program();
    // A program of [plc] without labels belongs to another PLC.
    return expect(controller::Plc::create(
        config.labels.program != nullptr ? config.plc : controller::PlcConfig{}, program->types(),
        program->image()));
}

void LabelPlant::stop()
{
    task_->stop();
    labels_->halt(clock_.now());
}

std::function<std::shared_ptr<const backend::LabelBackend>()>
LabelPlant::labels_with(const ControllerConfig& next) const
{
    if (!is_other(next)) {
        return [labels = labels_] { return labels; };
    }
    return [config = next.labels]() -> std::shared_ptr<const backend::LabelBackend> {
        return make_labels(config);
    };
}

void LabelPlant::tell_left_out(LogSink& log, const std::string& file) const
{
    product::tell_left_out(log, left_out_texts(labels_->program()->types().program(), file), file);
}

std::shared_ptr<const std::string> LabelPlant::program_text() const
{
    const std::lock_guard lock{mutex_};
    return program_text_;
}

Configured<void> LabelPlant::check_left_out(const LabelConfig& next) const
{
    if (next.program == nullptr || next.may_leave_out_more ||
        is_same(next.program_text, program_text())) {
        return {};
    }
    return product::check_left_out(labels_->program()->types().program(), *next.program,
                                   next.program_file);
}

bool LabelPlant::is_other(const ControllerConfig& next) const
{
    return !is_same(next.labels.program_text, program_text());
}

void LabelPlant::download(const ControllerConfig& next)
{
    controller::Program program =
        next.labels.program != nullptr ? *next.labels.program : controller::Program{};
    expect(labels_->replace_program(std::move(program)));
    auto plc = make_plc(next);
    const std::lock_guard lock{mutex_};
    std::erase_if(plcs_, [this](const auto& one) { return one.get() != current_; });
    plcs_.push_back(std::move(plc));
    program_text_ = next.labels.program_text;
}

void LabelPlant::end_of_scan(DateTime time)
{
    labels_->end_of_scan(time);
    const std::unique_lock lock{mutex_, std::try_to_lock};
    if (!lock || plcs_.back().get() == current_) {
        return;
    }
    controller::Plc& next = *plcs_.back();
    if (&next.image()->memory() == &labels_->memory()) {
        current_ = &next;
        task_->replace(next);
    }
}

} // namespace busbar::product
