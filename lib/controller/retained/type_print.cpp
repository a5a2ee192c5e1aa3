#include "type_print.hpp"

#include <bit>

namespace busbar::controller::detail {

namespace {

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

} // namespace

std::uint64_t TypePrints::print(const TypeUse& use)
{
    const ResolvedType type = types_->resolve(use);
    Fingerprint made;
    // Values are stored as they are in memory.
    made.add(std::uint64_t{std::endian::native == std::endian::little});
    made.add(static_cast<std::uint64_t>(type.kind));
    made.add(std::uint64_t{type.dimensions.size()});
    for (const Bounds& bounds : type.dimensions) {
        made.add(bounds);
    }
    if (type.kind == ResolvedType::Kind::Elementary) {
        made.add(static_cast<std::uint64_t>(type.elementary));
        const BuiltInType built_in = built_in_type_of(type.elementary, elementary_);
        if (built_in != built_in_type_of(type.elementary)) {
            made.add(static_cast<std::uint64_t>(built_in));
        }
        made.add(std::uint64_t{type.string_length});
        made.add(type.subrange.value_or(Bounds{INT64_MIN, INT64_MAX}));
    } else {
        made.add(print_of(*type.type));
    }
    return made.value();
}

std::uint64_t TypePrints::print_of(const DerivedType& type)
{
    if (const auto found = known_.find(&type); found != known_.end()) {
        return found->second;
    }
    Fingerprint made;
    for (const Enumerator& one : type.enumerators) {
        made.add(fold_name(one.name));
        made.add(std::int64_t{one.value});
    }
    for (const Member& member : type.members) {
        made.add(fold_name(member.name));
        made.add(print(member.type));
    }
    return known_.emplace(&type, made.value()).first->second;
}

} // namespace busbar::controller::detail
