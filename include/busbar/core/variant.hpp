#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/array.hpp>
#include <busbar/core/built_in_type.hpp>

namespace busbar {

/// Variant (Part 6, 5.2.2.16): a scalar, an array or a matrix of one built-in type, or null.
///
/// Scalars of up to 16 bytes (numbers, String, Guid, ...) and arrays' headers lie in the Variant
/// itself; others are boxed. A matrix is its elements in row-major order with two or more
/// dimensions. Float and Double compare NaN equal to NaN. Thread-compatible.
class BUSBAR_API Variant {
public:
    Variant() = default;
    Variant(const Variant& other);
    Variant(Variant&& other) noexcept { take(other); }
    Variant& operator=(const Variant& other);
    Variant& operator=(Variant&& other) noexcept
    {
        if (this != &other) {
            // The destroyed value may contain `other`.
            Variant taken{std::move(other)};
            if (owns_memory()) {
                destroy();
            }
            take(taken);
        }
        return *this;
    }
    ~Variant()
    {
        if (owns_memory()) {
            destroy();
        }
    }

    /// A scalar. A Variant is never the scalar of a Variant (Part 6, 5.2.2.16).
    template <BuiltIn T>
    requires(!std::same_as<T, Variant>) Variant(T value)
        : type_{built_in_type_of<T>}, kind_{Kind::Scalar}
    {
        if constexpr (is_inline<T>) {
            ::new (static_cast<void*>(storage_)) T(std::move(value));
        } else {
            set_box(new T(std::move(value)));
        }
    }
    Variant(const char* text) : Variant{String{text}} {}
    /// The value of an enumeration, as Int32 or the option set's unsigned type.
    template <typename E>
    requires std::is_enum_v<E> Variant(E value)
        : Variant{static_cast<std::underlying_type_t<E>>(value)}
    {
    }
    /// An array, null if `values` is null.
    template <BuiltIn T>
    Variant(Array<T> values) : type_{built_in_type_of<T>}, kind_{Kind::Array}
    {
        ::new (static_cast<void*>(storage_)) Array<T>(std::move(values));
    }
    /// A matrix. The product of `dimensions` must be the number of `values`; with fewer than two
    /// dimensions the result is an array.
    template <BuiltIn T>
    [[nodiscard]] static Variant matrix(Array<T> values, Array<std::uint32_t> dimensions)
    {
        if (dimensions.size() < 2) {
            return Variant{std::move(values)};
        }
        Variant result;
        result.type_ = built_in_type_of<T>;
        result.kind_ = Kind::Matrix;
        result.set_box(new Matrix<T>{std::move(dimensions), std::move(values)});
        return result;
    }

    [[nodiscard]] bool is_null() const { return kind_ == Kind::Null; }
    [[nodiscard]] bool is_scalar() const { return kind_ == Kind::Scalar; }
    /// True for arrays and matrices.
    [[nodiscard]] bool is_array() const { return kind_ == Kind::Array || kind_ == Kind::Matrix; }
    [[nodiscard]] bool is_matrix() const { return kind_ == Kind::Matrix; }
    /// Null, or the type of the scalar or of the elements.
    [[nodiscard]] BuiltInType type() const { return type_; }
    /// The dimensions of a matrix, none for anything else.
    [[nodiscard]] std::span<const std::uint32_t> dimensions() const;
    /// The number of elements of an array or matrix; 0 for anything else.
    [[nodiscard]] std::size_t array_size() const;

    /// The scalar if it is a T, else null. Valid until the Variant changes.
    template <BuiltIn T>
    [[nodiscard]] const T* get_if() const
    {
        if (kind_ != Kind::Scalar || type_ != built_in_type_of<T>) {
            return nullptr;
        }
        if constexpr (is_inline<T>) {
            return stored<const T>(storage_);
        } else {
            return static_cast<const T*>(box());
        }
    }
    template <BuiltIn T>
    [[nodiscard]] T* get_if()
    {
        return const_cast<T*>(std::as_const(*this).get_if<T>());
    }
    /// The scalar if it is a T, else `otherwise`.
    template <BuiltIn T>
    [[nodiscard]] T value_or(T otherwise) const
    {
        const T* value = get_if<T>();
        return value != nullptr ? *value : std::move(otherwise);
    }
    /// The elements of an array or matrix of T, else null. Valid until the Variant changes.
    template <BuiltIn T>
    [[nodiscard]] const Array<T>* array_if() const
    {
        if (type_ != built_in_type_of<T> || !is_array()) {
            return nullptr;
        }
        return kind_ == Kind::Array ? stored<const Array<T>>(storage_)
                                    : &static_cast<const Matrix<T>*>(box())->values;
    }
    template <BuiltIn T>
    [[nodiscard]] Array<T>* array_if()
    {
        return const_cast<Array<T>*>(std::as_const(*this).array_if<T>());
    }

    friend BUSBAR_API bool operator==(const Variant& a, const Variant& b);

private:
    enum class Kind : std::uint8_t { Null, Scalar, Array, Matrix };

    template <typename T>
    struct Matrix {
        Array<std::uint32_t> dimensions; // first in every Matrix, for every T
        Array<T> values;
    };
    template <typename T>
    static constexpr bool is_inline = std::is_trivially_copyable_v<T> || std::same_as<T, String> ||
                                      std::same_as<T, ByteString> || std::same_as<T, XmlElement>;
    struct Operations;
    template <typename T>
    struct OperationsOf;

    [[nodiscard]] const Operations& operations() const;
    [[nodiscard]] bool owns_memory() const
    {
        return kind_ > Kind::Scalar ||
               (kind_ == Kind::Scalar && type_ >= BuiltInType::String &&
                type_ != BuiltInType::DateTime && type_ != BuiltInType::Guid &&
                type_ != BuiltInType::StatusCode);
    }
    void destroy();
    void copy(const Variant& other);
    /// Moves as bytes, which all that a Variant holds allows: numbers, blobs, headers, pointers.
    void take(Variant& other) noexcept
    {
        std::memcpy(storage_, other.storage_, sizeof storage_);
        type_ = std::exchange(other.type_, BuiltInType::Null);
        kind_ = std::exchange(other.kind_, Kind::Null);
    }
    void set_box(void* object) { ::new (static_cast<void*>(storage_)) void*(object); }
    [[nodiscard]] void* box() const { return *stored<void* const>(storage_); }
    /// Returns the object in a Variant's storage, which is aligned for every type.
    template <typename T>
    [[nodiscard]] static T* stored(std::byte* storage)
    {
        return std::launder(static_cast<T*>(static_cast<void*>(storage)));
    }
    template <typename T>
    [[nodiscard]] static T* stored(const std::byte* storage)
    {
        return std::launder(static_cast<T*>(static_cast<const void*>(storage)));
    }

    alignas(8) std::byte storage_[16]{};
    BuiltInType type_{BuiltInType::Null};
    Kind kind_{Kind::Null};
};

static_assert(sizeof(Variant) == 24);

} // namespace busbar
