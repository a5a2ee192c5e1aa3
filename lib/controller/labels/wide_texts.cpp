#include "wide_texts.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "controller/conversion/label_text.hpp"

namespace busbar::controller::detail {

namespace {

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

/// Converts initial values before the types change.
class InitialTexts {
public:
    explicit InitialTexts(const ProgramTypes& types) : types_{&types} {}

    void convert(const ResolvedType& type, InitialValue& value)
    {
        const bool is_of_wide_texts = type.kind == ResolvedType::Kind::Elementary &&
                                      type.elementary == ElementaryType::Wstring;
        if (is_of_wide_texts && value.value.get_if<String>() != nullptr) {
            const Variant text = std::exchange(value.value, Variant{});
            value.parts = units_of(text.get_if<String>()->view());
            value.notation = InitialValue::Notation::Unknown;
            return;
        }
        if (!is_of_wide_texts && !type.is_structured()) {
            return;
        }
        for (InitialValue& part : value.parts) {
            convert(part.member.empty() ? type : member_of(*type.type, part.member), part);
        }
    }

private:
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

bool lay_out_wide_texts(Program& program, const ProgramTypes& types)
{
    bool is_there = false;
    visit_uses(program, [&](const TypeUse& use, const InitialValue&) {
        is_there = is_there || is_wide_text(use);
    });
    if (!is_there) {
        return false;
    }
    InitialTexts initial{types};
    visit_uses(program, [&](const TypeUse& use, InitialValue& value) {
        initial.convert(types.resolve(use), value);
    });
    for (DerivedType& type : program.types) {
        if (type.kind == DerivedType::Kind::Structure || type.kind == DerivedType::Kind::Union) {
            initial.convert(types.resolve({.type_name = type.name}), type.initial);
        }
    }
    visit_uses(program, [](TypeUse& use, const InitialValue&) {
        if (is_wide_text(use)) {
            use.dimensions.push_back({0, use.string_length});
            use.type_name = "UTF16_UNIT";
        }
    });
    return true;
}

} // namespace busbar::controller::detail
