#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iosfwd>
#include <span>
#include <string_view>
#include <utility>

namespace busbar {

namespace detail {

/// The data of every blob that is empty and not null; it is never written nor freed.
inline constexpr char empty_blob = '\0';

/// Sixteen bytes that own or borrow up to 4 GiB of bytes, or are null.
///
/// A borrowed blob points into memory of another owner (a message that is being decoded) and is
/// valid as long as that memory is. A copy always owns its bytes; a move takes what the source had,
/// borrowed or owned. Thread-compatible.
class Blob {
public:
    constexpr Blob() = default;
    Blob(const Blob& other) { assign(other.data_, other.size_); }
    Blob(Blob&& other) noexcept : data_{other.data_}, size_{other.size_}, owned_{other.owned_}
    {
        other.release();
    }
    Blob& operator=(const Blob& other)
    {
        if (this != &other) {
            reset();
            assign(other.data_, other.size_);
        }
        return *this;
    }
    Blob& operator=(Blob&& other) noexcept
    {
        if (this != &other) {
            reset();
            data_ = other.data_;
            size_ = other.size_;
            owned_ = other.owned_;
            other.release();
        }
        return *this;
    }
    ~Blob() { reset(); }

    /// True for null, which is a value of its own: Part 6, 5.2.2.4 gives it the length -1.
    [[nodiscard]] constexpr bool is_null() const { return data_ == nullptr; }
    /// True if null or of length 0.
    [[nodiscard]] constexpr bool empty() const { return size_ == 0; }
    [[nodiscard]] constexpr std::size_t size() const { return size_; }
    /// False for a blob that points into memory of another owner.
    [[nodiscard]] constexpr bool is_owned() const { return owned_ || size_ == 0; }

    /// Makes the blob null.
    void reset() noexcept
    {
        if (owned_) {
            delete[] data_;
        }
        release();
    }

protected:
    void assign(const char* data, std::size_t size)
    {
        if (data == nullptr) {
            return;
        }
        if (size == 0) {
            data_ = &empty_blob;
            return;
        }
        char* copy = new char[size];
        std::memcpy(copy, data, size);
        data_ = copy;
        size_ = static_cast<std::uint32_t>(size);
        owned_ = true;
    }
    void refer(const char* data, std::size_t size)
    {
        data_ = size == 0 ? &empty_blob : data;
        size_ = static_cast<std::uint32_t>(size);
    }
    [[nodiscard]] const char* chars() const { return data_; }

private:
    void release() noexcept
    {
        data_ = nullptr;
        size_ = 0;
        owned_ = false;
    }

    const char* data_{nullptr};
    std::uint32_t size_{0};
    bool owned_{false};
};

} // namespace detail

/// String (Part 3, 8.31; Part 6, 5.2.2.4): UTF-8 text that may be null.
///
/// The library neither changes nor rejects bytes that are not UTF-8; code that prints them escapes
/// them. Null and empty are different values and compare unequal.
class String : public detail::Blob {
public:
    constexpr String() = default;
    String(std::string_view text)
    {
        assign(text.data() == nullptr ? "" : text.data(), text.size());
    }
    template <std::convertible_to<std::string_view> Text> // such as std::string
    String(const Text& text) : String{std::string_view{text}}
    {
    }
    String(const char* text) : String{std::string_view{text}} {}

    /// A String that points at `text` and is valid as long as `text` is.
    [[nodiscard]] static String borrow(std::string_view text)
    {
        String result;
        result.refer(text.data(), text.size());
        return result;
    }

    /// The text; empty when this is null. Valid until this String is changed or destroyed.
    [[nodiscard]] std::string_view view() const
    {
        return empty() ? std::string_view{} : std::string_view{chars(), size()};
    }
    template <typename Text = std::string>
    [[nodiscard]] Text str() const
    {
        return Text{view()};
    }

    friend bool operator==(const String& a, const String& b)
    {
        return a.is_null() == b.is_null() && a.view() == b.view();
    }
    friend std::strong_ordering operator<=>(const String& a, const String& b)
    {
        const auto by_null = b.is_null() <=> a.is_null();
        return by_null != std::strong_ordering::equal ? by_null : a.view().compare(b.view()) <=> 0;
    }
};

/// XmlElement (Part 6, 5.2.2.8): a fragment of XML as text; the library does not look into it.
class XmlElement : public String {
public:
    using String::String;
    XmlElement() = default;
    explicit XmlElement(String text) : String{std::move(text)} {}
};

/// ByteString (Part 6, 5.2.2.7): bytes that may be null. Null and empty compare unequal.
class ByteString : public detail::Blob {
public:
    constexpr ByteString() = default;
    ByteString(std::span<const std::byte> bytes)
    {
        assign(bytes.empty() ? "" : as_chars(bytes), bytes.size());
    }

    /// A ByteString that points at `bytes` and is valid as long as they are.
    [[nodiscard]] static ByteString borrow(std::span<const std::byte> bytes)
    {
        ByteString result;
        result.refer(as_chars(bytes), bytes.size());
        return result;
    }

    /// The bytes; none when this is null. Valid until this ByteString is changed or destroyed.
    [[nodiscard]] std::span<const std::byte> span() const
    {
        return empty() ? std::span<const std::byte>{}
                       : std::span{reinterpret_cast<const std::byte*>(chars()), size()};
    }

    friend bool operator==(const ByteString& a, const ByteString& b)
    {
        return a.is_null() == b.is_null() && a.text() == b.text();
    }
    friend std::strong_ordering operator<=>(const ByteString& a, const ByteString& b)
    {
        const auto by_null = b.is_null() <=> a.is_null();
        return by_null != std::strong_ordering::equal ? by_null : a.text().compare(b.text()) <=> 0;
    }

private:
    [[nodiscard]] static const char* as_chars(std::span<const std::byte> bytes)
    {
        return reinterpret_cast<const char*>(bytes.data());
    }
    [[nodiscard]] std::string_view text() const
    {
        return empty() ? std::string_view{} : std::string_view{chars(), size()};
    }
};

} // namespace busbar
