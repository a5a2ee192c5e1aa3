#include "plc_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include <busbar/controller/machine_event_log.hpp>

#include "plc_target.hpp"

namespace busbar::controller::detail {

namespace {

/// Converts to the nearest value of T, limited to the range of integers.
template <typename T>
T nearest(double value)
{
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else {
        // Converted to double, the upper limit may lie one above the type's own; `>=` excludes it.
        constexpr auto lowest = static_cast<double>(std::numeric_limits<T>::min());
        constexpr auto highest = static_cast<double>(std::numeric_limits<T>::max());
        const double rounded = std::round(value);
        if (rounded >= highest) {
            return std::numeric_limits<T>::max();
        }
        return rounded <= lowest ? std::numeric_limits<T>::min() : static_cast<T>(rounded);
    }
}

template <typename T>
void set_all(const PlcTarget& target, double value)
{
    std::ranges::fill(target.values<T>(), nearest<T>(value));
}

} // namespace

bool PlcStep::may_set(PlcProgramKind kind)
{
    return kind == PlcProgramKind::Acknowledge || kind == PlcProgramKind::Shutdown ||
           kind == PlcProgramKind::PlcError;
}

bool PlcStep::accepts(PlcProgramKind kind, BuiltInType type)
{
    return choose(kind, type) != nullptr;
}

PlcStep::Run PlcStep::choose(PlcProgramKind kind, BuiltInType type)
{
    switch (kind) {
    case PlcProgramKind::Increment:
        return visit_number(
            type, [](auto tag) -> Run { return &increment<typename decltype(tag)::type>; });
    case PlcProgramKind::Sine:
        return visit_number(type,
                            [](auto tag) -> Run { return &sine<typename decltype(tag)::type>; });
    case PlcProgramKind::Toggle:
        return type == BuiltInType::Boolean ? &toggle : nullptr;
    case PlcProgramKind::Copy:
        return &copy;
    case PlcProgramKind::Shutdown:
        return type == BuiltInType::Boolean ? &shut_down : nullptr;
    case PlcProgramKind::PlcError:
        return visit_number(type, [](auto) -> Run { return &get_plc_error; });
    case PlcProgramKind::Acknowledge:
        return visit_number(type, [](auto tag) -> Run {
            using T = typename decltype(tag)::type;
            if constexpr (std::is_integral_v<T>) {
                return &acknowledge<T>;
            } else {
                return nullptr;
            }
        });
    }
    return nullptr;
}

PlcStep::PlcStep(const PlcProgram& program, const PlcTarget& target, const PlcTarget& source)
    : run_{choose(program.kind, target.type)}, is_counter_{program.kind ==
                                                           PlcProgramKind::Increment},
      target_{target}, source_{source}, period_{program.period},
      amplitude_{program.amplitude}, offset_{program.offset}, to_{program.to}
{
    const auto setter = [](BuiltInType type) {
        return visit_number(type,
                            [](auto tag) -> Set { return &set_all<typename decltype(tag)::type>; });
    };
    if (may_set(program.kind)) {
        set_ = setter(source.type);
    }
    if (program.kind == PlcProgramKind::PlcError) {
        answer_ = setter(target.type);
    }
}

void PlcStep::reset()
{
    std::ranges::fill(target_.all(), std::byte{});
}

std::uint64_t PlcStep::firings(Duration elapsed)
{
    if (period_ <= Duration::zero()) {
        return 1;
    }
    since_ += std::max(elapsed, Duration::zero());
    const auto count = static_cast<std::uint64_t>(since_ / period_);
    since_ %= period_;
    return count;
}

template <typename T>
void PlcStep::increment(PlcStep& step, Duration elapsed)
{
    const std::uint64_t count = step.firings(elapsed);
    for (T& value : step.target_.values<T>()) {
        if constexpr (std::is_floating_point_v<T>) {
            value += static_cast<T>(step.amplitude_ * static_cast<double>(count));
        } else {
            const auto sum =
                static_cast<std::uint64_t>(value) +
                static_cast<std::uint64_t>(nearest<std::int64_t>(step.amplitude_)) * count;
            value = static_cast<T>(sum);
        }
    }
}

template <typename T>
void PlcStep::sine(PlcStep& step, Duration elapsed)
{
    static_cast<void>(step.firings(elapsed));
    const auto values = step.target_.values<T>();
    const double position =
        static_cast<double>(step.since_.count()) / static_cast<double>(step.period_.count());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double shift = static_cast<double>(i) / static_cast<double>(values.size());
        const double angle = 2 * std::numbers::pi * (position + shift);
        values[i] = nearest<T>(step.offset_ + step.amplitude_ * std::sin(angle));
    }
}

void PlcStep::toggle(PlcStep& step, Duration elapsed)
{
    if (step.firings(elapsed) % 2 == 1) {
        for (bool& value : step.target_.values<bool>()) {
            value = !value;
        }
    }
}

template <typename T>
void PlcStep::acknowledge(PlcStep& step, Duration elapsed)
{
    if (step.firings(elapsed) == 0) {
        return;
    }
    for (T& value : step.target_.values<T>()) {
        if ((value & T{1}) != 0) {
            value = static_cast<T>(value & ~T{1});
            if (step.set_ != nullptr) {
                step.set_(step.source_, step.to_);
            }
        }
    }
}

void PlcStep::shut_down(PlcStep& step, Duration)
{
    OpcuaShutdown& instruction = *step.shutdown_;
    instruction(std::ranges::count(step.target_.values<bool>(), true) != 0);
    if (step.set_ != nullptr) {
        constexpr double busy = 1;
        constexpr double done = 2;
        step.set_(step.source_, instruction.busy()   ? busy
                                : instruction.done() ? done
                                                     : instruction.error_id());
    }
}

void PlcStep::get_plc_error(PlcStep& step, Duration elapsed)
{
    if (step.firings(elapsed) == 0) {
        return;
    }
    const auto error = step.desk_->plc_error();
    step.answer_(step.target_, error ? error->code : 0);
    if (step.set_ != nullptr) {
        constexpr double partial_fault = 2;
        constexpr double minor_fault = 3;
        step.set_(step.source_, !error                                     ? 0
                                : error->level == EventLevel::PartialFault ? partial_fault
                                                                           : minor_fault);
    }
}

void PlcStep::copy(PlcStep& step, Duration elapsed)
{
    if (step.firings(elapsed) == 0) {
        return;
    }
    // Old bytes may follow a text; readers ignore them.
    for (std::size_t i = 0; i < step.target_.elements; ++i) {
        std::memmove(step.target_.bytes + i * step.target_.stride,
                     step.source_.bytes + i * step.source_.stride, step.source_.stride);
    }
}

bool PlcWatch::accepts(BuiltInType type)
{
    return choose(type) != nullptr;
}

PlcWatch::IsAbove PlcWatch::choose(BuiltInType type)
{
    if (type == BuiltInType::Boolean) {
        return &is_true;
    }
    return visit_number(
        type, [](auto tag) -> IsAbove { return &is_above<typename decltype(tag)::type>; });
}

PlcWatch::PlcWatch(const PlcTarget& variable, double limit)
    : is_above_{choose(variable.type)}, variable_{variable}, limit_{limit}
{
}

bool PlcWatch::occurs()
{
    const bool is = is_above_(*this);
    return !std::exchange(was_above_, is) && is;
}

template <typename T>
bool PlcWatch::is_above(const PlcWatch& watch)
{
    return static_cast<double>(watch.variable_.values<T>().front()) > watch.limit_;
}

bool PlcWatch::is_true(const PlcWatch& watch)
{
    return watch.variable_.values<bool>().front();
}

} // namespace busbar::controller::detail
