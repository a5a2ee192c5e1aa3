#include "plc_watch.hpp"

#include <utility>

#include "plc_target.hpp"

namespace busbar::controller::detail {

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
