#include <algorithm>
#include <bit>
#include <string_view>

#include <busbar/controller/program_types.hpp>

#include "server/image/image_shape.hpp"

namespace busbar::controller {

namespace {

/// Caps numbers so that sums of unchecked types stay in range; the checker allows far less.
constexpr std::uint64_t most = std::uint64_t{1} << 56U;
constexpr std::uint64_t bits_of_word = 16;

std::uint64_t saturating_product(std::uint64_t a, std::uint64_t b)
{
    return b != 0 && a > most / b ? most : a * b;
}

std::uint64_t rounded_up(std::uint64_t size, std::uint64_t multiple)
{
    return (size + multiple - 1) / multiple * multiple;
}

std::uint64_t text_bytes_of(ElementaryType type, std::uint32_t length)
{
    constexpr std::uint64_t bytes_of_unit = 3;
    return length * (is_wide(type) ? bytes_of_unit : 1);
}

std::uint64_t size_in_source(const ResolvedType& type)
{
    if (type.kind == ResolvedType::Kind::Enumeration) {
        return 2;
    }
    if (type.elementary == ElementaryType::Bool) {
        return 1;
    }
    const bool is_time =
        type.elementary >= ElementaryType::Time && type.elementary <= ElementaryType::DateAndTime;
    return is_time ? 4 : size_of(type.elementary);
}

ValueLayout::Extent extent_of_one(const ResolvedType& type, ValueMemory memory)
{
    if (memory == ValueMemory::Image) {
        const auto [size, alignment] = server::detail::extent_of(
            built_in_type_of(type.elementary), text_bytes_of(type.elementary, type.string_length));
        return {size, alignment};
    }
    const std::uint64_t size =
        memory == ValueMemory::Source ? size_in_source(type) : size_of(type.elementary);
    if (is_text(type.elementary)) {
        const std::uint64_t unit = is_wide(type.elementary) ? 2 : 1;
        return {size != 0 ? size : (std::uint64_t{type.string_length} + 1) * unit, unit};
    }
    return {size, size};
}

/// FNV-1a of 64 bits.
class Fingerprint {
public:
    void add(std::uint64_t number)
    {
        for (unsigned shift = 0; shift < 64; shift += 8) {
            add_byte(static_cast<std::uint8_t>(number >> shift));
        }
    }
    void add(std::int64_t number) { add(static_cast<std::uint64_t>(number)); }
    void add(std::string_view text)
    {
        add(std::uint64_t{text.size()});
        for (const char c : text) {
            add_byte(static_cast<std::uint8_t>(c));
        }
    }
    void add(const Bounds& bounds)
    {
        add(bounds.lower);
        add(bounds.upper);
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

private:
    void add_byte(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100'0000'01B3U; }

    std::uint64_t value_{0xCBF2'9CE4'8422'2325U};
};

/// `inner` is the print of the type itself, unless that is elementary.
std::uint64_t print_of(const ResolvedType& type, std::uint64_t inner, ElementaryTypes choice)
{
    Fingerprint made;
    // Values are stored as they are in memory.
    made.add(std::uint64_t{std::endian::native == std::endian::little});
    made.add(static_cast<std::uint64_t>(type.kind));
    made.add(std::uint64_t{type.dimensions.size()});
    for (const Bounds& bounds : type.dimensions) {
        made.add(bounds);
    }
    if (type.kind != ResolvedType::Kind::Elementary) {
        made.add(inner);
        return made.value();
    }
    made.add(static_cast<std::uint64_t>(type.elementary));
    const BuiltInType built_in = built_in_type_of(type.elementary, choice);
    if (built_in != built_in_type_of(type.elementary)) {
        made.add(static_cast<std::uint64_t>(built_in));
    }
    made.add(std::uint64_t{type.string_length});
    made.add(type.subrange.value_or(Bounds{INT64_MIN, INT64_MAX}));
    return made.value();
}

/// Adds a member to the layout of its structure or union.
void add_member(const ValueLayout& member, bool is_union, ValueLayout& all)
{
    for (std::size_t i = 0; i < all.extents.size(); ++i) {
        const ValueLayout::Extent& one = member.extents[i];
        ValueLayout::Extent& extent = all.extents[i];
        const std::uint64_t place = is_union ? 0 : rounded_up(extent.size, one.alignment);
        extent.size = std::max(extent.size, std::min(most, place + one.size));
        extent.alignment = std::max(extent.alignment, one.alignment);
    }
    all.values =
        is_union ? std::max(all.values, member.values) : std::min(most, all.values + member.values);
    all.levels = std::max(all.levels, member.levels);
    all.has_matrix |= member.has_matrix;
    all.has_union |= member.has_union;
    all.has_first_index |= member.has_first_index;
}

/// Returns how often the bytes of one value are there in an array.
std::uint64_t repetitions(const ResolvedType& type, ValueMemory memory)
{
    const bool has_bits = memory == ValueMemory::Cpu && type.is_array() &&
                          type.kind == ResolvedType::Kind::Elementary &&
                          type.elementary == ElementaryType::Bool;
    return has_bits ? rounded_up(type.elements(), bits_of_word) / bits_of_word : type.elements();
}

} // namespace

std::uint64_t ResolvedType::elements() const
{
    std::uint64_t product = 1;
    for (const Bounds& bounds : dimensions) {
        product = saturating_product(product, static_cast<std::uint64_t>(bounds.upper) -
                                                  static_cast<std::uint64_t>(bounds.lower) + 1);
    }
    return product;
}

std::uint32_t ResolvedType::text_bytes() const
{
    return static_cast<std::uint32_t>(
        std::min(text_bytes_of(elementary, string_length), std::uint64_t{UINT32_MAX} - 1));
}

ProgramTypes::Parts ProgramTypes::lay_out(const DerivedType& type) const
{
    Parts parts;
    const bool is_union = type.kind == DerivedType::Kind::Union;
    parts.layout.values = 0;
    parts.layout.has_union = is_union;
    parts.members.reserve(type.members.size());
    for (const Member& member : type.members) {
        parts.members.push_back(resolve(member.type));
        add_member(layout(parts.members.back()), is_union, parts.layout);
    }
    ++parts.layout.levels;
    for (ValueLayout::Extent& each : parts.layout.extents) {
        each.size = std::min(most, rounded_up(each.size, each.alignment));
    }
    for (std::size_t i = 0; i < parts.prints.size(); ++i) {
        Fingerprint made;
        for (const Enumerator& one : type.enumerators) {
            made.add(fold_name(one.name));
            made.add(std::int64_t{one.value});
        }
        for (std::size_t m = 0; m < type.members.size(); ++m) {
            made.add(fold_name(type.members[m].name));
            made.add(print_of(parts.members[m], static_cast<ElementaryTypes>(i)));
        }
        parts.prints[i] = made.value();
    }
    return parts;
}

ValueLayout layout_of(const ResolvedType& type, const ValueLayout& one)
{
    ValueLayout all{one};
    for (std::size_t i = 0; i < all.extents.size(); ++i) {
        const auto memory = static_cast<ValueMemory>(i);
        ValueLayout::Extent& extent = all.extents[i];
        extent = type.is_structured() ? extent : extent_of_one(type, memory);
        extent.size = saturating_product(extent.size, repetitions(type, memory));
    }
    all.values = saturating_product(all.values, type.elements());
    all.has_matrix |= type.dimensions.size() > 1;
    all.has_first_index |= std::any_of(type.dimensions.begin(), type.dimensions.end(),
                                       [](const Bounds& bounds) { return bounds.lower != 0; });
    return all;
}

std::uint64_t ProgramTypes::print_of(const ResolvedType& type, ElementaryTypes choice) const
{
    const auto index = static_cast<std::size_t>(choice);
    return controller::print_of(type, type.type == nullptr ? 0 : parts_of(*type.type).prints[index],
                                choice);
}

} // namespace busbar::controller
