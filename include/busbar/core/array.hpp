#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

#include <busbar/core/detail/large_memory.hpp>

namespace busbar {

/// A growable array of up to 2^32-1 elements in sixteen bytes that may be null.
///
/// A default-constructed Array is null, which Part 6, 5.2.5 encodes with the length -1. Any call
/// that sets its size, even to 0, makes it not null. Null and empty compare unequal. Iterators and
/// spans are valid until the next change of size. Thread-compatible.
template <typename T>
class Array {
public:
    using value_type = T;
    using iterator = T*;
    using const_iterator = const T*;

    constexpr Array() = default;
    // The constructors delegate, so that the destructor runs if one of them throws.
    explicit Array(std::size_t size) : Array() { resize(size); }
    Array(std::initializer_list<T> values) : Array() { assign(values.begin(), values.end()); }
    explicit Array(std::span<const T> values) : Array() { assign(values.begin(), values.end()); }
    Array(const Array& other) : Array()
    {
        if (!other.is_null()) {
            assign(other.begin(), other.end());
        }
    }
    Array(Array&& other) noexcept
        : data_{std::exchange(other.data_, nullptr)}, size_{std::exchange(other.size_, 0)},
          capacity_{std::exchange(other.capacity_, 0)}
    {
    }
    Array& operator=(const Array& other)
    {
        if (this != &other) {
            Array copy(other); // braces would make an Array<Variant> with `other` as its element
            swap(copy);
        }
        return *this;
    }
    Array& operator=(Array&& other) noexcept
    {
        Array taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~Array() { reset(); }

    [[nodiscard]] constexpr bool is_null() const { return data_ == nullptr; }
    [[nodiscard]] constexpr bool empty() const { return size_ == 0; }
    [[nodiscard]] constexpr std::size_t size() const { return size_; }
    [[nodiscard]] constexpr std::size_t capacity() const { return capacity_; }

    [[nodiscard]] T* data() { return data_; }
    [[nodiscard]] const T* data() const { return data_; }
    [[nodiscard]] T* begin() { return data_; }
    [[nodiscard]] T* end() { return data_ + size_; }
    [[nodiscard]] const T* begin() const { return data_; }
    [[nodiscard]] const T* end() const { return data_ + size_; }
    [[nodiscard]] T& operator[](std::size_t index) { return data_[index]; }
    [[nodiscard]] const T& operator[](std::size_t index) const { return data_[index]; }
    [[nodiscard]] T& front() { return data_[0]; }
    [[nodiscard]] const T& front() const { return data_[0]; }
    [[nodiscard]] T& back() { return data_[size_ - 1]; }
    [[nodiscard]] const T& back() const { return data_[size_ - 1]; }
    [[nodiscard]] std::span<T> span() { return {data_, size_}; }
    [[nodiscard]] std::span<const T> span() const { return {data_, size_}; }

    /// Makes the array null and frees its memory.
    void reset() noexcept
    {
        if (data_ != nullptr) {
            destroy(data_, size_);
            deallocate(data_, capacity_);
        }
        data_ = nullptr;
        size_ = capacity_ = 0;
    }
    /// Makes the array empty, not null; keeps its memory.
    void clear()
    {
        reserve(1);
        destroy(data_, size_);
        size_ = 0;
    }
    /// Makes room for `capacity` elements; the array is not null afterwards.
    void reserve(std::size_t capacity)
    {
        if (data_ == nullptr || capacity > capacity_) {
            relocate(capacity == 0 ? 1 : capacity);
        }
    }
    /// Does the same with the memory of `memory`, which may be null, if there is much.
    void reserve(std::size_t capacity, detail::KeptMemory* memory)
    {
        if (data_ == nullptr || capacity > capacity_) {
            relocate(capacity == 0 ? 1 : capacity, memory);
        }
    }
    void resize(std::size_t size)
    {
        reserve(size);
        if (size < size_) {
            destroy(data_ + size, size_ - size);
            size_ = static_cast<std::uint32_t>(size);
        }
        if constexpr (std::is_trivially_copyable_v<T>) { // one memset
            for (T *at = data_ + size_, *const end = data_ + size; at != end; ++at) {
                ::new (static_cast<void*>(at)) T();
            }
            size_ = static_cast<std::uint32_t>(size);
        }
        for (; size_ < size; ++size_) {
            ::new (static_cast<void*>(data_ + size_)) T();
        }
    }
    template <typename... Args>
    T& emplace_back(Args&&... args)
    {
        if (size_ == capacity_) {
            T value(std::forward<Args>(args)...);
            relocate(grown());
            ::new (static_cast<void*>(data_ + size_)) T(std::move(value));
        } else {
            ::new (static_cast<void*>(data_ + size_)) T(std::forward<Args>(args)...);
        }
        return data_[size_++]; // counted only once it is constructed
    }
    void push_back(const T& value) { emplace_back(value); }
    void push_back(T&& value) { emplace_back(std::move(value)); }
    void pop_back() { destroy(data_ + --size_, 1); }
    /// Holds copies of these elements, which must not be its own.
    template <typename Iterator>
    requires(!std::is_integral_v<Iterator>) void assign(Iterator first, Iterator last)
    {
        clear();
        reserve(static_cast<std::size_t>(last - first));
        for (; first != last; ++first) {
            emplace_back(*first);
        }
    }
    /// Holds so many copies of `value`, which may be one of its own elements.
    void assign(std::size_t count, T value)
    {
        clear();
        reserve(count);
        while (size_ < count) {
            emplace_back(value);
        }
    }
    void swap(Array& other) noexcept
    {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
    }

    friend bool operator==(const Array& a, const Array& b)
    {
        if (a.is_null() != b.is_null() || a.size_ != b.size_) {
            return false;
        }
        for (std::size_t i = 0; i < a.size_; ++i) {
            if (!(a.data_[i] == b.data_[i])) {
                return false;
            }
        }
        return true;
    }

private:
    [[nodiscard]] std::size_t grown() const
    {
        return capacity_ < 4 ? 4 : std::size_t{capacity_} + capacity_ / 2;
    }
    void relocate(std::size_t capacity, detail::KeptMemory* memory = nullptr)
    {
        T* data = detail::LargeAllocator<T>{memory}.allocate(capacity);
        if (data_ != nullptr) {
            static_assert(std::is_nothrow_move_constructible_v<T>);
            for (std::size_t i = 0; i < size_; ++i) {
                ::new (static_cast<void*>(data + i)) T(std::move(data_[i]));
            }
            destroy(data_, size_);
            deallocate(data_, capacity_);
        }
        data_ = data;
        capacity_ = static_cast<std::uint32_t>(capacity);
    }
    static void destroy(T* data, std::size_t count)
    {
        for (std::size_t i = 0; i < count; ++i) {
            data[i].~T();
        }
    }
    static void deallocate(T* data, std::size_t capacity)
    {
        detail::LargeAllocator<T>{}.deallocate(data, capacity);
    }

    T* data_{nullptr};
    std::uint32_t size_{0};
    std::uint32_t capacity_{0};
};

} // namespace busbar
