#include "filter_conversion.hpp"

#include "core/visit_built_in.hpp"

namespace busbar::server::detail {

namespace {

/// A value converted to a type; copied only if it has another one.
class Converted {
public:
    Converted(const Variant& value, BuiltInType type)
        : storage_{value.type() == type ? Variant{} : convert_implicitly(value, type)},
          value_{value.type() == type ? &value : &storage_}
    {
    }
    Converted(const Converted&) = delete;
    Converted& operator=(const Converted&) = delete;

    [[nodiscard]] const Variant& operator*() const { return *value_; }

private:
    Variant storage_;
    const Variant* value_;
};

bool is_null(const String& value)
{
    return value.is_null();
}
bool is_null(const ByteString& value)
{
    return value.is_null();
}
bool is_null(const NodeId& value)
{
    return value.is_null();
}
bool is_null(const ExpandedNodeId& value)
{
    return value.node_id.is_null() && value.is_local();
}
bool is_null(const QualifiedName& value)
{
    return value.is_null();
}
bool is_null(const LocalizedText& value)
{
    return value.locale.empty() && value.text.empty();
}
bool is_null(const ExtensionObject& value)
{
    return value.is_null();
}
bool is_null(DateTime value)
{
    return value.is_null();
}
bool is_null(const Guid& value)
{
    return value == Guid{};
}

template <typename T>
concept Nullable = requires(const T& value)
{
    is_null(value);
};

/// True for values of one type and, except for arrays, one shape.
bool are_same(const Variant& a, const Variant& b)
{
    if (a.is_scalar() && b.is_scalar()) {
        return busbar::detail::visit_built_in(a.type(), [&](auto tag) {
            using T = typename decltype(tag)::type;
            if constexpr (std::is_floating_point_v<T>) {
                return *a.get_if<T>() == *b.get_if<T>();
            } else if constexpr (std::is_same_v<T, String> || std::is_same_v<T, ByteString>) {
                // Null equals empty (Part 4, 7.7.3).
                return (a.get_if<T>()->empty() && b.get_if<T>()->empty()) || a == b;
            } else {
                return a == b;
            }
        });
    }
    const bool are_empty = a.is_array() && b.is_array() && a.array_size() + b.array_size() == 0;
    return are_empty || a == b;
}

std::partial_ordering order_same(const Variant& a, const Variant& b)
{
    if (!a.is_scalar() || !b.is_scalar()) {
        return std::partial_ordering::unordered;
    }
    return busbar::detail::visit_built_in(a.type(), [&](auto tag) {
        using T = typename decltype(tag)::type;
        constexpr bool is_number = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;
        if constexpr (is_number || std::is_same_v<T, DateTime>) {
            return std::partial_ordering{*a.get_if<T>() <=> *b.get_if<T>()};
        } else {
            return std::partial_ordering::unordered;
        }
    });
}

} // namespace

bool is_null_value(const Variant& value)
{
    if (value.is_null()) {
        return true;
    }
    return busbar::detail::visit_built_in(value.type(), [&](auto tag) {
        using T = typename decltype(tag)::type;
        if (const auto* const values = value.array_if<T>()) {
            return values->is_null();
        }
        if constexpr (Nullable<T>) {
            return is_null(*value.get_if<T>());
        } else {
            return false;
        }
    });
}

std::optional<bool> are_equal(const Variant& a, const Variant& b)
{
    if (a.is_null() || b.is_null()) {
        return std::nullopt;
    }
    Variant storage[2];
    const Variant& left = b.is_scalar() ? as_scalar(a, storage[0]) : a;
    const Variant& right = a.is_scalar() ? as_scalar(b, storage[1]) : b;
    const BuiltInType type = common_type(left.type(), right.type());
    if (type == BuiltInType::Null) {
        return false;
    }
    const Converted one{left, type};
    const Converted other{right, type};
    return !(*one).is_null() && !(*other).is_null() && are_same(*one, *other);
}

std::partial_ordering order(const Variant& a, const Variant& b)
{
    Variant storage[2];
    const Variant& left = as_scalar(a, storage[0]);
    const Variant& right = as_scalar(b, storage[1]);
    const BuiltInType type = common_type(left.type(), right.type());
    return order_same(*Converted{left, type}, *Converted{right, type});
}

bool is_between(const Variant& value, const Variant& first, const Variant& last)
{
    Variant storage[3];
    const Variant& middle = as_scalar(value, storage[0]);
    const Variant& low = as_scalar(first, storage[1]);
    const Variant& high = as_scalar(last, storage[2]);
    const BuiltInType type = common_type(common_type(middle.type(), low.type()), high.type());
    const Converted converted{middle, type};
    return std::is_gteq(order_same(*converted, *Converted{low, type})) &&
           std::is_lteq(order_same(*converted, *Converted{high, type}));
}

} // namespace busbar::server::detail
