#pragma once

#include "plc_target.hpp"

namespace busbar::controller::detail {

/// Waits for one event to happen.
class PlcWatch {
public:
    /// True if a variable of this type can be watched.
    [[nodiscard]] static bool accepts(BuiltInType type);

    /// Watches the first element of the variable, whose type must be accepted.
    PlcWatch(const PlcTarget& variable, double limit);

    /// True if the event occurs; call it once in each scan. A condition that was already true when
    /// the PLC started is not an event.
    [[nodiscard]] bool occurs();

private:
    using IsAbove = bool (*)(const PlcWatch&);

    template <typename T>
    static bool is_above(const PlcWatch& watch);
    static bool is_true(const PlcWatch& watch);
    [[nodiscard]] static IsAbove choose(BuiltInType type);

    IsAbove is_above_;
    PlcTarget variable_;
    double limit_;
    bool was_above_{true};
};

} // namespace busbar::controller::detail
