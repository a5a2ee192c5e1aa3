#include <cstdlib>
#include <string_view>

#include <busbar/core/numeric_range.hpp>
#include <busbar/core/types.hpp>

#include "fuzz_script.hpp"

namespace numeric_range_fuzz {

using namespace busbar;

namespace {

void check(bool condition)
{
    if (!condition) {
        std::abort();
    }
}

Array<std::int32_t> numbers(std::size_t count)
{
    Array<std::int32_t> values;
    for (std::size_t i = 0; i < count; ++i) {
        values.push_back(static_cast<std::int32_t>(i));
    }
    return values;
}

/// A value of one of the shapes that can be cut, or of one that cannot.
Variant make_value(fuzz::Script& script)
{
    const unsigned shape = script.byte() % 8U;
    const std::uint32_t first = script.byte() % 5U;
    const std::uint32_t second = 1 + script.byte() % 4U;
    const std::string_view text = std::string_view{"abcdefgh"}.substr(0, first + second);
    switch (shape) {
    case 0:
        return Variant{numbers(first)};
    case 1:
        return Variant::matrix(numbers(first * second), {first, second});
    case 2:
        return Variant::matrix(numbers(first * second * 2), {first, second, 2U});
    case 3:
        return Variant{String{text}};
    case 4:
        return Variant{ByteString{std::as_bytes(std::span{text})}};
    case 5:
        return Variant{Array<String>{String{text}, String{}, String{text.substr(1)}}};
    case 6:
        return Variant::matrix(Array<String>{"ab", "cd", "e", "fgh"}, {2U, 2U});
    default:
        return Variant{7};
    }
}

/// What is read can be written to where it was, and changes nothing; unless the range goes on past
/// the end, which a Write may not (Part 4, 5.11.4.4).
void write_back(const Variant& value, const NumericRange& range)
{
    const auto part = read_range(value, range);
    if (!part) {
        check(part.error() == status::Bad_IndexRangeNoData);
        return;
    }
    Variant written = value;
    const auto result = write_range(written, range, *part);
    check(written == value);
    check(result || result.error() == status::Bad_IndexRangeNoData ||
          result.error() == status::Bad_IndexRangeDataMismatch);
}

/// What is refused changes nothing. What is taken is there afterwards; a single element may have
/// come as a scalar, and a block as a list.
void write_new(const Variant& value, const NumericRange& range, const Variant& content)
{
    Variant target = value;
    if (!write_range(target, range, content)) {
        check(target == value);
        return;
    }
    const auto read = read_range(target, range);
    check(read.has_value());
    const bool has_its_shape =
        read->is_array() == content.is_array() && read->is_matrix() == content.is_matrix();
    check(!has_its_shape || *read == content);
}

} // namespace

/// Two values and a NumericRange as text (Part 4, 7.27): to read the one, and to write the other.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    const Variant value = make_value(script);
    const Variant content = make_value(script);
    const auto text = script.bytes(size);
    const auto range =
        NumericRange::parse({reinterpret_cast<const char*>(text.data()), text.size()});
    if (!range) {
        check(range.error() == status::Bad_IndexRangeInvalid);
        return 0;
    }
    write_back(value, *range);
    write_new(value, *range, content);
    return 0;
}

} // namespace numeric_range_fuzz
