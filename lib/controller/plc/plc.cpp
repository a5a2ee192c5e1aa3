#include <busbar/controller/plc.hpp>

#include <algorithm>

#include <busbar/controller/opcua_shutdown.hpp>

#include "plc_builder.hpp"
#include "plc_step.hpp"

namespace busbar::controller {

Plc::Plc() : instructions_{std::make_unique<InstructionDesk>()} {}
Plc::~Plc() = default;

Configured<std::unique_ptr<Plc>> Plc::create(const PlcConfig& config, server::ImageOptions options)
{
    return PlcBuilder{config}.build(options);
}

Configured<std::unique_ptr<Plc>> Plc::create(const PlcConfig& config, const ProgramTypes& types,
                                             const ProgramImage& image)
{
    return PlcBuilder{config}.build(types, image);
}

void Plc::scan(DateTime now, Duration elapsed)
{
    image_->begin_scan();
    if (logic_ != nullptr) {
        logic_->scan(now, elapsed);
    } else {
        run_programs(elapsed);
    }
    occurrences_.clear();
    for (std::uint32_t i = 0; i < watches_.size(); ++i) {
        if (watches_[i].occurs()) {
            occurrences_.push_back(i);
        }
    }
    image_->publish(now);
}

void Plc::run_programs(Duration elapsed)
{
    const bool is_reset = is_reset_requested_.exchange(false);
    const bool restored_profile = instructions_->restores_security_profile();
    restores_profile_ = restored_profile;
    for (detail::PlcStep& step : steps_) {
        if (is_reset && step.is_counter()) {
            step.reset();
        } else {
            step.run(elapsed);
        }
    }
    if (restores_profile_ != restored_profile) {
        instructions_->set_restores_security_profile(restores_profile_);
    }
}

std::size_t Plc::counter_count() const
{
    return static_cast<std::size_t>(std::ranges::count_if(steps_, &detail::PlcStep::is_counter));
}

std::optional<std::uint32_t> Plc::find(std::string_view name) const
{
    const auto name_at = [this](std::uint32_t handle) {
        return std::string_view{variables_[handle].name};
    };
    const auto found = std::ranges::lower_bound(by_name_, name, {}, name_at);
    return found != by_name_.end() && name_at(*found) == name ? std::optional{*found}
                                                              : std::nullopt;
}

} // namespace busbar::controller
