#include <catch2/catch.hpp>

#include <pthread.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/types.hpp>

#include "support/allocation_count.hpp"

namespace length_attack_test {

// Lengths, dimensions and masks that lie (tests/attacks.txt, B).

using namespace busbar;
using namespace busbar::test;

namespace {

using Bytes = std::vector<std::byte>;

template <typename... Parts>
Bytes wire(const Parts&... parts)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    (encode(writer, parts), ...);
    return sink.take(writer.written());
}

Bytes joined(std::initializer_list<Bytes> parts)
{
    Bytes all;
    for (const Bytes& part : parts) {
        all.insert(all.end(), part.begin(), part.end());
    }
    return all;
}

template <typename T>
StatusCode status_of(const Bytes& bytes)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    const auto decoded = binary::from_bytes<T>(bytes, &types);
    return decoded ? StatusCode{} : decoded.error();
}

bool is_decoding_status(StatusCode code)
{
    return code == status::Bad_DecodingError || code == status::Bad_EncodingLimitsExceeded;
}

/// A Variant of Int32 with `count` zeros and those dimensions.
Bytes matrix(std::uint32_t count, const std::vector<std::uint32_t>& dimensions)
{
    Bytes all = wire(std::uint8_t{0xC6}, count);
    all.resize(all.size() + std::size_t{4} * count);
    const Bytes length = wire(static_cast<std::uint32_t>(dimensions.size()));
    all.insert(all.end(), length.begin(), length.end());
    for (const std::uint32_t dimension : dimensions) {
        const Bytes one = wire(dimension);
        all.insert(all.end(), one.begin(), one.end());
    }
    return all;
}

/// An ExtensionObject with a Range, 16 bytes, that says it has `length`.
Bytes range_with(std::uint32_t length)
{
    return joined(
        {wire(NodeId{0, Range::binary_encoding_id}, std::uint8_t{1}, length), wire(1.0, 2.0)});
}

/// What a thread of a small machine has; also without optimization it is enough. With sanitizers
/// functions take several times as much.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::size_t small_stack = std::size_t{2} << 20U;
#else
constexpr std::size_t small_stack = std::size_t{128} << 10U;
#endif

/// A Variant with `levels` others in one another, each in an array of one.
Bytes nested(std::size_t levels)
{
    Bytes all;
    for (std::size_t i = 0; i < levels; ++i) {
        const Bytes one = wire(std::uint8_t{0x98}, 1U);
        all.insert(all.end(), one.begin(), one.end());
    }
    all.insert(all.end(), {std::byte{1}, std::byte{1}});
    return all;
}

/// What is done to a value as deep as may be, on a thread's stack of its own; null if all is right.
void* use_deepest(void*)
{
    const Bytes bytes = nested(100);
    auto value = binary::from_bytes<Variant>(bytes);
    if (!value) {
        return const_cast<char*>("wrong");
    }
    const Variant copy = *value;
    const auto again = binary::to_bytes(copy);
    const bool is_right = copy == *value && again && *again == bytes &&
                          !binary::from_bytes<Variant>(nested(101)) &&
                          !binary::from_bytes<Variant>(nested(800'000));
    return is_right ? nullptr : const_cast<char*>("wrong");
}

} // namespace

TEST_CASE("a length that is no length is refused before memory is taken for it", "[attack]")
{
    // Each with one byte behind the length.
    const Bytes tail(1);
    for (const std::uint32_t length :
         {0xFFFFFFFEU, 0x7FFFFFFFU, 0x80000000U, 0x40000000U, 0x10000001U, 2U}) {
        INFO(length);
        const std::size_t before = allocated_bytes();
        CHECK(is_decoding_status(status_of<String>(joined({wire(length), tail}))));
        CHECK(is_decoding_status(status_of<ByteString>(joined({wire(length), tail}))));
        for (unsigned type = 1; type <= 25; ++type) {
            INFO("array of " << type);
            const auto mask = static_cast<std::uint8_t>(0x80U | type);
            // Two elements of one byte need two.
            CHECK(is_decoding_status(status_of<Variant>(joined({wire(mask, length), tail}))));
        }
        CHECK(allocated_bytes() - before < 32'768);
    }
    const Bytes one(1, std::byte{'x'});
    CHECK(binary::from_bytes<String>(joined({wire(1U), one}))->view() == "x");
    CHECK(binary::from_bytes<String>(wire(0xFFFFFFFFU))->is_null());
    CHECK(status_of<String>(joined({wire(1U), one, one})) == status::Bad_DecodingError);
}

TEST_CASE("dimensions are those of the elements, whatever their product wraps to", "[attack]")
{
    constexpr std::uint32_t k64 = 65'536;
    CHECK(status_of<Variant>(matrix(4, {2, 2})) == status::Good);
    CHECK(status_of<Variant>(matrix(4, {k64, k64})) == status::Bad_DecodingError);
    CHECK(status_of<Variant>(matrix(0, {k64, k64})) == status::Bad_DecodingError);
    CHECK(status_of<Variant>(matrix(4, {k64, k64, k64, k64})) == status::Bad_DecodingError);
    CHECK(status_of<Variant>(matrix(0, {k64, k64, k64, k64})) == status::Bad_DecodingError);
    CHECK(status_of<Variant>(matrix(4, {0xFFFFFFFF, 0xFFFFFFFC})) == status::Bad_DecodingError);
    CHECK(status_of<Variant>(matrix(4, {0, 4})) == status::Bad_DecodingError);
    CHECK(status_of<Variant>(matrix(4, {2, 2, 2})) == status::Bad_DecodingError);
    CHECK(status_of<Variant>(matrix(4, {0x80000002, 2})) == status::Bad_DecodingError);
    // A single one, which is no matrix, and more than anybody has.
    CHECK(status_of<Variant>(matrix(4, {0})).is_bad());
    CHECK(status_of<Variant>(matrix(4, {0xFFFFFFFF})).is_bad());
    CHECK(status_of<Variant>(matrix(4, std::vector<std::uint32_t>(200, 2))).is_bad());
    // Strange, and takes no more than its bytes.
    CHECK(status_of<Variant>(matrix(1, std::vector<std::uint32_t>(200, 1))) == status::Good);
    const std::size_t before = allocated_bytes();
    CHECK(is_decoding_status(
        status_of<Variant>(joined({wire(std::uint8_t{0xC6}, 0U, 0x7FFFFFFFU), Bytes(8)}))));
    CHECK(allocated_bytes() - before < 32'768);
}

TEST_CASE("a body in an ExtensionObject has the length that it says", "[attack]")
{
    const auto in_variant = [](std::uint32_t length) {
        return joined({wire(std::uint8_t{22}), range_with(length)});
    };
    CHECK(status_of<Variant>(in_variant(16)) == status::Good);
    for (const std::uint32_t length : {15U, 17U, 0U, 1U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFEU}) {
        INFO(length);
        CHECK(is_decoding_status(status_of<Variant>(in_variant(length))));
    }
    // A body of a known type without its end, whole in itself.
    CHECK(status_of<ExtensionObject>(joined(
              {wire(NodeId{0, Range::binary_encoding_id}, std::uint8_t{1}, 8U), wire(1.0)})) ==
          status::Bad_DecodingError);
    // The same in the token of a login.
    const auto activate = [](std::uint32_t length) {
        return joined({wire(RequestHeader{}, SignatureData{}, -1, -1),
                       wire(NodeId{0, AnonymousIdentityToken::binary_encoding_id}, std::uint8_t{1},
                            length, String{"anonymous"}),
                       wire(SignatureData{})});
    };
    CHECK(status_of<ActivateSessionRequest>(activate(13)) == status::Good);
    for (const std::uint32_t length : {12U, 0U, 3U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
        INFO(length);
        CHECK(is_decoding_status(status_of<ActivateSessionRequest>(activate(length))));
    }
    // A type that nobody knows is stepped over by its length.
    const auto unknown = binary::from_bytes<ExtensionObject>(
        wire(NodeId{7, 99'999U}, std::uint8_t{1}, 3U, std::uint8_t{1}, std::uint16_t{2}));
    REQUIRE(unknown);
    CHECK(unknown->binary().span().size() == 3);
}

TEST_CASE("bytes that are no UTF-8 stay what they are, or are refused", "[attack]")
{
    for (const std::string_view text :
         {"abc\xC8", "\xC0\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80", "\xFF\xFE", "\xF0"}) {
        const auto decoded = binary::from_bytes<String>(wire(String{text}));
        CHECK((!decoded || decoded->view() == text));
    }
    const std::string with_null{"a\0b", 3};
    CHECK(binary::from_bytes<String>(wire(String{with_null}))->view() == with_null);
    const std::string large(65'536, '\xC8');
    CHECK(binary::from_bytes<String>(wire(String{large}))->view() == large);
}

TEST_CASE("masks, encodings and numbers without a meaning have a defined end", "[attack]")
{
    for (unsigned encoding = 0x06; encoding <= 0xFF; ++encoding) {
        Bytes bytes(40);
        bytes[0] = static_cast<std::byte>(encoding);
        INFO("NodeId " << encoding);
        binary::Reader reader{bytes};
        NodeId id;
        decode(reader, id);
        CHECK(reader.status() == status::Bad_DecodingError);
    }
    for (unsigned mask = 0; mask <= 0xFF; ++mask) {
        for (const std::size_t size : {1U, 2U, 5U, 9U, 17U, 40U}) {
            Bytes bytes(size);
            bytes[0] = static_cast<std::byte>(mask);
            for (const StatusCode code :
                 {status_of<LocalizedText>(bytes), status_of<DataValue>(bytes),
                  status_of<DiagnosticInfo>(bytes), status_of<Variant>(bytes),
                  status_of<QualifiedName>(bytes)}) {
                CHECK((code.is_good() || is_decoding_status(code)));
            }
        }
    }
    for (const std::int64_t ticks : {INT64_MIN, INT64_MAX, std::int64_t{-1}}) {
        CHECK(binary::from_bytes<Variant>(wire(std::uint8_t{13}, ticks)));
    }
    for (const double number : {std::nan(""), std::numeric_limits<double>::infinity(), -0.0}) {
        const auto decoded = binary::from_bytes<Variant>(wire(std::uint8_t{11}, number));
        REQUIRE(decoded);
        CHECK(*decoded == Variant{number});
    }
    CHECK(binary::from_bytes<Variant>(wire(std::uint8_t{0x86}, 0U)));
}

TEST_CASE("texts that are borrowed from a message are UTF-8 (Part 6, 5.2.2.4)", "[attack]")
{
    const auto read = [](std::string_view text, binary::Strings strings) {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, Variant{String{text}});
        encode(writer, QualifiedName{1, String{text}});
        encode(writer, NodeId{1, String{text}});
        encode(writer, LocalizedText{String{text}});
        const auto bytes = sink.take(writer.written());
        std::size_t good = 0;
        std::size_t at = 0;
        const auto next = [&](auto value) {
            binary::Reader reader{std::span{bytes}.subspan(at), strings};
            decode(reader, value);
            good += reader.ok() ? 1U : 0U;
            CHECK((reader.ok() || reader.status() == status::Bad_DecodingError));
            binary::Reader owner{std::span{bytes}.subspan(at)}; // for the place of the next one
            decode(owner, value);
            at += owner.offset();
        };
        next(Variant{});
        next(QualifiedName{});
        next(NodeId{});
        next(LocalizedText{});
        return good;
    };
    for (const std::string_view text : {"", "Motor", "\xe6\xb0\xb4", "\xc2\x85"}) {
        CHECK(read(text, binary::Strings::Borrow) == 4);
    }
    for (const std::string_view text : {"ok\xff\xfe", "\xed\xa0\x80", "a\xc3"}) {
        CHECK(read(text, binary::Strings::Borrow) == 0);
        CHECK(read(text, binary::Strings::Own) == 4); // a client's
    }
}

TEST_CASE("a NaN at any place of an array is a quiet one (Part 6, 5.2.2.3)")
{
    const auto check = [](auto signalling, auto expected_bits) {
        using T = decltype(signalling);
        for (const std::size_t size : {1U, 2U, 7U, 1'023U, 1'024U, 1'025U, 3'000U}) {
            for (const std::size_t at : {std::size_t{0}, size / 2, size - 1, size}) {
                Array<T> values(size);
                for (std::size_t i = 0; i < size; ++i) {
                    const T some[] = {T{0},
                                      T{-0.0F},
                                      std::numeric_limits<T>::infinity(),
                                      -std::numeric_limits<T>::infinity(),
                                      std::numeric_limits<T>::max(),
                                      std::numeric_limits<T>::denorm_min()};
                    values[i] = some[i % std::size(some)];
                }
                Array<T> sent = values;
                if (at < size) {
                    sent[at] = signalling;
                    values[at] = std::bit_cast<T>(expected_bits);
                }
                const auto field = binary::to_bytes(sent); // of a structure
                const auto bytes = binary::to_bytes(Variant{std::move(sent)});
                REQUIRE(bytes);
                constexpr std::size_t header = 5;
                REQUIRE(field);
                CHECK(std::equal(field->begin(), field->end(), bytes->begin() + 1, bytes->end()));
                REQUIRE(bytes->size() == header + size * sizeof(T));
                std::vector<std::byte> wanted;
                for (const T& value : values) {
                    auto one = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
                    if constexpr (std::endian::native == std::endian::big) {
                        std::ranges::reverse(one);
                    }
                    wanted.insert(wanted.end(), one.begin(), one.end());
                }
                CHECK(std::ranges::equal(std::span{*bytes}.subspan(header), wanted));
            }
        }
    };
    check(std::bit_cast<float>(0x7F800001U), 0xFFC00000U);
    check(std::bit_cast<float>(0xFFFFFFFFU), 0xFFC00000U);
    check(std::bit_cast<double>(0x7FF0000000000001U), std::uint64_t{0xFFF8000000000000U});
    check(std::bit_cast<double>(0xFFFFFFFFFFFFFFFFU), std::uint64_t{0xFFF8000000000000U});
}

TEST_CASE("values as deep as may be are used on a small stack", "[attack]")
{
    pthread_attr_t attributes{};
    REQUIRE(pthread_attr_init(&attributes) == 0);
    REQUIRE(pthread_attr_setstacksize(&attributes, small_stack) == 0);
    pthread_t thread{};
    REQUIRE(pthread_create(&thread, &attributes, use_deepest, nullptr) == 0);
    void* wrong = nullptr;
    REQUIRE(pthread_join(thread, &wrong) == 0);
    CHECK(wrong == nullptr);
    pthread_attr_destroy(&attributes);
}

} // namespace length_attack_test
