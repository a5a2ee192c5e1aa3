#include <catch2/catch.hpp>

#include <array>

#include <busbar/core/numeric_range.hpp>
#include <busbar/core/types.hpp>

namespace numeric_range_test {

using namespace busbar;

namespace {

NumericRange range(std::string_view text)
{
    const auto parsed = NumericRange::parse(text);
    REQUIRE(parsed);
    return *parsed;
}

Variant vector()
{
    return Variant{Array<std::int32_t>{10, 11, 12, 13, 14}};
}

/// 3 rows of 4: 0..11.
Variant matrix()
{
    Array<std::int16_t> values;
    for (std::int16_t i = 0; i < 12; ++i) {
        values.push_back(i);
    }
    return Variant::matrix(std::move(values), {3, 4});
}

Variant texts()
{
    return Variant{Array<String>{"alpha", "be", "gamma"}};
}

StatusCode read_error(const Variant& value, std::string_view text)
{
    const auto result = read_range(value, range(text));
    return result ? StatusCode{} : result.error();
}

StatusCode write(Variant& value, std::string_view text, const Variant& part)
{
    const auto result = write_range(value, range(text), part);
    return result ? StatusCode{} : result.error();
}

} // namespace

TEST_CASE("a NumericRange is parsed as Part 4, 7.27 says", "[core][numeric_range]")
{
    CHECK(range("").empty());
    CHECK(range("6").bounds()[0] == NumericRange::Bounds{6, 6});
    CHECK(range("5:7").bounds()[0].count() == 3);
    CHECK(range("1:2,0:1").bounds().size() == 2);
    CHECK(range("0:4294967295").bounds()[0].count() == 4'294'967'296U);
    const std::array bad = {
        "7:5",        "5:5",  "a",  "1:",  ":1",   "1,",
        ",1",         "-1",   "1 ", " 1",  "1::2", "1:2:3",
        "4294967296", "1,,2", "+1", "0x1", "1;2",  "0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0"};
    for (const std::string_view text : bad) {
        INFO(text);
        const auto result = NumericRange::parse(text);
        REQUIRE_FALSE(result);
        CHECK(result.error() == status::Bad_IndexRangeInvalid);
    }
}

TEST_CASE("a range of an array is an array", "[core][numeric_range]")
{
    CHECK(*read_range(vector(), range("1:2")) == Variant{Array<std::int32_t>{11, 12}});
    CHECK(*read_range(vector(), range("4")) == Variant{Array<std::int32_t>{14}});
    CHECK(*read_range(vector(), range("3:99")) == Variant{Array<std::int32_t>{13, 14}});
    CHECK(*read_range(vector(), range("")) == vector());
    CHECK(read_error(vector(), "5") == status::Bad_IndexRangeNoData);
    CHECK(read_error(vector(), "0,0") == status::Bad_IndexRangeNoData);
}

TEST_CASE("a range of all that may be is not empty where a size has 32 bits",
          "[core][numeric_range]")
{
    constexpr std::string_view all = "0:4294967295";
    CHECK(range(all).bounds()[0].count() == std::uint64_t{1} << 32U);
    CHECK(*read_range(vector(), range(all)) == vector());
    CHECK(*read_range(matrix(), range("0:4294967295,0:4294967295")) == matrix());
    CHECK(*read_range(Variant{"hello"}, range(all)) == Variant{"hello"});
    CHECK(*read_range(texts(), range("0:4294967295,0:4294967295")) == texts());
    Variant target = vector();
    const Variant nothing{Array<std::int32_t>(std::size_t{0})};
    CHECK(write(target, all, nothing) == status::Bad_IndexRangeNoData);
    Variant text{"hello"};
    CHECK(write(text, all, Variant{""}) == status::Bad_IndexRangeNoData);
}

TEST_CASE("a range of a matrix is a matrix", "[core][numeric_range]")
{
    CHECK(*read_range(matrix(), range("1:2,0:1")) ==
          Variant::matrix(Array<std::int16_t>{4, 5, 8, 9}, {2, 2}));
    CHECK(*read_range(matrix(), range("1,3")) == Variant::matrix(Array<std::int16_t>{7}, {1, 1}));
    CHECK(*read_range(matrix(), range("2:9,3:9")) ==
          Variant::matrix(Array<std::int16_t>{11}, {1, 1}));
    CHECK(read_error(matrix(), "1") == status::Bad_IndexRangeNoData);
    CHECK(read_error(matrix(), "3,0") == status::Bad_IndexRangeNoData);
    CHECK(read_error(matrix(), "0,0,0") == status::Bad_IndexRangeNoData);
}

TEST_CASE("a range of a text is a part of it", "[core][numeric_range]")
{
    CHECK(*read_range(Variant{"hello"}, range("1:3")) == Variant{"ell"});
    CHECK(*read_range(Variant{"hello"}, range("4:9")) == Variant{"o"});
    CHECK(read_error(Variant{"hello"}, "5") == status::Bad_IndexRangeNoData);
    CHECK(read_error(Variant{String{}}, "0") == status::Bad_IndexRangeNoData);
    CHECK(*read_range(texts(), range("0:1,1:3")) == Variant{Array<String>{"lph", "e"}});
    CHECK(*read_range(texts(), range("0:2,3:4")) == Variant{Array<String>{"ha", String{}, "ma"}});
    CHECK(read_error(texts(), "1,4") == status::Bad_IndexRangeNoData);
    CHECK(*read_range(texts(), range("1")) == Variant{Array<String>{"be"}});
}

TEST_CASE("a range of a String counts characters and cuts none in two", "[core][numeric_range]")
{
    const Variant text{"Grüße €😀"};
    struct Cut {
        const char* range;
        const char* part;
    };
    static constexpr Cut cuts[] = {{"0:2", "Grü"}, {"2", "ü"}, {"3:4", "ße"},
                                   {"6", "€"},     {"7", "😀"}, {"5:99", " €😀"}};
    for (const Cut& cut : cuts) {
        INFO(cut.range);
        CHECK(*read_range(text, range(cut.range)) == Variant{cut.part});
    }
    CHECK(read_error(text, "8") == status::Bad_IndexRangeNoData);
    CHECK(*read_range(Variant{Array<String>{"üb", "a"}}, range("0:1,1")) ==
          Variant{Array<String>{"b", String{}}});
    // The bytes of a ByteString are what they are.
    const ByteString bytes{std::as_bytes(std::span{"\xC3\xBC", 2})};
    CHECK(*read_range(Variant{bytes}, range("1")) ==
          Variant{ByteString{std::as_bytes(std::span{"\xBC", 1})}});
}

TEST_CASE("bytes that are no UTF-8 belong to the character before", "[core][numeric_range]")
{
    const Variant text{"\x80\x80o\xBFk\xC3"};
    CHECK(*read_range(text, range("0")) == Variant{"\x80\x80"});
    CHECK(*read_range(text, range("1")) == Variant{"o\xBF"});
    CHECK(*read_range(text, range("2:3")) == Variant{"k\xC3"});
    CHECK(read_error(text, "4") == status::Bad_IndexRangeNoData);
}

TEST_CASE("a part of a String is replaced by as many characters", "[core][numeric_range]")
{
    Variant text{"Grüße"};
    CHECK(write(text, "2:3", Variant{"Ü€"}).is_good());
    CHECK(text == Variant{"GrÜ€e"});
    CHECK(write(text, "2:3", Variant{"ab"}).is_good());
    CHECK(text == Variant{"Grabe"});
    CHECK(write(text, "4", Variant{"ü"}).is_good());
    const Variant before = text;
    CHECK(write(text, "3:4", Variant{"ü"}) == status::Bad_IndexRangeDataMismatch);
    CHECK(write(text, "4:5", Variant{"üa"}) == status::Bad_IndexRangeNoData);
    CHECK(text == before);
}

TEST_CASE("a scalar or null has no ranges", "[core][numeric_range]")
{
    CHECK(read_error(Variant{7}, "0") == status::Bad_IndexRangeNoData);
    CHECK(read_error(Variant{}, "0") == status::Bad_IndexRangeNoData);
    CHECK(read_error(Variant{Array<Variant>{Variant{1}}}, "1") == status::Bad_IndexRangeNoData);
}

TEST_CASE("a range is written in place", "[core][numeric_range]")
{
    Variant target = vector();
    CHECK(write(target, "1:2", Variant{Array<std::int32_t>{7, 8}}).is_good());
    CHECK(target == Variant{Array<std::int32_t>{10, 7, 8, 13, 14}});
    // Part 4, 5.11.4.2: an array, also for a single element.
    CHECK(write(target, "4", Variant{std::int32_t{9}}) == status::Bad_IndexRangeDataMismatch);
    CHECK(write(target, "4", Variant{Array<std::int32_t>{9}}).is_good());
    CHECK(target == Variant{Array<std::int32_t>{10, 7, 8, 13, 9}});
    Variant grid = matrix();
    CHECK(write(grid, "0:1,2", Variant::matrix(Array<std::int16_t>{77, 88}, {2, 1})).is_good());
    CHECK(*read_range(grid, range("0:1,2")) ==
          Variant::matrix(Array<std::int16_t>{77, 88}, {2, 1}));
    Variant text{"hello"};
    CHECK(write(text, "0:1", Variant{"HE"}).is_good());
    CHECK(text == Variant{"HEllo"});
    Variant list = texts();
    CHECK(write(list, "0:1,0:1", Variant{Array<String>{"AL", "BE"}}).is_good());
    CHECK(list == Variant{Array<String>{"ALpha", "BE", "gamma"}});
}

TEST_CASE("a refused write changes nothing", "[core][numeric_range]")
{
    Variant target = vector();
    const Array<std::int32_t> two{1, 2};
    CHECK(write(target, "4:5", Variant{two}) == status::Bad_IndexRangeNoData);
    CHECK(write(target, "0:2", Variant{two}) == status::Bad_IndexRangeDataMismatch);
    CHECK(write(target, "0:1", Variant{Array<std::int16_t>{1, 2}}) == status::Bad_TypeMismatch);
    CHECK(write(target, "0:1", Variant{}) == status::Bad_TypeMismatch);
    CHECK(target == vector());
    Variant grid = matrix();
    const Variant row = Variant::matrix(Array<std::int16_t>{1, 2}, {1, 2});
    CHECK(write(grid, "0:1,2", row) == status::Bad_IndexRangeDataMismatch);
    CHECK(grid == matrix());
    Variant list = texts();
    CHECK(write(list, "0:1,0:2", Variant{Array<String>{"ALP", "BET"}}) ==
          status::Bad_IndexRangeNoData);
    CHECK(list == texts());
}

} // namespace numeric_range_test
