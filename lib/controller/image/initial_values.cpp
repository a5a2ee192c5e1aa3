#include "initial_values.hpp"

#include <algorithm>
#include <cstring>

#include <busbar/core/text.hpp>
#include <busbar/server/image_structure.hpp>

#include "server/image/image_types.hpp"

namespace busbar::controller::detail {

namespace {

Problem wrong_initial(std::string text)
{
    return Problem{.text = std::move(text)};
}

std::optional<Problem> within(std::optional<Problem> problem, const std::string& place)
{
    if (problem) {
        problem->where = place + problem->where;
    }
    return problem;
}

/// The value that a variable of this type has without a declared one. A date begins in 1970, as
/// IEC 61131-3 counts it, though a DateTime counts from 1601.
Variant first_value(const ResolvedType& type)
{
    if (type.kind == ResolvedType::Kind::Enumeration) {
        return Variant{std::int64_t{type.type->enumerators.front().value}};
    }
    if (type.elementary == ElementaryType::Date || type.elementary == ElementaryType::DateAndTime) {
        return Variant{DateTime::from_unix_seconds(0)};
    }
    const bool has_zero =
        !type.subrange || (type.subrange->lower <= 0 && type.subrange->upper >= 0);
    return Variant{has_zero ? std::int64_t{0} : type.subrange->lower};
}

/// Finds the enumerator of that name or with that value.
std::optional<std::int32_t> enumerator(const DerivedType& type, const Variant& value)
{
    const String* const named = value.get_if<String>();
    const std::string folded = named != nullptr ? fold_name(named->view()) : "";
    for (const Enumerator& one : type.enumerators) {
        if (named != nullptr ? fold_name(one.name) == folded
                             : value == Variant{std::int64_t{one.value}}) {
            return one.value;
        }
    }
    return std::nullopt;
}

} // namespace

std::optional<Problem> InitialValues::store(const TypeUse& use, const InitialValue& own,
                                            const server::ImagePlace& place, std::byte* to) const
{
    const ResolvedType type = types_->resolve(use);
    const Target target{type, place, to};
    if (auto problem = store_default(target)) {
        return problem;
    }
    for (std::uint32_t i = 1; i < place.elements; ++i) {
        std::memcpy(to + std::size_t{i} * place.stride, to, place.stride);
    }
    if (type.initial != nullptr) {
        if (auto problem = apply(target, *type.initial)) {
            return problem;
        }
    }
    return own.empty() ? Found{} : apply(target, own);
}

std::optional<Problem> InitialValues::store_default(const Target& target) const
{
    if (target.place.is_structure()) {
        const auto members = target.place.structure->members();
        for (std::size_t i = 0; i < members.size(); ++i) {
            const Member& member = target.type.type->members[i];
            auto problem =
                store(member.type, member.initial, members[i], target.to + members[i].offset);
            if (problem) {
                return within(std::move(problem), "." + printable(member.name));
            }
        }
        return {};
    }
    if (target.place.is_text()) {
        server::detail::put_text(target.to, "");
        return {};
    }
    static_cast<void>(put_initial_number(target.place.type, first_value(target.type), target.to));
    return {};
}

std::optional<Problem> InitialValues::apply(const Target& target, const InitialValue& value) const
{
    if (!target.type.is_array()) {
        return apply_one(target, value);
    }
    if (value.parts.empty()) {
        return wrong_initial("has one initial value; expected a list of elements");
    }
    std::uint64_t next = 0;
    return apply_list(target, value, next);
}

std::optional<Problem> InitialValues::apply_list(const Target& array, const InitialValue& list,
                                                 std::uint64_t& next) const
{
    for (const InitialValue& part : list.parts) {
        if (auto problem = apply_repeated(array, part, next)) {
            return problem;
        }
    }
    return {};
}

/// Applies nested lists as one list, the last index counting fastest.
std::optional<Problem> InitialValues::apply_repeated(const Target& array, const InitialValue& part,
                                                     std::uint64_t& next) const
{
    const bool is_list = !part.parts.empty() && part.parts.front().member.empty();
    for (std::uint32_t i = 0; i < part.repeat; ++i) {
        if (is_list) {
            const std::uint64_t before = next;
            if (auto problem = apply_list(array, part, next)) {
                return problem;
            }
            if (next == before) { // the list is empty, however often it is repeated
                return {};
            }
            continue;
        }
        if (next == array.place.elements) {
            return wrong_initial("has more initial values than its " +
                                 std::to_string(array.place.elements) + " elements");
        }
        const Target element{array.type, array.place, array.to + next * array.place.stride};
        ++next;
        if (auto problem = part.empty() ? Found{} : apply_one(element, part)) {
            return within(std::move(problem), "[" + std::to_string(next - 1) + "]");
        }
    }
    return {};
}

std::optional<Problem> InitialValues::apply_one(const Target& target,
                                                const InitialValue& value) const
{
    if (target.place.is_structure()) {
        return apply_members(target, value);
    }
    if (!value.parts.empty() || value.value.is_array()) {
        return wrong_initial("has a list of initial values; expected one");
    }
    if (target.type.kind == ResolvedType::Kind::Enumeration) {
        const auto found = enumerator(*target.type.type, value.value);
        if (!found) {
            return wrong_initial("has an initial value that is not a name of the enumeration " +
                                 printable(target.type.type->name));
        }
        std::memcpy(target.to, &*found, sizeof *found);
        return {};
    }
    if (target.place.is_text()) {
        const String* const text = value.value.get_if<String>();
        if (text == nullptr || text->size() > target.place.capacity) {
            return wrong_initial("has an initial value that is not a text of at most " +
                                 std::to_string(target.place.capacity) + " bytes");
        }
        server::detail::put_text(target.to, text->view());
        return {};
    }
    const bool is_allowed = is_in_subrange(value.value, target.type.subrange);
    const Variant published = as_published(target.type.elementary, target.place.type, value.value);
    if (!is_allowed || !put_initial_number(target.place.type, published, target.to)) {
        return wrong_initial("has an initial value that is not of type " +
                             std::string{name(target.type.elementary)} +
                             (is_allowed ? "" : " within its subrange"));
    }
    return {};
}

std::optional<Problem> InitialValues::apply_members(const Target& target,
                                                    const InitialValue& value) const
{
    if (value.parts.empty()) {
        return wrong_initial("has one initial value; expected a list of members");
    }
    const std::vector<Member>& members = target.type.type->members;
    for (const InitialValue& part : value.parts) {
        const std::string folded = fold_name(part.member);
        const auto found = std::find_if(members.begin(), members.end(), [&](const Member& one) {
            return fold_name(one.name) == folded;
        });
        const std::string place = "." + printable(part.member);
        if (found == members.end()) {
            return within(wrong_initial("has an initial value but is not a member of " +
                                        printable(target.type.type->name)),
                          place);
        }
        const auto index = static_cast<std::size_t>(found - members.begin());
        const server::ImagePlace& inner = target.place.structure->members()[index];
        const ResolvedType type = types_->resolve(found->type);
        if (auto problem = apply({type, inner, target.to + inner.offset}, part)) {
            return within(std::move(problem), place);
        }
    }
    return {};
}

} // namespace busbar::controller::detail
