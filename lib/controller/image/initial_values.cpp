#include "initial_values.hpp"

#include <algorithm>
#include <cstring>

#include <busbar/server/image_structure.hpp>

#include "core/ascii_case.hpp"
#include "server/image/image_types.hpp"

namespace busbar::controller::detail {

namespace {

/// The value that a variable of this type has without a declared one. A date begins in 1970, as
/// IEC 61131-3 counts it, though a DateTime counts from 1601.
Variant first_value(const ResolvedType& type)
{
    if (type.kind == ResolvedType::Kind::Enumeration) {
        return Variant{std::int64_t{type.type->enumerators.front().value}};
    }
    using E = ElementaryType;
    if (type.elementary == E::Date || type.elementary == E::DateAndTime ||
        type.elementary == E::Ldate || type.elementary == E::LdateAndTime) {
        return Variant{DateTime::from_unix_seconds(0)};
    }
    const bool has_zero =
        !type.subrange || (type.subrange->lower <= 0 && type.subrange->upper >= 0);
    return Variant{has_zero ? std::int64_t{0} : type.subrange->lower};
}

/// True for a list such as [1, 2], but not for (X := 1).
bool is_list(const InitialValue& value)
{
    return !value.parts.empty() && value.parts.front().member.empty();
}

/// True for a list of lists, some of which may be omitted.
bool is_of_lists(const InitialValue& value)
{
    return is_list(value) && std::any_of(value.parts.begin(), value.parts.end(), is_list);
}

/// Returns the number of elements that an array has below `level` dimensions.
std::uint64_t elements_below(const ResolvedType& type, std::size_t level)
{
    std::uint64_t product = 1;
    for (std::size_t i = level; i < type.dimensions.size(); ++i) {
        const Bounds& bounds = type.dimensions[i];
        product *= static_cast<std::uint64_t>(bounds.upper - bounds.lower + 1);
    }
    return product;
}

/// Finds the value of the enumerator with that name.
std::optional<std::int32_t> enumerator(const DerivedType& type, const Variant& value)
{
    const String* const named = value.get_if<String>();
    const auto found =
        std::find_if(type.enumerators.begin(), type.enumerators.end(), [&](const Enumerator& one) {
            return named != nullptr &&
                   busbar::detail::is_same_ignoring_case(one.name, named->view());
        });
    return found != type.enumerators.end() ? std::optional{found->value} : std::nullopt;
}

} // namespace

bool InitialValues::store(const ResolvedType& type, const InitialValue& own,
                          const server::ImagePlace& place, std::byte* to) const
{
    const Target target{type, place, to};
    bool fits = store_default(target);
    for (std::uint32_t i = 1; i < place.elements; ++i) {
        std::memcpy(to + std::size_t{i} * place.stride, to, place.stride);
    }
    fits = apply_types(target) && fits;
    return (own.empty() || apply(target, own)) && fits;
}

bool InitialValues::store_default(const Target& target) const
{
    if (target.place.is_text()) {
        server::detail::put_text(target.to, "");
        return true;
    }
    if (!target.place.is_structure()) {
        // Where it is not of this type, the zeros of new memory are the value.
        static_cast<void>(
            put_initial_number(target.place.type, first_value(target.type), target.to));
        return true;
    }
    const DerivedType& type = *target.type.type;
    const std::vector<ResolvedType>& members = types_->members(type);
    const auto places = target.place.structure->members();
    bool fits = true;
    for (std::size_t i = 0; i < places.size(); ++i) {
        fits =
            store(members[i], type.members[i].initial, places[i], target.to + places[i].offset) &&
            fits;
    }
    return fits;
}

bool InitialValues::apply_types(const Target& target) const
{
    const ResolvedType& type = target.type;
    bool fits = true;
    for (std::size_t i = type.initials.size(); i-- > 0;) {
        const auto& [value, level] = type.initials[i];
        fits = (level < type.dimensions.size() ? apply_list(target, *value, level, 0)
                                               : apply_one(target, *value)) &&
               fits;
        const std::uint64_t one = elements_below(type, level);
        const std::uint64_t all =
            i > 0 ? elements_below(type, type.initials[i - 1].level) : target.place.elements;
        for (std::uint64_t copied = one; copied < all; copied += one) {
            std::memcpy(target.to + copied * target.place.stride, target.to,
                        one * target.place.stride);
        }
    }
    return fits;
}

bool InitialValues::apply(const Target& target, const InitialValue& value) const
{
    return target.type.is_array() ? apply_list(target, value, 0, 0) : apply_one(target, value);
}

bool InitialValues::apply_list(const Target& array, const InitialValue& list, std::size_t level,
                               std::uint64_t first) const
{
    const std::uint64_t of_one = is_of_lists(list) ? elements_below(array.type, level + 1) : 1;
    bool fits = true;
    for (const InitialValue& part : list.parts) {
        const std::uint64_t room = (array.place.elements - first) / of_one;
        const std::uint64_t count = std::min<std::uint64_t>(part.repeat, room);
        if (of_one == 1 && !is_list(part)) {
            fits = apply_repeated(array, part, first, count) && fits;
            first += count;
            continue;
        }
        for (std::uint64_t i = 0; i < count; ++i) {
            fits = apply_list(array, part, level + 1, first) && fits;
            first += of_one;
        }
    }
    return fits;
}

bool InitialValues::apply_repeated(const Target& array, const InitialValue& value,
                                   std::uint64_t first, std::uint64_t count) const
{
    if (value.empty() || count == 0) {
        return true;
    }
    const std::size_t stride = array.place.stride;
    std::byte* const begin = array.to + first * stride;
    bool fits = apply_one({array.type, array.place, begin}, value);
    for (std::uint64_t i = 1; i < count; ++i) {
        std::byte* const to = begin + i * stride;
        if (array.place.is_structure()) {
            fits = apply_one({array.type, array.place, to}, value) && fits;
        } else if (fits) {
            std::memcpy(to, begin, stride);
        }
    }
    return fits;
}

bool InitialValues::apply_one(const Target& target, const InitialValue& value) const
{
    if (value.empty()) {
        return true;
    }
    if (target.place.is_structure()) {
        return apply_members(target, value);
    }
    if (target.type.kind == ResolvedType::Kind::Enumeration) {
        const auto found = enumerator(*target.type.type, value.value);
        if (found) {
            std::memcpy(target.to, &*found, sizeof *found);
        }
        return found.has_value();
    }
    if (!target.place.is_text()) {
        const Variant published =
            as_published(target.type.elementary, target.place.type, value.value);
        return put_initial_number(target.place.type, published, target.to);
    }
    const auto* const text = value.value.get_if<String>();
    const bool fits = text != nullptr && text->size() <= target.place.capacity;
    if (fits) {
        server::detail::put_text(target.to, text->view());
    }
    return fits;
}

bool InitialValues::apply_members(const Target& target, const InitialValue& value) const
{
    const std::vector<Member>& members = target.type.type->members;
    bool fits = true;
    for (const InitialValue& part : value.parts) {
        const auto found = std::find_if(members.begin(), members.end(), [&](const Member& one) {
            return busbar::detail::is_same_ignoring_case(one.name, part.member);
        });
        if (found == members.end()) {
            return false;
        }
        const auto index = static_cast<std::size_t>(found - members.begin());
        const server::ImagePlace& place = target.place.structure->members()[index];
        const ResolvedType& type = types_->members(*target.type.type)[index];
        fits = apply({type, place, target.to + place.offset}, part) && fits;
    }
    return fits;
}

} // namespace busbar::controller::detail
