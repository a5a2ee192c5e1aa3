#include <cmath>
#include <limits>
#include <utility>

#include <busbar/backend/device_source.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar::backend {

namespace {

/// The number in a Variant of a numeric type; nothing for others.
std::optional<double> number_of(const Variant& value)
{
    std::optional<double> number;
    const auto take = [&]<typename T>(const T* held) {
        if (held != nullptr) {
            number = static_cast<double>(*held);
        }
    };
    take(value.get_if<std::int16_t>());
    take(value.get_if<std::uint16_t>());
    take(value.get_if<std::int32_t>());
    take(value.get_if<std::uint32_t>());
    take(value.get_if<std::int64_t>());
    take(value.get_if<std::uint64_t>());
    take(value.get_if<float>());
    take(value.get_if<double>());
    return number;
}

/// The whole number next to `number`, if T has it.
template <typename T>
Result<Variant> whole(double number)
{
    const double rounded = std::nearbyint(number);
    // One past the last one is a power of two, which a Double has exactly.
    const double end = std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (!(rounded >= static_cast<double>(std::numeric_limits<T>::min()) && rounded < end)) {
        return fail(status::Bad_OutOfRange);
    }
    return Variant{static_cast<T>(rounded)};
}

Result<Variant> variant_of(double number, BuiltInType type)
{
    switch (type) {
    case BuiltInType::Int16:
        return whole<std::int16_t>(number);
    case BuiltInType::UInt16:
        return whole<std::uint16_t>(number);
    case BuiltInType::Int32:
        return whole<std::int32_t>(number);
    case BuiltInType::UInt32:
        return whole<std::uint32_t>(number);
    case BuiltInType::Int64:
        return whole<std::int64_t>(number);
    case BuiltInType::UInt64:
        return whole<std::uint64_t>(number);
    case BuiltInType::Float:
        return Variant{static_cast<float>(number)};
    case BuiltInType::Double:
        return Variant{number};
    default:
        return fail(status::Bad_TypeMismatch);
    }
}

} // namespace

BuiltInType data_type_of(const DevicePoint& point)
{
    return point.scale ? BuiltInType::Double : data_type_of(point.type.type);
}

Result<Variant> read_point(const DevicePoint& point, std::span<const std::uint16_t> words)
{
    if (point.bit && words.size() == 1) {
        return Variant{(unsigned{words.front()} >> *point.bit & 1U) != 0};
    }
    auto value = read_modbus(point.type, words);
    if (!value || !point.scale) {
        return value;
    }
    const auto raw = number_of(*value);
    if (!raw) {
        return fail(status::Bad_TypeMismatch);
    }
    const DeviceScale& scale = *point.scale;
    return Variant{scale.low + (*raw - scale.raw_low) * (scale.high - scale.low) /
                                   (scale.raw_high - scale.raw_low)};
}

Result<std::uint16_t> write_point(const DevicePoint& point, const Variant& value,
                                  std::span<std::uint16_t> words)
{
    constexpr std::uint16_t whole_word = 0xFFFF;
    if (point.bit && words.size() == 1) {
        const bool* const is_set = value.get_if<bool>();
        if (is_set == nullptr) {
            return fail(status::Bad_TypeMismatch);
        }
        const auto mask = static_cast<std::uint16_t>(1U << *point.bit);
        words.front() = *is_set ? mask : std::uint16_t{0};
        return mask;
    }
    if (!point.scale) {
        const StatusCode written = write_modbus(point.type, value, words);
        return written.is_bad() ? Result<std::uint16_t>{fail(written)} : whole_word;
    }
    const double* const number = value.get_if<double>();
    if (number == nullptr) {
        return fail(status::Bad_TypeMismatch);
    }
    const DeviceScale& scale = *point.scale;
    const auto raw =
        variant_of(scale.raw_low + (*number - scale.low) * (scale.raw_high - scale.raw_low) /
                                       (scale.high - scale.low),
                   data_type_of(point.type.type));
    if (!raw) {
        return fail(raw.error());
    }
    const StatusCode written = write_modbus(point.type, *raw, words);
    return written.is_bad() ? Result<std::uint16_t>{fail(written)} : whole_word;
}

} // namespace busbar::backend
