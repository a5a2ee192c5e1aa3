#include <busbar/core/numeric_range.hpp>

#include <string>

#include "range_walk.hpp"
#include "text_range.hpp"
#include "visit_built_in.hpp"

namespace busbar {

namespace {

using Bounds = NumericRange::Bounds;

/// Returns Good, or the reason why `part` cannot replace the range `bounds`.
template <typename Text>
StatusCode check_text(const Text& target, const Bounds& bounds, const Text& part)
{
    if (detail::skip(target, 0, bounds.last) == target.size()) {
        return status::Bad_IndexRangeNoData;
    }
    return detail::length_of(part) == bounds.count() ? StatusCode{}
                                                     : status::Bad_IndexRangeDataMismatch;
}

/// A String may become longer or shorter in bytes, but not in characters.
template <typename Text>
void replace_text(Text& target, const Bounds& bounds, const Text& part)
{
    std::string bytes{detail::bytes_of(target)};
    const std::size_t first = detail::skip(target, 0, bounds.first);
    const std::size_t end = detail::skip(target, first, bounds.count());
    bytes.replace(first, end - first, detail::bytes_of(part));
    detail::assign(target, bytes);
}

template <typename T>
StatusCode write_scalar(Variant& target, std::span<const Bounds> bounds, const Variant& part)
{
    if constexpr (detail::is_text<T>) {
        const T* from = part.get_if<T>();
        if (from == nullptr) {
            return status::Bad_IndexRangeDataMismatch;
        }
        if (bounds.size() != 1) {
            return status::Bad_IndexRangeNoData;
        }
        T& to = *target.get_if<T>();
        const StatusCode checked = check_text(to, bounds[0], *from);
        if (checked.is_good()) {
            replace_text(to, bounds[0], *from);
        }
        return checked;
    }
    return status::Bad_IndexRangeNoData;
}

/// Every bound must be inside: a write is all or nothing (Part 4, 5.11.4.2).
bool is_inside(std::span<const Bounds> bounds, const detail::Box& box)
{
    for (std::size_t i = 0; i < box.rank; ++i) {
        if (bounds[i].last >= box.size[i]) {
            return false;
        }
    }
    return true;
}

/// Applies to a single element as well: a range selects an array (Part 4, 7.27).
template <typename T>
std::span<const T> elements_of(const Variant& part)
{
    if (const Array<T>* array = part.array_if<T>()) {
        return array->span();
    }
    return {};
}

bool fits(const detail::Box& box, const Variant& part, std::size_t elements)
{
    const auto dimensions = part.dimensions();
    if (box.elements() != elements || dimensions.empty()) {
        return box.elements() == elements;
    }
    return std::equal(dimensions.begin(), dimensions.end(), box.count.begin(),
                      box.count.begin() + static_cast<std::ptrdiff_t>(box.rank));
}

/// Makes two passes if texts are cut, so that a mismatch changes nothing.
template <typename T>
StatusCode replace_elements(Array<T>& to, const detail::Box& box, const Bounds* cut,
                            std::span<const T> from)
{
    std::size_t next = 0;
    if constexpr (detail::is_text<T>) {
        if (cut != nullptr) {
            StatusCode checked;
            detail::walk(box, [&](std::size_t index) {
                checked = check_text(to[index], *cut, from[next++]);
                return checked.is_good();
            });
            next = 0;
            return checked.is_good() &&
                           detail::walk(box,
                                        [&](std::size_t index) {
                                            replace_text(to[index], *cut, from[next++]);
                                            return true;
                                        })
                       ? StatusCode{}
                       : checked;
        }
    }
    detail::walk(box, [&](std::size_t index) {
        to[index] = from[next++];
        return true;
    });
    return {};
}

template <typename T>
StatusCode write_array(Variant& target, std::span<const Bounds> bounds, const Variant& part)
{
    const std::size_t rank = std::max<std::size_t>(target.dimensions().size(), 1);
    const Bounds* cut = nullptr;
    if (detail::is_text<T> && bounds.size() == rank + 1) {
        cut = &bounds[rank];
        bounds = bounds.first(rank);
    }
    Array<T>& to = *target.array_if<T>();
    detail::Box box;
    if (!detail::make_box(bounds, to.size(), target.dimensions(), box) || !is_inside(bounds, box)) {
        return status::Bad_IndexRangeNoData;
    }
    const std::span<const T> from = elements_of<T>(part);
    if (!fits(box, part, from.size())) {
        return status::Bad_IndexRangeDataMismatch;
    }
    return replace_elements(to, box, cut, from);
}

} // namespace

Result<void> write_range(Variant& target, const NumericRange& range, const Variant& part)
{
    if (range.empty()) {
        target = part;
        return {};
    }
    if (target.is_null()) {
        return fail(status::Bad_IndexRangeNoData);
    }
    if (target.type() != part.type()) {
        return fail(status::Bad_TypeMismatch);
    }
    const StatusCode written = detail::visit_built_in(target.type(), [&](auto tag) {
        using T = typename decltype(tag)::type;
        return target.is_array() ? write_array<T>(target, range.bounds(), part)
                                 : write_scalar<T>(target, range.bounds(), part);
    });
    if (!written.is_good()) {
        return fail(written);
    }
    return {};
}

} // namespace busbar
