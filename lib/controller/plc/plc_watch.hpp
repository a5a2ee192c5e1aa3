#pragma once

#include "plc_target.hpp"

namespace busbar::controller::detail {

/// Waits for one event to happen.
class PlcWatch {
public:
    /// True if a variable of this type can be watched.
    [[nodiscard]] static bool accepts(BuiltInType type);

    /// Of a type that is accepted; its first element.
    PlcWatch(const PlcTarget& variable, double limit);

    /// To be asked once in each scan. What was so when the PLC started does not happen.
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
