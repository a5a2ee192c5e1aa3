#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <busbar/binary/wire_order.hpp>

#include "controller/conversion/conversion_functions.hpp"

namespace busbar::controller {

using backend::LabelType;

bool is_quality_label(LabelType type)
{
    return type <= LabelType::DoubleWord; // a Bit, and words
}

bool is_scalable(LeafType leaf)
{
    return !leaf.is_enumeration && leaf.built_in >= BuiltInType::SByte &&
           leaf.built_in <= BuiltInType::Double;
}

bool is_scalable(LabelType type, backend::TimerPart part)
{
    const LabelType value = backend::value_type(type, part);
    return value >= LabelType::UnsignedWord && value <= LabelType::Double;
}

namespace detail {

namespace {

/// Converts a number to another type, rounding for integers. Bad_OutOfRange if it does not fit.
template <typename T>
StatusCode fit(double number, T& to)
{
    if constexpr (std::is_integral_v<T>) {
        // Compare as doubles: the upper end of 64 bits becomes a double that the type cannot hold.
        constexpr double low = static_cast<double>(std::numeric_limits<T>::min());
        const double above = std::ldexp(1.0, std::numeric_limits<T>::digits);
        const double rounded = std::round(number);
        if (!(rounded >= low && rounded < above)) {
            return status::Bad_OutOfRange;
        }
        to = static_cast<T>(rounded);
        return status::Good;
    } else {
        constexpr double most = static_cast<double>(std::numeric_limits<T>::max());
        if (!(std::abs(number) <= most)) {
            return status::Bad_OutOfRange;
        }
        to = static_cast<T>(number);
        return status::Good;
    }
}

/// `T` is the type of the value, `L` that of the label.
template <typename T, typename L>
struct Scaled {
    static StatusCode read(const LabelConversion& conversion, const std::byte* label, void* value)
    {
        L raw{};
        binary::detail::copy_number<sizeof(L)>(&raw, label);
        return fit(conversion.offset() + conversion.factor() * static_cast<double>(raw),
                   *static_cast<T*>(value));
    }
    static StatusCode write(const LabelConversion& conversion, const void* value, std::byte* label)
    {
        const auto number = static_cast<double>(*static_cast<const T*>(value));
        L raw{};
        const StatusCode status = fit((number - conversion.offset()) / conversion.factor(), raw);
        binary::detail::copy_number<sizeof(L)>(label, &raw);
        return status;
    }
};

template <typename T>
LabelConversion::Functions of_label(LabelType label)
{
    const auto functions = [](auto conversion) -> LabelConversion::Functions {
        return {decltype(conversion)::read, decltype(conversion)::write};
    };
    switch (label) {
    case LabelType::UnsignedWord:
        return functions(Scaled<T, std::uint16_t>{});
    case LabelType::UnsignedDoubleWord:
        return functions(Scaled<T, std::uint32_t>{});
    case LabelType::Word:
        return functions(Scaled<T, std::int16_t>{});
    case LabelType::Float:
        return functions(Scaled<T, float>{});
    case LabelType::Double:
        return functions(Scaled<T, double>{});
    default:
        return functions(Scaled<T, std::int32_t>{});
    }
}

} // namespace

LabelConversion::Functions scaled_functions(BuiltInType leaf, LabelType label)
{
    switch (leaf) {
    case BuiltInType::SByte:
        return of_label<std::int8_t>(label);
    case BuiltInType::Byte:
        return of_label<std::uint8_t>(label);
    case BuiltInType::Int16:
        return of_label<std::int16_t>(label);
    case BuiltInType::UInt16:
        return of_label<std::uint16_t>(label);
    case BuiltInType::Int32:
        return of_label<std::int32_t>(label);
    case BuiltInType::UInt32:
        return of_label<std::uint32_t>(label);
    case BuiltInType::Int64:
        return of_label<std::int64_t>(label);
    case BuiltInType::UInt64:
        return of_label<std::uint64_t>(label);
    case BuiltInType::Float:
        return of_label<float>(label);
    default:
        return of_label<double>(label);
    }
}

} // namespace detail

} // namespace busbar::controller
