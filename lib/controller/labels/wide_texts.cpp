#include "wide_texts.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>

#include <busbar/core/problem.hpp>

#include "controller/conversion/label_text.hpp"

namespace busbar::controller::detail {

namespace {

/// The bytes of all initial values of WSTRING, with their repetitions.
constexpr std::uint64_t max_text_bytes = 1U << 20U;

bool is_wide_text(const TypeUse& use)
{
    return use.type_name.empty() && use.elementary == ElementaryType::Wstring;
}

/// Calls `visit` with each use of a type that declares something, and its initial value.
template <typename Visit>
void visit_uses(Program& program, Visit visit)
{
    for (DerivedType& type : program.types) {
        if (type.kind == DerivedType::Kind::Alias) {
            visit(type.alias, type.initial);
        }
        for (Member& member : type.members) {
            visit(member.type, member.initial);
        }
    }
    for (GlobalVariable& variable : program.variables) {
        visit(variable.type, variable.initial);
    }
}

/// Calls `visit` with each initial value and the use of the type that it is for.
template <typename Visit>
void visit_initial(Program& program, Visit visit)
{
    visit_uses(program, [&](const TypeUse& use, InitialValue& value) {
        if (!value.empty()) {
            visit(use, value);
        }
    });
    for (DerivedType& type : program.types) {
        const bool is_structured =
            type.kind == DerivedType::Kind::Structure || type.kind == DerivedType::Kind::Union;
        if (is_structured && !type.initial.empty()) {
            visit({.type_name = type.name}, type.initial);
        }
    }
}

/// Returns the units of a text and the zero after it, as elements of an array.
std::vector<InitialValue> units_of(std::string_view text)
{
    constexpr std::size_t size = 2;
    std::vector<std::byte> bytes((text.size() + 1) * size);
    static_cast<void>(to_utf16(text, bytes)); // it is UTF-8, as it was checked
    std::vector<InitialValue> units;
    for (std::size_t at = 0;; at += size) {
        const auto unit = std::to_integer<std::int64_t>(bytes[at]) |
                          std::to_integer<std::int64_t>(bytes[at + 1]) << 8U;
        InitialValue& one = units.emplace_back();
        one.value = Variant{unit};
        one.notation = InitialValue::Notation::Number;
        if (unit == 0) {
            return units;
        }
    }
}

bool is_of_wide_texts(const ResolvedType& type)
{
    return type.kind == ResolvedType::Kind::Elementary &&
           type.elementary == ElementaryType::Wstring;
}

/// Makes lists of `length` elements each, the last of which may be shorter. Runs of equal elements
/// stay together.
std::vector<InitialValue> rows_of(const std::vector<InitialValue>& elements, std::uint64_t length)
{
    std::vector<InitialValue> rows;
    std::uint64_t room = 0; // in the last row
    for (const InitialValue& element : elements) {
        std::uint64_t left = element.repeat;
        while (left > 0) {
            if (room == 0) {
                rows.emplace_back();
                rows.back().repeat =
                    static_cast<std::uint32_t>(std::max<std::uint64_t>(left / length, 1));
                room = length;
            }
            const std::uint64_t taken = std::min(left, room);
            InitialValue& part = rows.back().parts.emplace_back(element);
            part.repeat = static_cast<std::uint32_t>(taken);
            left -= taken * rows.back().repeat;
            room -= taken;
        }
    }
    return rows;
}

/// Makes nested lists of a list of all elements below `level` dimensions.
void nest(const std::vector<Bounds>& dimensions, std::size_t level, InitialValue& list)
{
    const bool is_nested =
        std::any_of(list.parts.begin(), list.parts.end(),
                    [](const InitialValue& part) { return !part.parts.empty(); });
    if (is_nested) {
        return;
    }
    for (std::size_t i = dimensions.size(); i > level + 1; --i) {
        const Bounds& bounds = dimensions[i - 1];
        list.parts =
            rows_of(list.parts, static_cast<std::uint64_t>(bounds.upper - bounds.lower + 1));
    }
}

/// Converts initial values before the types change.
class InitialTexts {
public:
    explicit InitialTexts(const ProgramTypes& types) : types_{&types} {}

    /// Counts the bytes of the texts that convert() takes apart; more than the limit is one more.
    std::uint64_t bytes_of(const ResolvedType& type, const InitialValue& value)
    {
        std::uint64_t sum = 0;
        if (const auto* text = value.value.get_if<String>(); is_of_wide_texts(type) && text) {
            sum = text->size();
        } else if (is_of_wide_texts(type) || type.is_structured()) {
            for (const InitialValue& part : value.parts) {
                sum = std::min(sum + bytes_of(part_of(type, part), part), max_text_bytes + 1);
            }
        }
        return std::min(sum * value.repeat, max_text_bytes + 1);
    }

    /// Converts the value below `level` dimensions of the type.
    void convert(const ResolvedType& type, InitialValue& value, std::size_t level = 0)
    {
        if (is_of_wide_texts(type) && value.value.get_if<String>() != nullptr) {
            const Variant text = std::exchange(value.value, Variant{});
            value.parts = units_of(text.get_if<String>()->view());
            value.notation = InitialValue::Notation::Unknown;
            return;
        }
        if (is_of_wide_texts(type)) {
            nest(type.dimensions, level, value);
        } else if (!type.is_structured()) {
            return;
        }
        for (InitialValue& part : value.parts) {
            convert(part_of(type, part), part, part.member.empty() ? level + 1 : 0);
        }
    }

private:
    /// Returns the type that a part of a value is of.
    const ResolvedType& part_of(const ResolvedType& type, const InitialValue& part)
    {
        return part.member.empty() ? type : member_of(*type.type, part.member);
    }

    const ResolvedType& member_of(const DerivedType& type, const std::string& name)
    {
        auto& index = names_[&type];
        if (index.empty()) {
            for (const Member& member : type.members) {
                index.emplace(fold_name(member.name), index.size());
            }
        }
        return types_->members(type)[index.at(fold_name(name))];
    }

    const ProgramTypes* types_;
    std::unordered_map<const DerivedType*, std::unordered_map<std::string, std::size_t>> names_{};
};

} // namespace

Configured<bool> lay_out_wide_texts(Program& program, const ProgramTypes& types)
{
    bool is_there = false;
    visit_uses(program, [&](const TypeUse& use, const InitialValue&) {
        is_there = is_there || is_wide_text(use);
    });
    if (!is_there) {
        return false;
    }
    InitialTexts initial{types};
    std::uint64_t bytes = 0;
    visit_initial(program, [&](const TypeUse& use, const InitialValue& value) {
        bytes = std::min(bytes + initial.bytes_of(types.resolve(use), value), max_text_bytes + 1);
    });
    if (bytes > max_text_bytes) {
        return misconfigured("WSTRING", "has initial values of more than " +
                                            std::to_string(max_text_bytes) + " bytes");
    }
    visit_initial(program, [&](const TypeUse& use, InitialValue& value) {
        initial.convert(types.resolve(use), value);
    });
    visit_uses(program, [](TypeUse& use, const InitialValue&) {
        if (is_wide_text(use)) {
            use.dimensions.push_back({0, use.string_length});
            use.type_name = "UTF16_UNIT";
        }
    });
    return true;
}

} // namespace busbar::controller::detail
