#include <busbar/controller/label_conversion.hpp>

#include "controller/conversion/conversion_functions.hpp"
#include "core/visit_built_in.hpp"

namespace busbar::controller {

namespace {

using backend::LabelKind;
using backend::LabelType;

/// "If the number of characters is odd, one less is valid": of a String, not of UTF-16 (note 7).
std::uint32_t valid_characters(const LabelKind& label)
{
    return label.type == LabelType::String ? label.length - label.length % 2 : label.length;
}

} // namespace

LabelConversion::LabelConversion(LeafType leaf, Functions functions, const LabelKind& label,
                                 const ConversionOptions& options)
    : functions_{functions}, leaf_{leaf}, label_size_{static_cast<std::uint32_t>(
                                              backend::size_of(label))},
      characters_{backend::is_text(label.type) ? valid_characters(label) : 0},
      offset_seconds_{std::int64_t{options.utc_offset_minutes} * 60}
{
}

std::optional<LabelConversion> LabelConversion::of(LeafType leaf, const LabelKind& label,
                                                   const ConversionOptions& options)
{
    if (assignability(leaf, label.type, label.part) == Assignability::No) {
        return std::nullopt;
    }
    const LabelType type = backend::value_type(label.type, label.part);
    return LabelConversion{leaf, detail::conversion_functions(leaf.built_in, type), label, options};
}

std::optional<LabelConversion> LabelConversion::scaled(LeafType leaf, const LabelKind& label,
                                                       double factor, double offset)
{
    if (!is_scalable(leaf) || !is_scalable(label.type, label.part)) {
        return std::nullopt;
    }
    const LabelType type = backend::value_type(label.type, label.part);
    LabelConversion made{leaf, detail::scaled_functions(leaf.built_in, type), label, {}};
    made.factor_ = factor;
    made.offset_ = offset;
    return made;
}

Result<Variant> LabelConversion::read(std::span<const std::byte> label) const
{
    if (label.size() != label_size_) {
        return fail(status::Bad_InternalError);
    }
    return busbar::detail::visit_built_in(leaf_.built_in, [&](auto tag) -> Result<Variant> {
        typename decltype(tag)::type value{};
        const StatusCode status = read(label.data(), &value);
        if (status.is_bad()) {
            return fail(status);
        }
        if constexpr (std::is_same_v<decltype(value), Variant>) {
            return value;
        } else {
            return Variant{std::move(value)};
        }
    });
}

StatusCode LabelConversion::write(const Variant& value, std::span<std::byte> label) const
{
    if (label.size() != label_size_) {
        return status::Bad_InternalError;
    }
    return busbar::detail::visit_built_in(leaf_.built_in, [&](auto tag) -> StatusCode {
        const auto* const scalar = value.get_if<typename decltype(tag)::type>();
        return scalar == nullptr ? status::Bad_TypeMismatch : write(scalar, label.data());
    });
}

} // namespace busbar::controller
