#include <limits>

#include "expression.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t end_of_negative = std::uint64_t{1} << 63U;

std::optional<Whole> checked(bool is_negative, std::uint64_t size)
{
    if (is_negative && size > end_of_negative) {
        return {};
    }
    return Whole{is_negative && size != 0, size};
}

} // namespace

std::optional<Whole> whole_of(const Variant& value)
{
    if (const auto* number = value.get_if<std::int64_t>()) {
        const auto bits = static_cast<std::uint64_t>(*number);
        return Whole{*number < 0, *number < 0 ? std::uint64_t{0} - bits : bits};
    }
    if (const auto* number = value.get_if<std::uint64_t>()) {
        return Whole{false, *number};
    }
    return {};
}

Variant variant_of(const Whole& number)
{
    if (!number.is_negative && number.size >= end_of_negative) {
        return Variant{number.size};
    }
    return Variant{static_cast<std::int64_t>(bits_of(number))};
}

std::optional<Whole> add(const Whole& a, const Whole& b)
{
    if (a.is_negative == b.is_negative) {
        return a.size > largest - b.size ? std::nullopt : checked(a.is_negative, a.size + b.size);
    }
    return a.size >= b.size ? checked(a.is_negative, a.size - b.size)
                            : checked(b.is_negative, b.size - a.size);
}

std::optional<Whole> subtract(const Whole& a, const Whole& b)
{
    return add(a, {!b.is_negative, b.size});
}

std::optional<Whole> multiply(const Whole& a, const Whole& b)
{
    if (a.size != 0 && b.size > largest / a.size) {
        return {};
    }
    return checked(a.is_negative != b.is_negative, a.size * b.size);
}

std::optional<Whole> divide(const Whole& a, const Whole& b)
{
    return checked(a.is_negative != b.is_negative, a.size / b.size);
}

Whole modulo(const Whole& a, const Whole& b)
{
    const std::uint64_t rest = a.size % b.size;
    return {a.is_negative && rest != 0, rest};
}

std::optional<Whole> power(const Whole& base, std::uint64_t exponent)
{
    Whole result{false, 1};
    if (exponent != 0 && base.size < 2) {
        return Whole{base.is_negative && exponent % 2 != 0, base.size};
    }
    // More than 64 factors of 2 or more do not fit.
    for (; exponent > 0; --exponent) {
        const auto next = multiply(result, base);
        if (!next) {
            return {};
        }
        result = *next;
    }
    return result;
}

bool is_less(const Whole& a, const Whole& b)
{
    if (a.is_negative != b.is_negative) {
        return a.is_negative;
    }
    return a.is_negative ? a.size > b.size : a.size < b.size;
}

bool is_equal(const Whole& a, const Whole& b)
{
    return a.is_negative == b.is_negative && a.size == b.size;
}

double real_of(const Whole& number)
{
    const auto size = static_cast<double>(number.size);
    return number.is_negative ? -size : size;
}

std::uint64_t bits_of(const Whole& number)
{
    return number.is_negative ? std::uint64_t{0} - number.size : number.size;
}

Whole from_bits(std::uint64_t bits, bool is_signed)
{
    return is_signed && bits >= end_of_negative ? Whole{true, std::uint64_t{0} - bits}
                                                : Whole{false, bits};
}

unsigned width_of(ElementaryType type)
{
    switch (type) {
    case ElementaryType::Bool:
        return 1;
    case ElementaryType::Sint:
    case ElementaryType::Usint:
    case ElementaryType::Byte:
        return 8;
    case ElementaryType::Int:
    case ElementaryType::Uint:
    case ElementaryType::Word:
        return 16;
    case ElementaryType::Dint:
    case ElementaryType::Udint:
    case ElementaryType::Dword:
        return 32;
    case ElementaryType::Lint:
    case ElementaryType::Ulint:
    case ElementaryType::Lword:
        return 64;
    default:
        return 0;
    }
}

} // namespace busbar::controller::detail
