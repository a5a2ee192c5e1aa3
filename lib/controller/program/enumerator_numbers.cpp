#include "program_parts.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include <busbar/controller/program_types.hpp>

#include "declaration_keywords.hpp"

namespace busbar::controller::detail {

namespace {

using Notation = InitialValue::Notation;

/// Goes through the initial values of a program whose types are not checked.
class EnumeratorSettler {
public:
    explicit EnumeratorSettler(Program& program) : program_{&program}
    {
        for (std::size_t i = 0; i < program.types.size(); ++i) {
            types_.emplace(fold_name(program.types[i].name), i);
        }
    }

    void run()
    {
        for (DerivedType& type : program_->types) {
            for (Member& member : type.members) {
                settle(member.type, member.initial);
            }
            if (!type.initial.empty()) {
                settle({.type_name = type.name}, type.initial);
            }
        }
        for (GlobalVariable& variable : program_->variables) {
            settle(variable.type, variable.initial);
        }
    }

private:
    /// An enumeration's values.
    struct Values {
        std::unordered_map<std::string, std::int32_t> numbers{};
        std::unordered_map<std::int32_t, std::size_t> names{};
    };

    void settle(const TypeUse& use, InitialValue& value)
    {
        if (value.empty()) {
            return;
        }
        const TypeUse* end = &use;
        const DerivedType* type = nullptr;
        constexpr int most = 64;
        for (int i = 0; i < most && !end->type_name.empty(); ++i) {
            type = find(end->type_name);
            if (type == nullptr) {
                return;
            }
            if (type->kind != DerivedType::Kind::Alias) {
                break;
            }
            end = &type->alias;
        }
        const bool is_elementary = end->type_name.empty();
        settle_value(is_elementary ? nullptr : type, end->elementary, value);
    }

    /// `type` is null for an elementary type.
    void settle_value(const DerivedType* type, ElementaryType elementary, InitialValue& value)
    {
        const bool has_members = type != nullptr && !type->members.empty();
        for (InitialValue& part : value.parts) {
            if (part.member.empty()) {
                settle_value(type, elementary, part);
            } else if (const Member* member = has_members ? find(*type, part.member) : nullptr) {
                settle(member->type, part);
            }
        }
        if (value.value.is_null()) {
            return;
        }
        if (type == nullptr && value.notation == Notation::Enumerator) {
            settle_number(elementary, value);
        } else if (type != nullptr && type->kind == DerivedType::Kind::Enumeration &&
                   value.notation == Notation::Number) {
            settle_name(*type, value);
        }
    }

    void settle_number(ElementaryType elementary, InitialValue& value)
    {
        const auto* name = value.value.get_if<String>();
        const auto number = name != nullptr && elementary <= ElementaryType::Lreal
                                ? number_of(value.enumeration, fold_name(name->view()))
                                : std::nullopt;
        if (number && elementary != ElementaryType::Bool) {
            value.value = Variant{std::int64_t{*number}};
            value.notation = Notation::Number;
            value.enumeration.clear();
        }
    }

    void settle_name(const DerivedType& type, InitialValue& value)
    {
        const auto* number = value.value.get_if<std::int64_t>();
        if (number == nullptr || *number < INT32_MIN || *number > INT32_MAX) {
            return;
        }
        const Values& values = values_of(type);
        const auto found = values.names.find(static_cast<std::int32_t>(*number));
        if (found != values.names.end()) {
            value.value = Variant{String{type.enumerators[found->second].name}};
            value.notation = Notation::Enumerator;
        }
    }

    /// Without an enumeration's name the name has to be of one enumeration only.
    [[nodiscard]] std::optional<std::int32_t> number_of(const std::string& enumeration,
                                                        const std::string& folded)
    {
        if (!enumeration.empty()) {
            const DerivedType* type = find(enumeration);
            return type != nullptr ? number_in(*type, folded) : std::nullopt;
        }
        if (!is_indexed_) {
            index_names();
        }
        const auto found = owners_.find(folded);
        return found == owners_.end() || found->second == nullptr
                   ? std::nullopt
                   : number_in(*found->second, folded);
    }

    [[nodiscard]] std::optional<std::int32_t> number_in(const DerivedType& type,
                                                        const std::string& folded)
    {
        const Values& values = values_of(type);
        const auto found = values.numbers.find(folded);
        return found == values.numbers.end() ? std::nullopt : std::optional{found->second};
    }

    void index_names()
    {
        is_indexed_ = true;
        for (const DerivedType& type : program_->types) {
            for (const Enumerator& one : type.enumerators) {
                const auto [entry, is_new] = owners_.emplace(fold_name(one.name), &type);
                entry->second = is_new ? &type : nullptr;
            }
        }
    }

    const Values& values_of(const DerivedType& type)
    {
        const auto [entry, is_new] = values_.try_emplace(&type);
        if (is_new) {
            for (std::size_t i = 0; i < type.enumerators.size(); ++i) {
                entry->second.numbers.emplace(fold_name(type.enumerators[i].name),
                                              type.enumerators[i].value);
                entry->second.names.emplace(type.enumerators[i].value, i);
            }
        }
        return entry->second;
    }

    [[nodiscard]] const DerivedType* find(std::string_view name) const
    {
        const auto found = types_.find(fold_name(name));
        return found == types_.end() ? nullptr : &program_->types[found->second];
    }
    const Member* find(const DerivedType& type, const std::string& name)
    {
        const auto [entry, is_new] = members_.try_emplace(&type);
        if (is_new) {
            for (std::size_t i = 0; i < type.members.size(); ++i) {
                entry->second.emplace(fold_name(type.members[i].name), i);
            }
        }
        const auto found = entry->second.find(fold_name(name));
        return found == entry->second.end() ? nullptr : &type.members[found->second];
    }

    Program* program_;
    std::unordered_map<std::string, std::size_t> types_{};
    std::unordered_map<const DerivedType*, Values> values_{};
    std::unordered_map<const DerivedType*, std::unordered_map<std::string, std::size_t>> members_{};
    /// The enumeration that has a value of this name; null if several have.
    std::unordered_map<std::string, const DerivedType*> owners_{};
    bool is_indexed_{false};
};

} // namespace

void settle_enumerators(Program& program)
{
    EnumeratorSettler{program}.run();
}

} // namespace busbar::controller::detail
