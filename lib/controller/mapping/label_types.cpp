#include <busbar/controller/label_check.hpp>

#include <string_view>

#include "table_fields.hpp"

namespace busbar::controller {

namespace {

using backend::LabelType;
using backend::TimerPart;

constexpr std::array<DeclaredLabelType, declared_label_type_count> all_declared{{
    {"BOOL", LabelType::Bit},
    {"UINT, WORD", LabelType::UnsignedWord},
    {"UDINT, DWORD", LabelType::UnsignedDoubleWord},
    {"INT", LabelType::Word},
    {"DINT", LabelType::DoubleWord},
    {"REAL", LabelType::Float},
    {"LREAL", LabelType::Double},
    {"TIME", LabelType::Time},
    {"STRING(n)", LabelType::String},
    {"WSTRING(n), ARRAY[0..n] OF UTF16_UNIT", LabelType::UnicodeString},
    {"any timer or counter .S", LabelType::Timer, TimerPart::Contact},
    {"any timer or counter .C", LabelType::Timer, TimerPart::Coil},
    {"TIMER, RETENTIVETIMER .N", LabelType::Timer, TimerPart::Current},
    {"LTIMER, LRETENTIVETIMER .N", LabelType::LongTimer, TimerPart::Current},
    {"COUNTER .N", LabelType::Counter, TimerPart::Current},
    {"LCOUNTER .N", LabelType::LongCounter, TimerPart::Current},
}};

const char* timer_name(LabelType type)
{
    switch (type) {
    case LabelType::Timer:
        return "TIMER";
    case LabelType::RetentiveTimer:
        return "RETENTIVETIMER";
    case LabelType::LongTimer:
        return "LTIMER";
    case LabelType::LongRetentiveTimer:
        return "LRETENTIVETIMER";
    case LabelType::Counter:
        return "COUNTER";
    case LabelType::LongCounter:
        return "LCOUNTER";
    default:
        return "";
    }
}

void append_to(std::string& list, std::string_view text)
{
    list += (list.empty() ? "" : "; ") + std::string{text};
}

} // namespace

const std::array<DeclaredLabelType, declared_label_type_count>& declared_label_types()
{
    return all_declared;
}

std::string declaration_of(const backend::LabelKind& kind)
{
    switch (kind.part) {
    case TimerPart::Contact:
        return std::string{timer_name(kind.type)} + " .S";
    case TimerPart::Coil:
        return std::string{timer_name(kind.type)} + " .C";
    case TimerPart::Current:
        return std::string{timer_name(kind.type)} + " .N";
    case TimerPart::None:
        break;
    }
    if (kind.type == LabelType::String) {
        return "STRING(" + std::to_string(kind.length) + ")";
    }
    if (kind.type == LabelType::UnicodeString) {
        const std::string length = std::to_string(kind.length);
        return "WSTRING(" + length + "), ARRAY[0.." + length + "] OF UTF16_UNIT";
    }
    for (const DeclaredLabelType& declared : all_declared) {
        if (declared.type == kind.type && declared.part == TimerPart::None) {
            return declared.text;
        }
    }
    return "of a type that no label can have";
}

Assignability label_use(const MappablePart& part, LabelType type, TimerPart timer)
{
    const auto all_or_none = [](bool can) { return can ? Assignability::Same : Assignability::No; };
    if (part.path == detail::handle_part) {
        return all_or_none(is_handle_label(type));
    }
    if (part.path == detail::quality_part || part.path == detail::done_part) {
        return all_or_none(is_quality_label(type));
    }
    return part.is_scaled ? all_or_none(is_scalable(part.leaf) && is_scalable(type, timer))
                          : assignability(part.leaf, type, timer);
}

LabelTypes label_types_for(const MappablePart& part)
{
    LabelTypes types;
    for (const DeclaredLabelType& declared : all_declared) {
        const Assignability found = label_use(part, declared.type, declared.part);
        if (found != Assignability::No) {
            append_to(found == Assignability::Same ? types.same : types.checked, declared.text);
        }
    }
    return types;
}

} // namespace busbar::controller
