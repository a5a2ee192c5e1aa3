#include <busbar/core/variant.hpp>

#include <array>
#include <cmath>
#include <cstring>

#include <busbar/core/types.hpp>

namespace busbar {

namespace {

template <typename T>
bool equal_values(const T& a, const T& b)
{
    if constexpr (std::is_floating_point_v<T>) {
        return a == b || (std::isnan(a) && std::isnan(b));
    } else {
        return a == b;
    }
}

template <typename T>
bool equal_arrays(const Array<T>& a, const Array<T>& b)
{
    if (a.is_null() != b.is_null() || a.size() != b.size()) {
        return false;
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!equal_values(a[i], b[i])) {
            return false;
        }
    }
    return true;
}

} // namespace

/// Operations on the content of a Variant, for one built-in type. All take the address of its
/// storage.
struct Variant::Operations {
    void (*destroy)(std::byte* storage, Kind kind);
    void (*copy)(std::byte* to, const std::byte* from, Kind kind);
    bool (*equal)(const Variant& a, const Variant& b);
    std::size_t (*size)(const Variant& value);
};

template <typename T>
struct Variant::OperationsOf {
    static constexpr bool scalar_inline = is_inline<T>;

    static void* boxed(std::byte* storage) { return *stored<void*>(storage); }
    static const void* boxed(const std::byte* storage) { return *stored<void* const>(storage); }
    static void set(std::byte* storage, void* object)
    {
        ::new (static_cast<void*>(storage)) void*(object);
    }

    static void destroy(std::byte* storage, Kind kind)
    {
        if (kind == Kind::Array) {
            std::destroy_at(stored<Array<T>>(storage));
        } else if (kind == Kind::Matrix) {
            delete static_cast<Matrix<T>*>(boxed(storage));
        } else if constexpr (scalar_inline) {
            std::destroy_at(stored<T>(storage));
        } else {
            delete static_cast<T*>(boxed(storage));
        }
    }
    static void copy(std::byte* to, const std::byte* from, Kind kind)
    {
        if (kind == Kind::Array) {
            ::new (static_cast<void*>(to)) Array<T>(*stored<const Array<T>>(from));
        } else if (kind == Kind::Matrix) {
            set(to, new Matrix<T>(*static_cast<const Matrix<T>*>(boxed(from))));
        } else if constexpr (scalar_inline) {
            ::new (static_cast<void*>(to)) T(*stored<const T>(from));
        } else {
            set(to, new T(*static_cast<const T*>(boxed(from))));
        }
    }
    static bool equal(const Variant& a, const Variant& b)
    {
        if (a.kind_ == Kind::Scalar) {
            return scalar_equal(a, b);
        }
        const auto left = a.dimensions();
        const auto right = b.dimensions();
        return std::equal(left.begin(), left.end(), right.begin(), right.end()) &&
               equal_arrays(*a.array_if<T>(), *b.array_if<T>());
    }
    static bool scalar_equal(const Variant& a, const Variant& b)
    {
        if constexpr (std::same_as<T, Variant>) {
            return false; // Part 6, 5.2.2.16: this scalar does not exist
        } else {
            return equal_values(*a.get_if<T>(), *b.get_if<T>());
        }
    }
    static std::size_t size(const Variant& value) { return value.array_if<T>()->size(); }

    static constexpr Operations table{destroy, copy, equal, size};
};

const Variant::Operations& Variant::operations() const
{
    // In the order of the built-in type ids, from Boolean on.
    static constexpr std::array<const Operations*, last_built_in_type> tables = {
        &OperationsOf<bool>::table,          &OperationsOf<std::int8_t>::table,
        &OperationsOf<std::uint8_t>::table,  &OperationsOf<std::int16_t>::table,
        &OperationsOf<std::uint16_t>::table, &OperationsOf<std::int32_t>::table,
        &OperationsOf<std::uint32_t>::table, &OperationsOf<std::int64_t>::table,
        &OperationsOf<std::uint64_t>::table, &OperationsOf<float>::table,
        &OperationsOf<double>::table,        &OperationsOf<String>::table,
        &OperationsOf<DateTime>::table,      &OperationsOf<Guid>::table,
        &OperationsOf<ByteString>::table,    &OperationsOf<XmlElement>::table,
        &OperationsOf<NodeId>::table,        &OperationsOf<ExpandedNodeId>::table,
        &OperationsOf<StatusCode>::table,    &OperationsOf<QualifiedName>::table,
        &OperationsOf<LocalizedText>::table, &OperationsOf<ExtensionObject>::table,
        &OperationsOf<DataValue>::table,     &OperationsOf<Variant>::table,
        &OperationsOf<DiagnosticInfo>::table};
    return *tables[static_cast<std::size_t>(type_) - 1];
}

Variant::Variant(const Variant& other)
{
    copy(other);
}

Variant& Variant::operator=(const Variant& other)
{
    if (this == &other) {
        return *this;
    }
    if (owns_memory() || other.owns_memory()) {
        *this = Variant{other}; // a copy, which may fail before anything changes
    } else {
        copy(other);
    }
    return *this;
}

void Variant::destroy()
{
    operations().destroy(storage_, kind_);
}

void Variant::copy(const Variant& other)
{
    if (other.owns_memory()) {
        other.operations().copy(storage_, other.storage_, other.kind_);
    } else {
        std::memcpy(storage_, other.storage_, sizeof storage_);
    }
    type_ = other.type_;
    kind_ = other.kind_;
}

std::span<const std::uint32_t> Variant::dimensions() const
{
    if (kind_ != Kind::Matrix) {
        return {};
    }
    return static_cast<const Array<std::uint32_t>*>(box())->span();
}

std::size_t Variant::array_size() const
{
    return is_array() ? operations().size(*this) : 0;
}

bool operator==(const Variant& a, const Variant& b)
{
    if (a.type_ != b.type_ || a.kind_ != b.kind_) {
        return false;
    }
    return a.is_null() || a.operations().equal(a, b);
}

} // namespace busbar
