#include "machine_retained.hpp"

#include <string>

#include <busbar/core/status_codes.hpp>

namespace busbar::product {

void MachineRetained::keep(const MachineProgram& program)
{
    const std::lock_guard lock{mutex_};
    controller::RetainedOptions options;
    options.interval = interval_;
    values_.emplace(storage_, program.types(), program.image(), options);
    const controller::RetainedRestore restored = values_->restore();
    for (const Problem& problem : restored.problems) {
        log_.write(LogLevel::Warning, "controller", text(problem));
    }
    if (restored.restored > 0) {
        log_.write(LogLevel::Info, "controller",
                   std::to_string(restored.restored) + " RETAIN variables have the values that "
                                                       "were kept");
    }
}

void MachineRetained::stop()
{
    const std::lock_guard lock{mutex_};
    values_.reset();
}

void MachineRetained::keep(const controller::ProgramAddition& added)
{
    const std::lock_guard lock{mutex_};
    if (!values_) {
        return;
    }
    values_->drop_others(added.types->program());
    values_->add(*added.types, added.image);
    for (const controller::ProgramImageAddition& each : added.retained) {
        values_->add(*added.types, each);
    }
    // Otherwise a variable that was deleted and returns would get its old value after a crash.
    static_cast<void>(told(values_->save()));
}

Stored<void> MachineRetained::save()
{
    const std::lock_guard lock{mutex_};
    return values_ ? told(values_->save()) : Stored<void>{};
}

bool MachineRetained::save_when_due(TimePoint now)
{
    const std::lock_guard lock{mutex_};
    if (!values_) {
        return true;
    }
    if (is_told_) {
        return told(values_->save()).has_value();
    }
    if (values_->next_deadline() > now) {
        return told(values_->sync()).has_value();
    }
    return told(values_->handle_deadline(now)).has_value();
}

/// False for a program that was replaced: its last scan was saved then.
bool MachineRetained::keeps(const server::ProcessImage& image, std::uint32_t handle) const
{
    return values_ && values_->is_of(image) && values_->keeps(handle);
}

StatusCode MachineRetained::keep(const server::ProcessImage&,
                                 std::span<const server::ImageWrite> writes)
{
    return values_->keep(writes) ? status::Good : status::Bad_ResourceUnavailable;
}

Stored<void> MachineRetained::told(Stored<void> saved)
{
    if (saved) {
        is_told_ = false;
    } else if (!is_told_) {
        is_told_ = true;
        log_.write(LogLevel::Error, "controller",
                   "values of RETAIN variables cannot be saved: " +
                       std::string{text(saved.error())});
    }
    return saved;
}

} // namespace busbar::product
