#include "controller/conversion/conversion_functions.hpp"

#include <type_traits>
#include <utility>

#include <busbar/binary/wire_order.hpp>

#include "controller/conversion/float_conversion.hpp"
#include "controller/conversion/label_text.hpp"

namespace busbar::controller::detail {

namespace {

using backend::LabelType;
using Functions = LabelConversion::Functions;

template <typename T>
T load(const std::byte* label)
{
    T value;
    binary::detail::copy_number<sizeof(T)>(&value, label);
    return value;
}

template <typename T>
void store(T value, std::byte* label)
{
    binary::detail::copy_number<sizeof(T)>(label, &value);
}

/// Converts between any two integer types.
template <typename To, typename From>
StatusCode convert_integer(From from, To& to)
{
    if (!std::in_range<To>(from)) {
        return status::Bad_OutOfRange;
    }
    to = static_cast<To>(from);
    return status::Good;
}

template <typename T, typename L>
struct Integers {
    static StatusCode read(const LabelConversion&, const std::byte* label, void* value)
    {
        return convert_integer(load<L>(label), *static_cast<T*>(value));
    }
    static StatusCode write(const LabelConversion&, const void* value, std::byte* label)
    {
        L converted{};
        const StatusCode status = convert_integer(*static_cast<const T*>(value), converted);
        store(converted, label);
        return status;
    }
};

struct Booleans {
    static StatusCode read(const LabelConversion&, const std::byte* label, void* value)
    {
        *static_cast<bool*>(value) = *label != std::byte{0};
        return status::Good;
    }
    static StatusCode write(const LabelConversion&, const void* value, std::byte* label)
    {
        *label = static_cast<std::byte>(*static_cast<const bool*>(value) ? 1 : 0);
        return status::Good;
    }
};

template <typename T, typename L>
struct Floats {
    static StatusCode read(const LabelConversion&, const std::byte* label, void* value)
    {
        if constexpr (std::is_same_v<T, L>) {
            *static_cast<T*>(value) = load<L>(label);
        } else {
            *static_cast<T*>(value) = read_float(load<L>(label));
        }
        return status::Good;
    }
    static StatusCode write(const LabelConversion&, const void* value, std::byte* label)
    {
        const T number = *static_cast<const T*>(value);
        if constexpr (std::is_same_v<T, L>) {
            store(number, label);
            return check_same(number);
        } else {
            L converted{};
            const StatusCode status = write_float(number, converted);
            store(converted, label);
            return status;
        }
    }
};

/// 2000-01-01T00:00:00 from 1970-01-01, and the seconds of the years up to the end of 2099 and of
/// 2067 ("DateTime conversion").
constexpr std::int64_t first_second = 946'684'800;
constexpr std::int64_t seconds_per_day = 86'400;
constexpr std::int64_t unsigned_seconds = (100 * 365 + 25) * seconds_per_day;
constexpr std::int64_t signed_seconds = (68 * 365 + 17) * seconds_per_day;

/// Converts seconds, which are of type `L` in the label. Every value of a label can be read; only
/// values that are written to the PLC are checked.
template <typename L>
struct Seconds {
    static StatusCode read(const LabelConversion& conversion, const std::byte* label, void* value)
    {
        const std::int64_t seconds = load<L>(label);
        *static_cast<DateTime*>(value) =
            DateTime::from_unix_seconds(first_second + seconds - conversion.offset_seconds());
        return status::Good;
    }
    static StatusCode write(const LabelConversion& conversion, const void* value, std::byte* label)
    {
        const DateTime first =
            DateTime::from_unix_seconds(first_second - conversion.offset_seconds());
        const DateTime time = *static_cast<const DateTime*>(value);
        const std::int64_t seconds =
            time < first ? -1 : (time.ticks - first.ticks) / DateTime::ticks_per_second;
        store(static_cast<L>(seconds), label);
        const std::int64_t end = std::is_signed_v<L> ? signed_seconds : unsigned_seconds;
        return seconds >= 0 && seconds < end ? status::Good : status::Bad_OutOfRange;
    }
};

/// Texts of labels: the valid characters, followed by zeros.
template <bool is_unicode>
struct Texts {
    template <typename Byte>
    static std::span<Byte> valid(const LabelConversion& conversion, Byte* label)
    {
        return {label, conversion.characters() * (is_unicode ? 2 : 1)};
    }
    static String read(const LabelConversion& conversion, const std::byte* label)
    {
        const auto bytes = valid(conversion, label);
        return String{is_unicode ? from_utf16(bytes) : from_shift_jis(bytes)};
    }
    static StatusCode write(const LabelConversion& conversion, const String& text, std::byte* label)
    {
        const auto bytes = valid(conversion, label);
        for (std::size_t i = bytes.size(); i < conversion.label_size(); ++i) {
            label[i] = std::byte{0};
        }
        const bool is_text =
            is_unicode ? to_utf16(text.view(), bytes) : to_shift_jis(text.view(), bytes);
        return is_text ? status::Good : status::Bad_OutOfRange;
    }
};

template <bool is_unicode>
struct Strings {
    static StatusCode read(const LabelConversion& conversion, const std::byte* label, void* value)
    {
        *static_cast<String*>(value) = Texts<is_unicode>::read(conversion, label);
        return status::Good;
    }
    static StatusCode write(const LabelConversion& conversion, const void* value, std::byte* label)
    {
        return Texts<is_unicode>::write(conversion, *static_cast<const String*>(value), label);
    }
};

/// Converts the text only: a label has no locale.
template <bool is_unicode>
struct LocalizedTexts {
    static StatusCode read(const LabelConversion& conversion, const std::byte* label, void* value)
    {
        *static_cast<LocalizedText*>(value) =
            LocalizedText{Texts<is_unicode>::read(conversion, label)};
        return status::Good;
    }
    static StatusCode write(const LabelConversion& conversion, const void* value, std::byte* label)
    {
        const String& text = static_cast<const LocalizedText*>(value)->text;
        return Texts<is_unicode>::write(conversion, text, label);
    }
};

template <typename Conversion>
constexpr Functions functions{Conversion::read, Conversion::write};

template <typename T>
Functions of_integer(LabelType label)
{
    switch (label) {
    case LabelType::UnsignedWord:
        return functions<Integers<T, std::uint16_t>>;
    case LabelType::UnsignedDoubleWord:
        return functions<Integers<T, std::uint32_t>>;
    case LabelType::Word:
        return functions<Integers<T, std::int16_t>>;
    default: // DoubleWord, and Time, which is one of milliseconds
        return functions<Integers<T, std::int32_t>>;
    }
}

template <typename T>
Functions of_float(LabelType label)
{
    return label == LabelType::Float ? functions<Floats<T, float>> : functions<Floats<T, double>>;
}

} // namespace

Functions conversion_functions(BuiltInType leaf, LabelType label)
{
    const bool is_unicode = label == LabelType::UnicodeString;
    switch (leaf) {
    case BuiltInType::Boolean:
        return functions<Booleans>;
    case BuiltInType::SByte:
        return of_integer<std::int8_t>(label);
    case BuiltInType::Byte:
        return of_integer<std::uint8_t>(label);
    case BuiltInType::Int16:
        return of_integer<std::int16_t>(label);
    case BuiltInType::UInt16:
        return of_integer<std::uint16_t>(label);
    case BuiltInType::UInt32:
        return of_integer<std::uint32_t>(label);
    case BuiltInType::Int64:
        return of_integer<std::int64_t>(label);
    case BuiltInType::UInt64:
        return of_integer<std::uint64_t>(label);
    case BuiltInType::Float:
        return of_float<float>(label);
    case BuiltInType::Double:
        return of_float<double>(label);
    case BuiltInType::String:
        return is_unicode ? functions<Strings<true>> : functions<Strings<false>>;
    case BuiltInType::LocalizedText:
        return is_unicode ? functions<LocalizedTexts<true>> : functions<LocalizedTexts<false>>;
    case BuiltInType::DateTime:
        return label == LabelType::DoubleWord ? functions<Seconds<std::int32_t>>
                                              : functions<Seconds<std::uint32_t>>;
    default: // Int32; all others have no label
        return of_integer<std::int32_t>(label);
    }
}

} // namespace busbar::controller::detail
