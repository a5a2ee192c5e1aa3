#include "label_finder.hpp"

#include <algorithm>
#include <cstdint>

#include <busbar/backend/label_name.hpp>

#include "core/ascii_case.hpp"

namespace busbar::controller::detail {

namespace {

using backend::LabelError;
using backend::LabelName;
using backend::LabelType;

FoundLabel refused(LabelError error)
{
    return {.error = error};
}

/// Follows the parts of a name, through types and memory side by side.
class LabelWalk {
public:
    LabelWalk(const LabelProgram& program, const LabelName& name) : program_{&program}, name_{&name}
    {
    }

    [[nodiscard]] FoundLabel find()
    {
        const GlobalVariable* const variable = program_->variable(name_->parts.front().name);
        if (variable == nullptr) {
            return refused(LabelError::Unknown);
        }
        if (variable->is_constant) {
            return refused(LabelError::Constant);
        }
        const bool is_placed_structure =
            !variable->address.empty() && name_->parts.size() > 1 && !is_timer(variable->type);
        if (variable->publish == NetworkPublish::Hidden || is_placed_structure) {
            return refused(LabelError::NotAccessible);
        }
        const auto handle = program_->handle_of(*variable);
        if (!handle) {
            return refused(LabelError::UnsupportedType);
        }
        server::ImageMemory& memory = program_->memory();
        const server::ImagePlace& place = memory.layout()[*handle];
        FoundLabel found = walk(variable->type, place, memory.bytes(place));
        found.is_unsampled = is_unsampled_device(variable->address);
        return found;
    }

private:
    [[nodiscard]] bool is_timer(const TypeUse& use) const
    {
        const ResolvedType type = program_->types().resolve(use);
        return type.kind == ResolvedType::Kind::Structure && timer_type_of(*type.type).has_value();
    }

    [[nodiscard]] FoundLabel walk(const TypeUse& first, const server::ImagePlace& place,
                                  std::byte* at) const
    {
        const TypeUse* use = &first;
        const server::ImagePlace* lies = &place;
        for (std::size_t i = 0;; ++i) {
            const LabelName::Part& part = name_->parts[i];
            const ResolvedType type = program_->types().resolve(*use);
            const bool is_text = type.is_array() && is_utf16_text(*use, program_->types());
            if (const auto error = enter(part, type, is_text, *lies, at);
                error != LabelError::None) {
                return refused(error);
            }
            if (i + 1 == name_->parts.size()) {
                return leaf(type, is_text, at);
            }
            const auto member = member_of(type, name_->parts[i + 1].name);
            if (!member) {
                return refused(LabelError::Unknown);
            }
            use = &type.type->members[*member].type;
            lies = &lies->structure->members()[*member];
            at += lies->offset;
            const auto timer = timer_type_of(*type.type);
            if (timer && i + 2 == name_->parts.size()) {
                return timer_leaf(*timer, name_->parts[i + 1], at);
            }
        }
    }

    /// Moves `at` to the chosen element of an array, or to the first unit of a UTF-16 text.
    [[nodiscard]] static LabelError enter(const LabelName::Part& part, const ResolvedType& type,
                                          bool is_text, const server::ImagePlace& place,
                                          std::byte*& at)
    {
        const std::size_t dimensions = type.dimensions.size() - (is_text ? 1 : 0);
        if (part.indices.size() > dimensions) {
            return is_text ? LabelError::NotAName : LabelError::Unknown;
        }
        if (part.indices.size() < dimensions) {
            return LabelError::NotAName; // the name means the whole array or a part of it
        }
        std::size_t element = 0;
        for (std::size_t i = 0; i < dimensions; ++i) {
            const Bounds& bounds = type.dimensions[i];
            const std::int64_t index = part.indices[i];
            if (index < bounds.lower || index > bounds.upper) {
                return LabelError::Unknown;
            }
            element = element * static_cast<std::size_t>(bounds.upper - bounds.lower + 1) +
                      static_cast<std::size_t>(index - bounds.lower);
        }
        const std::size_t units = is_text ? text_units(type) : 1;
        at += element * units * place.stride;
        return LabelError::None;
    }

    [[nodiscard]] static std::size_t text_units(const ResolvedType& type)
    {
        const Bounds& bounds = type.dimensions.back();
        return static_cast<std::size_t>(bounds.upper - bounds.lower + 1);
    }

    [[nodiscard]] static std::optional<std::size_t> member_of(const ResolvedType& type,
                                                              std::string_view name)
    {
        if (type.kind != ResolvedType::Kind::Structure) {
            return std::nullopt;
        }
        const auto& members = type.type->members;
        const auto found = std::ranges::find_if(members, [&](const Member& member) {
            return busbar::detail::is_same_ignoring_case(member.name, name);
        });
        return found != members.end()
                   ? std::optional{static_cast<std::size_t>(found - members.begin())}
                   : std::nullopt;
    }

    [[nodiscard]] static FoundLabel leaf(const ResolvedType& type, bool is_text, std::byte* at)
    {
        if (type.kind == ResolvedType::Kind::Structure) {
            return refused(LabelError::NotAName);
        }
        const auto label = label_type_of(type.elementary);
        if (!label) {
            return refused(LabelError::UnsupportedType);
        }
        FoundLabel found{.error = LabelError::None, .kind = {*label}, .at = at};
        found.kind.length = type.string_length;
        if (is_text) {
            found.kind.type = LabelType::UnicodeString;
            found.kind.length = static_cast<std::uint32_t>(text_units(type) - 1);
        }
        return found;
    }

    [[nodiscard]] static FoundLabel timer_leaf(LabelType timer, const LabelName::Part& last,
                                               std::byte* at)
    {
        const backend::TimerPart part = backend::timer_part(last);
        return part == backend::TimerPart::None // the name indexes something that is not an array
                   ? refused(LabelError::Unknown)
                   : FoundLabel{.error = LabelError::None, .kind = {timer, part}, .at = at};
    }

    const LabelProgram* program_;
    const LabelName* name_;
};

} // namespace

FoundLabel find_label(const LabelProgram& program, std::string_view name)
{
    const auto parsed = backend::parse_label_name(name);
    return parsed ? LabelWalk{program, *parsed}.find() : refused(LabelError::NotAName);
}

} // namespace busbar::controller::detail
