#include "label_finder.hpp"

#include <algorithm>
#include <array>

#include <busbar/controller/label_program.hpp>

namespace busbar::controller {

namespace detail {

namespace {

using backend::LabelType;

constexpr std::string_view utf16_unit = "UTF16_UNIT";

struct ElementaryRow {
    ElementaryType type;
    LabelType label;
};

constexpr std::array elementary_rows{
    ElementaryRow{ElementaryType::Bool, LabelType::Bit},
    ElementaryRow{ElementaryType::Int, LabelType::Word},
    ElementaryRow{ElementaryType::Uint, LabelType::UnsignedWord},
    ElementaryRow{ElementaryType::Word, LabelType::UnsignedWord},
    ElementaryRow{ElementaryType::Dint, LabelType::DoubleWord},
    ElementaryRow{ElementaryType::Udint, LabelType::UnsignedDoubleWord},
    ElementaryRow{ElementaryType::Dword, LabelType::UnsignedDoubleWord},
    ElementaryRow{ElementaryType::Real, LabelType::Float},
    ElementaryRow{ElementaryType::Lreal, LabelType::Double},
    ElementaryRow{ElementaryType::Time, LabelType::Time},
    ElementaryRow{ElementaryType::String, LabelType::String},
};

struct TimerRow {
    std::string_view name;
    LabelType label;
    /// Type of its current value.
    ElementaryType current;
};

constexpr std::array timer_rows{
    TimerRow{"TIMER", LabelType::Timer, ElementaryType::Uint},
    TimerRow{"RETENTIVETIMER", LabelType::RetentiveTimer, ElementaryType::Uint},
    TimerRow{"LTIMER", LabelType::LongTimer, ElementaryType::Udint},
    TimerRow{"LRETENTIVETIMER", LabelType::LongRetentiveTimer, ElementaryType::Udint},
    TimerRow{"COUNTER", LabelType::Counter, ElementaryType::Uint},
    TimerRow{"LCOUNTER", LabelType::LongCounter, ElementaryType::Udint},
};

/// Function devices and the step relay (SH-082679, 8.3), which cannot be sampled. Devices such as
/// J1\X0 and U0\G0 are recognized by their first letter, which no other device has.
constexpr std::array<std::string_view, 4> unsampled_devices{"FX", "FY", "FD", "S"};

bool is_letter(char c)
{
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

DerivedType timer(const TimerRow& row)
{
    const auto member = [](std::string name, ElementaryType type) {
        return Member{.name = std::move(name), .type = {.elementary = type}};
    };
    return {.name = std::string{row.name},
            .members = {member("S", ElementaryType::Bool), member("C", ElementaryType::Bool),
                        member("N", row.current)}};
}

} // namespace

std::optional<LabelType> label_type_of(ElementaryType type)
{
    const auto found = std::ranges::find(elementary_rows, type, &ElementaryRow::type);
    return found != elementary_rows.end() ? std::optional{found->label} : std::nullopt;
}

std::optional<LabelType> timer_type_of(const DerivedType& type)
{
    const auto found = std::ranges::find(timer_rows, type.name, &TimerRow::name);
    return found != timer_rows.end() ? std::optional{found->label} : std::nullopt;
}

bool is_utf16_text(const TypeUse& use, const ProgramTypes& types)
{
    for (const TypeUse* at = &use; !at->type_name.empty();) {
        const DerivedType& type = *types.find(at->type_name);
        if (type.name == utf16_unit) {
            return true;
        }
        if (type.kind != DerivedType::Kind::Alias) {
            return false;
        }
        at = &type.alias;
    }
    return false;
}

bool is_unsampled_device(std::string_view address)
{
    address.remove_prefix(address.starts_with('%') ? 1 : 0);
    const auto end = std::ranges::find_if_not(address, is_letter);
    const std::string letters =
        fold_name({address.begin(), static_cast<std::size_t>(end - address.begin())});
    return letters.starts_with('j') || letters.starts_with('u') ||
           std::ranges::any_of(unsampled_devices, [&](std::string_view device) {
               return fold_name(device) == letters;
           });
}

} // namespace detail

std::vector<DerivedType> label_types()
{
    std::vector<DerivedType> types;
    types.reserve(detail::timer_rows.size() + 1);
    for (const detail::TimerRow& row : detail::timer_rows) {
        types.push_back(detail::timer(row));
    }
    types.push_back({.name = std::string{detail::utf16_unit},
                     .kind = DerivedType::Kind::Alias,
                     .alias = {.elementary = ElementaryType::Uint}});
    return types;
}

} // namespace busbar::controller
