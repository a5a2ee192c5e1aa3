#include <busbar/binary/codec.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/utf8.hpp"

namespace busbar {

namespace {

template <typename Text>
void encode_text(binary::Writer& writer, const Text& value, std::span<const std::byte> bytes)
{
    if (value.is_null()) {
        writer.number(std::int32_t{-1});
        return;
    }
    writer.length(bytes.size());
    writer.bytes(bytes);
}

std::span<const std::byte> bytes_of(const String& text)
{
    return std::as_bytes(std::span{text.view()});
}

/// Part 6, 5.2.2.4. A ByteString is not one.
void encode_checked(binary::Writer& writer, const String& value)
{
    if (writer.checks_texts() && !busbar::detail::is_valid_text(value.view())) {
        writer.fail(status::Bad_EncodingError);
    }
    encode_text(writer, value, bytes_of(value));
}

/// Returns the bytes of a String or ByteString; sets `is_null` if it is null.
std::span<const std::byte> decode_text(binary::Reader& reader, std::uint32_t limit, bool& is_null)
{
    const std::int32_t length = reader.text_length(limit);
    is_null = length < 0;
    return is_null ? std::span<const std::byte>{} : reader.bytes(static_cast<std::size_t>(length));
}

/// Compares bits, in blocks without a branch, so that a compiler uses vectors for it.
template <typename T>
bool has_nan(std::span<const T> values)
{
    using Bits =
        std::conditional_t<sizeof(T) == sizeof(std::uint32_t), std::uint32_t, std::uint64_t>;
    constexpr Bits magnitude = ~Bits{0} >> 1U;
    constexpr Bits infinity = std::bit_cast<Bits>(std::numeric_limits<T>::infinity());
    constexpr std::size_t block = 1'024;
    for (std::size_t begin = 0; begin < values.size(); begin += block) {
        const auto part = values.subspan(begin, std::min(block, values.size() - begin));
        Bits found = 0;
        for (const T value : part) {
            // The top bit is set if infinity is less than the magnitude: both have it clear.
            found |= infinity - (std::bit_cast<Bits>(value) & magnitude);
        }
        if ((found & ~magnitude) != 0) {
            return true;
        }
    }
    return false;
}

template <typename T>
void encode_all(binary::Writer& writer, std::span<const T> values)
{
    if (!has_nan(values)) {
        writer.numbers(values);
        return;
    }
    for (const T value : values) {
        encode(writer, value);
    }
}

} // namespace

void encode(binary::Writer& writer, float value)
{
    // Part 6, 5.2.2.3
    writer.number(std::isnan(value) ? std::uint32_t{0xFFC00000U}
                                    : std::bit_cast<std::uint32_t>(value));
}

void encode(binary::Writer& writer, double value)
{
    writer.number(std::isnan(value) ? std::uint64_t{0xFFF8000000000000U}
                                    : std::bit_cast<std::uint64_t>(value));
}

void detail::encode_reals(binary::Writer& writer, std::span<const float> values)
{
    encode_all(writer, values);
}

void detail::encode_reals(binary::Writer& writer, std::span<const double> values)
{
    encode_all(writer, values);
}

void encode(binary::Writer& writer, const String& value)
{
    encode_checked(writer, value);
}

void encode(binary::Writer& writer, const XmlElement& value)
{
    encode_checked(writer, value);
}

void encode(binary::Writer& writer, const ByteString& value)
{
    encode_text(writer, value, value.span());
}

void encode(binary::Writer& writer, DateTime value)
{
    writer.number(value.clamped());
}

void encode(binary::Writer& writer, const Guid& value)
{
    writer.number(value.data1);
    writer.number(value.data2);
    writer.number(value.data3);
    writer.bytes(std::as_bytes(std::span{value.data4}));
}

void encode(binary::Writer& writer, StatusCode value)
{
    writer.number(value.value());
}

void encode(binary::Writer& writer, const QualifiedName& value)
{
    writer.number(value.namespace_index);
    encode(writer, value.name);
}

void encode(binary::Writer& writer, const LocalizedText& value)
{
    // Part 6, 5.2.2.14: bit 0 locale, bit 1 text; null and empty are left out.
    const unsigned mask = (value.locale.empty() ? 0U : 1U) | (value.text.empty() ? 0U : 2U);
    writer.number(static_cast<std::uint8_t>(mask));
    if (!value.locale.empty()) {
        encode(writer, value.locale);
    }
    if (!value.text.empty()) {
        encode(writer, value.text);
    }
}

void decode(binary::Reader& reader, String& value)
{
    bool is_null = false;
    const auto bytes = decode_text(reader, reader.limits().max_string_length, is_null);
    if (is_null) {
        value.reset();
        return;
    }
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    if (reader.strings() == binary::Strings::Own) {
        value = String{text};
        return;
    }
    // A server borrows from requests, and passes on what it takes: a text that is not UTF-8 (Part
    // 6, 5.2.2.4) would cost other clients whole responses. A client owns what it gets, and loses
    // nothing else of a response that has such a text.
    if (!busbar::detail::is_valid_text(text)) {
        reader.fail(status::Bad_DecodingError);
    }
    value = String::borrow(text);
}

void decode(binary::Reader& reader, XmlElement& value)
{
    String text;
    decode(reader, text);
    value = XmlElement{std::move(text)};
}

void decode(binary::Reader& reader, ByteString& value)
{
    bool is_null = false;
    const auto bytes = decode_text(reader, reader.limits().max_byte_string_length, is_null);
    if (is_null) {
        value.reset();
        return;
    }
    value =
        reader.strings() == binary::Strings::Borrow ? ByteString::borrow(bytes) : ByteString{bytes};
}

void decode(binary::Reader& reader, DateTime& value)
{
    value.ticks = reader.number<std::int64_t>();
}

void decode(binary::Reader& reader, Guid& value)
{
    value.data1 = reader.number<std::uint32_t>();
    value.data2 = reader.number<std::uint16_t>();
    value.data3 = reader.number<std::uint16_t>();
    reader.numbers(std::span<std::uint8_t>{value.data4});
}

void decode(binary::Reader& reader, StatusCode& value)
{
    value = StatusCode{reader.number<std::uint32_t>()};
}

void decode(binary::Reader& reader, QualifiedName& value)
{
    value.namespace_index = reader.number<std::uint16_t>();
    decode(reader, value.name);
}

void decode(binary::Reader& reader, LocalizedText& value)
{
    const unsigned mask = reader.number<std::uint8_t>();
    value.locale.reset();
    value.text.reset();
    if (mask > 3) {
        reader.fail(status::Bad_DecodingError);
        return;
    }
    if ((mask & 1U) != 0) {
        decode(reader, value.locale);
    }
    if ((mask & 2U) != 0) {
        decode(reader, value.text);
    }
}

} // namespace busbar
