#include <catch2/catch.hpp>

#include <busbar/core/numeric_range.hpp>
#include <busbar/core/types.hpp>

namespace range_examples_test {

using namespace busbar;

// What Part 4, 7.27 says of the NumericRange, sentence by sentence and example by example.

namespace {

/// The part that `text` names, or why there is none.
Result<Variant> part(const Variant& value, std::string_view text)
{
    const auto range = NumericRange::parse(text);
    return range ? read_range(value, *range) : fail(range.error());
}

StatusCode error(const Variant& value, std::string_view text)
{
    const auto result = part(value, text);
    return result ? status::Good : result.error();
}

/// The status of writing `content`, and the value afterwards.
struct Written {
    StatusCode status;
    Variant value;
};

Written write(Variant value, std::string_view text, const Variant& content)
{
    const auto range = NumericRange::parse(text);
    if (!range) {
        return {range.error(), value};
    }
    const auto result = write_range(value, *range, content);
    return {result ? status::Good : result.error(), value};
}

ByteString bytes(std::string_view text)
{
    return ByteString{std::as_bytes(std::span{text})};
}

Variant numbers()
{
    return Variant{Array<std::int32_t>{0, 10, 20, 30, 40, 50, 60, 70}};
}

/// 4 x 4, each element 10 * row + column.
Variant matrix()
{
    Array<std::int32_t> values;
    for (std::int32_t i = 0; i < 16; ++i) {
        values.push_back(i / 4 * 10 + i % 4);
    }
    return Variant::matrix(std::move(values), {4U, 4U});
}

Variant block(Array<std::int32_t> values, std::uint32_t rows, std::uint32_t columns)
{
    return Variant::matrix(std::move(values), {rows, columns});
}

ExtensionObject structure(const char* content)
{
    return ExtensionObject::from_binary(NodeId{2, 1U}, bytes(content));
}

Variant structures()
{
    return Variant{Array<ExtensionObject>{structure("a"), structure("b"), structure("c")}};
}

} // namespace

TEST_CASE("the syntax is one number or two, the lower one first (Part 4, 7.27)",
          "[core][range_examples]")
{
    CHECK(*part(numbers(), "6") == Variant{Array<std::int32_t>{60}});
    CHECK(*part(numbers(), "5:7") == Variant{Array<std::int32_t>{50, 60, 70}});
    CHECK(*part(numbers(), "") == numbers());
    for (const char* const wrong : {"7:5",
                                    "5:5",
                                    "6.0",
                                    "3.2",
                                    "5 :7",
                                    "5: 7",
                                    " 5:7",
                                    "5:7 ",
                                    "5-7",
                                    "-1",
                                    "+5",
                                    "5:",
                                    ":7",
                                    ":",
                                    ",",
                                    "5,",
                                    ",5",
                                    "a",
                                    "5:b",
                                    "0x5",
                                    "5;7",
                                    "5:7:9",
                                    "99999999999999999999",
                                    "\t5"}) {
        INFO(wrong);
        CHECK(error(numbers(), wrong) == status::Bad_IndexRangeInvalid);
        CHECK(write(numbers(), wrong, numbers()).status == status::Bad_IndexRangeInvalid);
    }
    CHECK(error(numbers(), std::string_view{"5\0", 2}) == status::Bad_IndexRangeInvalid);
}

TEST_CASE("a lower bound outside is an error, an upper one is cut (Part 4, 7.27)",
          "[core][range_examples]")
{
    CHECK(*part(numbers(), "6:9") == Variant{Array<std::int32_t>{60, 70}});
    CHECK(*part(numbers(), "7:4294967295") == Variant{Array<std::int32_t>{70}});
    CHECK(error(numbers(), "8") == status::Bad_IndexRangeNoData);
    CHECK(error(numbers(), "8:9") == status::Bad_IndexRangeNoData);
    CHECK(error(numbers(), "4294967295") == status::Bad_IndexRangeNoData);
    CHECK(error(Variant{Array<std::int32_t>{}}, "0") == status::Bad_IndexRangeNoData);
}

TEST_CASE("each dimension has its range, in the order of the ArrayDimensions (Part 4, 7.27)",
          "[core][range_examples]")
{
    CHECK(*part(matrix(), "1:2,0:1") == block({10, 11, 20, 21}, 2, 2));
    CHECK(*part(matrix(), "1,1") == block({11}, 1, 1));
    CHECK(*part(matrix(), "0:3,2") == block({2, 12, 22, 32}, 4, 1));
    CHECK(*part(matrix(), "3:9,3:9") == block({33}, 1, 1));
    // All dimensions have to be there.
    CHECK(error(matrix(), "1") == status::Bad_IndexRangeNoData);
    CHECK(error(matrix(), "1:2") == status::Bad_IndexRangeNoData);
    CHECK(error(matrix(), "1,1,1") == status::Bad_IndexRangeNoData);
    CHECK(error(matrix(), "4,0") == status::Bad_IndexRangeNoData);
    CHECK(error(matrix(), "0,4:5") == status::Bad_IndexRangeNoData);
    CHECK(error(matrix(), "1:2,") == status::Bad_IndexRangeInvalid);
    CHECK(error(matrix(), "1:2,3:2") == status::Bad_IndexRangeInvalid);
}

TEST_CASE("a ByteString or String is cut as an array (Part 4, 7.27)", "[core][range_examples]")
{
    CHECK(*part(Variant{bytes("abcdef")}, "1:3") == Variant{bytes("bcd")});
    CHECK(*part(Variant{bytes("abcdef")}, "5") == Variant{bytes("f")});
    CHECK(*part(Variant{"abcdef"}, "0:2") == Variant{"abc"});
    CHECK(*part(Variant{"abcdef"}, "4:99") == Variant{"ef"});
    CHECK(error(Variant{"abcdef"}, "6") == status::Bad_IndexRangeNoData);
    CHECK(error(Variant{bytes("")}, "0") == status::Bad_IndexRangeNoData);
    CHECK(error(Variant{"abcdef"}, "0,0") == status::Bad_IndexRangeNoData);
    CHECK(write(Variant{"abcdef"}, "1:2", Variant{"BC"}).value == Variant{"aBCdef"});
    CHECK(write(Variant{bytes("abc")}, "2", Variant{bytes("C")}).value == Variant{bytes("abC")});
    CHECK(write(Variant{"abcdef"}, "1:2", Variant{"B"}).status ==
          status::Bad_IndexRangeDataMismatch);
    CHECK(write(Variant{"abcdef"}, "5:6", Variant{"FG"}).status == status::Bad_IndexRangeNoData);
    CHECK(write(Variant{"abcdef"}, "1", Variant{bytes("B")}).status == status::Bad_TypeMismatch);
}

TEST_CASE("an array of texts has a last dimension within each (Part 4, 7.27)",
          "[core][range_examples]")
{
    const Variant texts{Array<String>{"alpha", "beta", "gamma"}};
    const Variant grid = Variant::matrix(Array<String>{"ab", "cd", "ef", "gh"}, {2U, 2U});
    CHECK(*part(texts, "1:2,0:1") == Variant{Array<String>{"be", "ga"}});
    CHECK(*part(texts, "1:2") == Variant{Array<String>{"beta", "gamma"}});
    CHECK(*part(texts, "0,4") == Variant{Array<String>{"a"}});
    CHECK(*part(grid, "1,0:1") == Variant::matrix(Array<String>{"ef", "gh"}, {1U, 2U}));
    CHECK(*part(grid, "0:1,1,1") == Variant::matrix(Array<String>{"d", "h"}, {2U, 1U}));
    CHECK(error(texts, "1,4") == status::Bad_IndexRangeNoData);
    CHECK(error(texts, "3,0") == status::Bad_IndexRangeNoData);
    CHECK(error(texts, "0,0,0") == status::Bad_IndexRangeNoData);
    CHECK(*part(Variant{Array<ByteString>{bytes("abc"), bytes("def")}}, "0:1,1:2") ==
          Variant{Array<ByteString>{bytes("bc"), bytes("ef")}});
    CHECK(write(texts, "0:1,0:1", Variant{Array<String>{"AL", "BE"}}).value ==
          Variant{Array<String>{"ALpha", "BEta", "gamma"}});
    const Written refused = write(texts, "0:1,3:4", Variant{Array<String>{"HA", "A?"}});
    CHECK(refused.status == status::Bad_IndexRangeNoData);
    CHECK(refused.value == texts);
}

TEST_CASE("an array of structures is cut by elements only (Part 4, 7.27)", "[core][range_examples]")
{
    CHECK(*part(structures(), "1:2") ==
          Variant{Array<ExtensionObject>{structure("b"), structure("c")}});
    CHECK(error(structures(), "1,0") == status::Bad_IndexRangeNoData);
    CHECK(error(Variant{structure("a")}, "0") == status::Bad_IndexRangeNoData);
    CHECK(write(structures(), "1", Variant{Array<ExtensionObject>{structure("x")}}).value ==
          Variant{Array<ExtensionObject>{structure("a"), structure("x"), structure("c")}});
    const Variant grid = Variant::matrix(
        Array<ExtensionObject>{structure("a"), structure("b"), structure("c"), structure("d")},
        {2U, 2U});
    CHECK(*part(grid, "1,0:1") ==
          Variant::matrix(Array<ExtensionObject>{structure("c"), structure("d")}, {1U, 2U}));
}

TEST_CASE("a range that is written must be filled by the value (Part 4, 7.27)",
          "[core][range_examples]")
{
    CHECK(write(numbers(), "1:2", Variant{Array<std::int32_t>{-1, -2}}).value ==
          Variant{Array<std::int32_t>{0, -1, -2, 30, 40, 50, 60, 70}});
    CHECK(write(matrix(), "1:2,0:1", block({1, 2, 3, 4}, 2, 2)).status == status::Good);
    CHECK(*part(write(matrix(), "1:2,0:1", block({1, 2, 3, 4}, 2, 2)).value, "1:2,0:2") ==
          block({1, 2, 12, 3, 4, 22}, 2, 3));
    const auto refused = [](std::string_view text, const Variant& content, StatusCode expected) {
        const Written written = write(numbers(), text, content);
        CHECK(written.status == expected);
        CHECK(written.value == numbers());
    };
    const Variant two{Array<std::int32_t>{1, 2}};
    refused("1:3", two, status::Bad_IndexRangeDataMismatch);
    refused("1", two, status::Bad_IndexRangeDataMismatch);
    refused("7:8", two, status::Bad_IndexRangeNoData);
    refused("8:9", two, status::Bad_IndexRangeNoData);
    refused("0,1", two, status::Bad_IndexRangeNoData);
    refused("1:2", Variant{Array<double>{1, 2}}, status::Bad_TypeMismatch);
    refused("1:2", Variant{}, status::Bad_TypeMismatch);
    CHECK(write(matrix(), "1:2,0:1", block({1, 2, 3, 4}, 1, 4)).status ==
          status::Bad_IndexRangeDataMismatch);
}

} // namespace range_examples_test
