#pragma once

#include <exception>
#include <new>
#include <type_traits>
#include <utility>

#include <busbar/core/api.hpp>

namespace busbar {

/// The error that an Expected is made from: `return Unexpected{error};`.
template <typename E>
class Unexpected {
public:
    constexpr explicit Unexpected(E error) : error_{std::move(error)} {}

    [[nodiscard]] constexpr const E& error() const& noexcept { return error_; }
    [[nodiscard]] constexpr E&& error() && noexcept { return std::move(error_); }

private:
    E error_;
};

/// Thrown by Expected::value() if there is an error instead.
class BUSBAR_API BadExpectedAccess final : public std::exception {
public:
    [[nodiscard]] const char* what() const noexcept override
    {
        return "an Expected has an error where its value was asked for";
    }
};

template <typename T, typename E>
class Expected;

namespace detail {

struct Nothing {};
struct AsValue {};
struct AsError {};

template <typename T>
inline constexpr bool is_expected_v = false;
template <typename T, typename E>
inline constexpr bool is_expected_v<Expected<T, E>> = true;
template <typename T>
inline constexpr bool is_unexpected_v = false;
template <typename E>
inline constexpr bool is_unexpected_v<Unexpected<E>> = true;

/// Holds a value or an error that can be copied as bytes, so that a function returns it in
/// registers.
template <typename T, typename E,
          bool IsTrivial = std::is_trivially_copyable_v<T>&& std::is_trivially_copyable_v<E>>
class ExpectedStorage {
protected:
    constexpr explicit ExpectedStorage(AsValue /*as*/) : value_(), has_value_{true} {}
    template <typename U>
    constexpr explicit ExpectedStorage(AsValue /*as*/, U&& value)
        : value_(static_cast<T>(std::forward<U>(value))), has_value_{true}
    {
    }
    template <typename Error>
    constexpr explicit ExpectedStorage(AsError /*as*/, Error&& error)
        : error_(std::forward<Error>(error)), has_value_{false}
    {
    }

    union {
        T value_;
        E error_;
    };
    bool has_value_;
};

/// Holds a value or an error. They are moved without exceptions, so that an assignment cannot leave
/// neither.
template <typename T, typename E>
class ExpectedStorage<T, E, false> {
protected:
    constexpr explicit ExpectedStorage(AsValue /*as*/) : value_(), has_value_{true} {}
    template <typename U>
    constexpr explicit ExpectedStorage(AsValue /*as*/, U&& value)
        : value_(static_cast<T>(std::forward<U>(value))), has_value_{true}
    {
    }
    template <typename Error>
    constexpr explicit ExpectedStorage(AsError /*as*/, Error&& error)
        : error_(std::forward<Error>(error)), has_value_{false}
    {
    }
    ExpectedStorage(const ExpectedStorage& other) : has_value_{other.has_value_}
    {
        if (has_value_) {
            ::new (static_cast<void*>(&value_)) T(other.value_);
        } else {
            ::new (static_cast<void*>(&error_)) E(other.error_);
        }
    }
    ExpectedStorage(ExpectedStorage&& other) noexcept { take(other); }
    ExpectedStorage& operator=(const ExpectedStorage& other)
    {
        if (this != &other) {
            ExpectedStorage copy{other};
            destroy();
            take(copy);
        }
        return *this;
    }
    ExpectedStorage& operator=(ExpectedStorage&& other) noexcept
    {
        if (this != &other) {
            destroy();
            take(other);
        }
        return *this;
    }
    ~ExpectedStorage() { destroy(); }

    union {
        T value_;
        E error_;
    };
    bool has_value_;

private:
    void take(ExpectedStorage& other) noexcept
    {
        static_assert(std::is_nothrow_move_constructible_v<T>);
        static_assert(std::is_nothrow_move_constructible_v<E>);
        has_value_ = other.has_value_;
        if (has_value_) {
            ::new (static_cast<void*>(&value_)) T(std::move(other.value_));
        } else {
            ::new (static_cast<void*>(&error_)) E(std::move(other.error_));
        }
    }
    void destroy() noexcept
    {
        if (has_value_) {
            value_.~T();
        } else {
            error_.~E();
        }
    }
};

/// Deletes the copy operations, so that type traits see it too, if value or error cannot be copied.
template <bool IsCopied>
struct CopyOfExpected {
};
template <>
struct CopyOfExpected<false> {
    CopyOfExpected() = default;
    CopyOfExpected(const CopyOfExpected&) = delete;
    CopyOfExpected(CopyOfExpected&&) = default;
    CopyOfExpected& operator=(const CopyOfExpected&) = delete;
    CopyOfExpected& operator=(CopyOfExpected&&) = default;
    ~CopyOfExpected() = default;
};

template <typename T>
using ValueOfExpected = std::conditional_t<std::is_void_v<T>, Nothing, T>;

} // namespace detail

/// A value, or the error that says why there is none. It has the part of C++23's std::expected that
/// is used here, under the same names, and includes little.
///
/// `T` may be void. Both are moved without exceptions. Asking for the value if there is an error,
/// or for the error if there is a value, is undefined.
template <typename T, typename E>
class [[nodiscard]] Expected
    : private detail::ExpectedStorage<detail::ValueOfExpected<T>, E>,
      private detail::CopyOfExpected<std::is_copy_constructible_v<detail::ValueOfExpected<T>> &&
                                     std::is_copy_constructible_v<E>> {
    using Storage = detail::ExpectedStorage<detail::ValueOfExpected<T>, E>;
    using Value = detail::ValueOfExpected<T>;

public:
    using value_type = T;
    using error_type = E;

    /// Holds the value T{}.
    constexpr Expected() requires std::is_default_constructible_v<Value>
        : Storage{detail::AsValue{}}
    {
    }
    template <typename U = Value>
    requires(!std::is_void_v<T> && std::is_constructible_v<Value, U> &&
             !detail::is_expected_v<std::remove_cvref_t<U>> &&
             !detail::is_unexpected_v<
                 std::remove_cvref_t<U>>) constexpr explicit(!std::is_convertible_v<U, Value>)
        Expected(U&& value)
        : Storage{detail::AsValue{}, std::forward<U>(value)}
    {
    }
    template <typename G>
    requires std::is_constructible_v<E, const G&>
    constexpr Expected(const Unexpected<G>& unexpected)
        : Storage{detail::AsError{}, unexpected.error()}
    {
    }
    template <typename G>
    requires std::is_constructible_v<E, G>
    constexpr Expected(Unexpected<G>&& unexpected)
        : Storage{detail::AsError{}, std::move(unexpected).error()}
    {
    }

    [[nodiscard]] constexpr bool has_value() const noexcept { return this->has_value_; }
    constexpr explicit operator bool() const noexcept { return this->has_value_; }

    /// The value, which must exist.
    [[nodiscard]] constexpr Value& operator*() & noexcept requires(!std::is_void_v<T>)
    {
        return this->value_;
    }
    [[nodiscard]] constexpr const Value& operator*() const& noexcept requires(!std::is_void_v<T>)
    {
        return this->value_;
    }
    [[nodiscard]] constexpr Value&& operator*() && noexcept requires(!std::is_void_v<T>)
    {
        return std::move(this->value_);
    }
    [[nodiscard]] constexpr Value* operator->() noexcept requires(!std::is_void_v<T>)
    {
        return &this->value_;
    }
    [[nodiscard]] constexpr const Value* operator->() const noexcept requires(!std::is_void_v<T>)
    {
        return &this->value_;
    }

#if defined(__cpp_exceptions)
    /// Returns the value. Throws BadExpectedAccess if there is none; absent from builds without
    /// exceptions.
    constexpr Value& value() &
    {
        require();
        return this->value_;
    }
    constexpr const Value& value() const&
    {
        require();
        return this->value_;
    }
    constexpr Value&& value() &&
    {
        require();
        return std::move(this->value_);
    }
#endif

    /// The error; there must not be a value.
    [[nodiscard]] constexpr E& error() & noexcept
    {
        return this->error_;
    }
    [[nodiscard]] constexpr const E& error() const& noexcept
    {
        return this->error_;
    }
    [[nodiscard]] constexpr E&& error() && noexcept
    {
        return std::move(this->error_);
    }

    /// The value, or `other` if there is none.
    template <typename U>
    [[nodiscard]] constexpr Value value_or(U&& other) const&
    {
        return this->has_value_ ? this->value_ : static_cast<Value>(std::forward<U>(other));
    }
    template <typename U>
    [[nodiscard]] constexpr Value value_or(U&& other) &&
    {
        return this->has_value_ ? std::move(this->value_)
                                : static_cast<Value>(std::forward<U>(other));
    }

    /// Returns next(value), which is an Expected with the same error type, or the error.
    template <typename Next>
    constexpr auto and_then(Next&& next) const&
    {
        return then(*this, std::forward<Next>(next));
    }
    template <typename Next>
    constexpr auto and_then(Next&& next) &&
    {
        return then(std::move(*this), std::forward<Next>(next));
    }
    /// Returns next(value) as an Expected, or the error.
    template <typename Next>
    constexpr auto transform(Next&& next) const&
    {
        return and_then(made_by(next));
    }
    template <typename Next>
    constexpr auto transform(Next&& next) &&
    {
        return std::move(*this).and_then(made_by(next));
    }
    /// Returns the value, or next(error) as the error.
    template <typename Next>
    constexpr auto transform_error(Next&& next) &&
    {
        using Made = Expected<T, std::remove_cvref_t<decltype(next(std::declval<E>()))>>;
        if (!this->has_value_) {
            return Made{Unexpected{next(std::move(this->error_))}};
        }
        if constexpr (std::is_void_v<T>) {
            return Made{};
        } else {
            return Made{std::move(this->value_)};
        }
    }

    friend constexpr bool operator==(const Expected& a,
                                     const Expected& b) requires(!std::is_void_v<T>)
    {
        return a.has_value_ == b.has_value_ &&
               (a.has_value_ ? a.value_ == b.value_ : a.error_ == b.error_);
    }
    template <typename U>
    requires(!std::is_void_v<T> && std::is_convertible_v<const U&, Value> &&
             !detail::is_expected_v<U> && !detail::is_unexpected_v<U>) friend constexpr bool
    operator==(const Expected& a, const U& b)
    {
        return a.has_value_ && a.value_ == b;
    }

private:
    template <typename Self, typename Next>
    static constexpr auto then(Self&& self, Next&& next)
    {
        const auto call = [&]() -> decltype(auto) {
            if constexpr (std::is_void_v<T>) {
                return next();
            } else {
                return next(*std::forward<Self>(self));
            }
        };
        using Made = std::remove_cvref_t<decltype(call())>;
        return self.has_value_ ? call() : Made{Unexpected<E>{std::forward<Self>(self).error()}};
    }
    template <typename Next>
    static constexpr auto made_by(Next& next)
    {
        return [&next](auto&&... value) {
            using Made = decltype(next(std::forward<decltype(value)>(value)...));
            if constexpr (std::is_void_v<Made>) {
                next(std::forward<decltype(value)>(value)...);
                return Expected<void, E>{};
            } else {
                return Expected<std::remove_cvref_t<Made>, E>{
                    next(std::forward<decltype(value)>(value)...)};
            }
        };
    }
#if defined(__cpp_exceptions)
    constexpr void require() const
    {
        if (!this->has_value_) {
            throw BadExpectedAccess{};
        }
    }
#endif
};

} // namespace busbar
