#include <busbar/core/numeric_range.hpp>

#include "range_walk.hpp"
#include "text_range.hpp"
#include "visit_built_in.hpp"

namespace busbar {

namespace {

using Bounds = NumericRange::Bounds;

template <typename Text>
bool cut_text(const Text& text, const Bounds& bounds, Text& part)
{
    const std::size_t first = detail::skip(text, 0, bounds.first);
    if (first == text.size()) {
        return false;
    }
    const std::size_t end = detail::skip(text, first, bounds.count());
    detail::assign(part, detail::bytes_of(text).substr(first, end - first));
    return true;
}

template <typename T>
Result<Variant> read_scalar(const Variant& value, std::span<const Bounds> bounds)
{
    if constexpr (detail::is_text<T>) {
        T part;
        if (bounds.size() == 1 && cut_text(*value.get_if<T>(), bounds[0], part)) {
            return Variant{std::move(part)};
        }
    }
    return fail(status::Bad_IndexRangeNoData);
}

/// Elements of a text array may be too short for the cut: they come back as null; with no element
/// left there is no data.
template <typename T>
bool cut_elements(const Array<T>& from, const detail::Box& box, const Bounds* cut, Array<T>& part)
{
    bool any = cut == nullptr;
    part.reserve(box.elements());
    detail::walk(box, [&](std::size_t index) {
        if constexpr (detail::is_text<T>) {
            if (cut != nullptr) {
                any = cut_text(from[index], *cut, part.emplace_back()) || any;
                return true;
            }
        }
        part.push_back(from[index]);
        return true;
    });
    return any;
}

template <typename T>
Result<Variant> read_array(const Variant& value, std::span<const Bounds> bounds)
{
    const std::size_t rank = std::max<std::size_t>(value.dimensions().size(), 1);
    const Bounds* cut = nullptr;
    if (detail::is_text<T> && bounds.size() == rank + 1) {
        cut = &bounds[rank];
        bounds = bounds.first(rank);
    }
    const Array<T>& from = *value.array_if<T>();
    detail::Box box;
    Array<T> part;
    if (!detail::make_box(bounds, from.size(), value.dimensions(), box) ||
        !cut_elements(from, box, cut, part)) {
        return fail(status::Bad_IndexRangeNoData);
    }
    Array<std::uint32_t> dimensions;
    for (std::size_t i = 0; i < value.dimensions().size(); ++i) {
        dimensions.push_back(static_cast<std::uint32_t>(box.count[i]));
    }
    return Variant::matrix(std::move(part), std::move(dimensions));
}

} // namespace

Result<Variant> read_range(const Variant& value, const NumericRange& range)
{
    if (range.empty()) {
        return value;
    }
    if (value.is_null()) {
        return fail(status::Bad_IndexRangeNoData);
    }
    return detail::visit_built_in(value.type(), [&](auto tag) {
        using T = typename decltype(tag)::type;
        return value.is_array() ? read_array<T>(value, range.bounds())
                                : read_scalar<T>(value, range.bounds());
    });
}

} // namespace busbar
