#include <busbar/core/deadband.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

namespace busbar {

namespace {

template <typename T>
bool differs(T a, T b, double deadband)
{
    if constexpr (std::is_floating_point_v<T>) {
        const double distance = std::abs(static_cast<double>(a) - static_cast<double>(b));
        // NaN is infinitely far from any number, and not from itself.
        return std::isnan(distance) ? !(a == b || (std::isnan(a) && std::isnan(b)))
                                    : distance > deadband;
    } else {
        const auto wide = [](T value) { return static_cast<std::uint64_t>(value); };
        return static_cast<double>(a > b ? wide(a) - wide(b) : wide(b) - wide(a)) > deadband;
    }
}

template <typename T>
std::optional<bool> differs_as(const Variant& a, const Variant& b, double deadband)
{
    if (const T* x = a.get_if<T>()) {
        const T* y = b.get_if<T>();
        return y == nullptr || differs(*x, *y, deadband);
    }
    const Array<T>* x = a.array_if<T>();
    if (x == nullptr) {
        return std::nullopt;
    }
    const Array<T>* y = b.array_if<T>();
    return y == nullptr || x->size() != y->size() ||
           !std::equal(x->begin(), x->end(), y->begin(),
                       [&](T p, T q) { return !differs(p, q, deadband); });
}

} // namespace

bool is_past_deadband(const Variant& last, const Variant& value, double deadband)
{
    std::optional<bool> result;
    // clang-format off
    switch (last.type()) {
    case BuiltInType::SByte: result = differs_as<std::int8_t>(last, value, deadband); break;
    case BuiltInType::Byte: result = differs_as<std::uint8_t>(last, value, deadband); break;
    case BuiltInType::Int16: result = differs_as<std::int16_t>(last, value, deadband); break;
    case BuiltInType::UInt16: result = differs_as<std::uint16_t>(last, value, deadband); break;
    case BuiltInType::Int32: result = differs_as<std::int32_t>(last, value, deadband); break;
    case BuiltInType::UInt32: result = differs_as<std::uint32_t>(last, value, deadband); break;
    case BuiltInType::Int64: result = differs_as<std::int64_t>(last, value, deadband); break;
    case BuiltInType::UInt64: result = differs_as<std::uint64_t>(last, value, deadband); break;
    case BuiltInType::Float: result = differs_as<float>(last, value, deadband); break;
    case BuiltInType::Double: result = differs_as<double>(last, value, deadband); break;
    default: break;
    }
    // clang-format on
    return result.value_or(!(last == value));
}

} // namespace busbar
