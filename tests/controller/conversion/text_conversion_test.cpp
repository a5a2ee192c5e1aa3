#include <catch2/catch.hpp>

#include <array>
#include <set>
#include <string>
#include <string_view>

#include "label_values.hpp"

namespace text_conversion_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::string_literals;

namespace {

/// Label text of `length` characters after a Write of `text`.
std::string written(LabelType type, std::uint32_t length, std::string_view text)
{
    Mapping mapping{BuiltInType::String, {type, TimerPart::None, length}};
    CHECK(mapping.write(Variant{String{text}}) == status::Good);
    return mapping.bytes();
}

std::string read(LabelType type, std::string_view bytes)
{
    Mapping mapping{BuiltInType::String, {type, TimerPart::None, 32}};
    return mapping.read_of(bytes)->get_if<String>()->str();
}

/// The first code point of valid UTF-8.
std::uint32_t code_point(std::string_view text)
{
    const auto byte = [&](std::size_t i) {
        return std::uint32_t{static_cast<unsigned char>(text[i])};
    };
    if (byte(0) < 0xE0) {
        return byte(0) < 0x80 ? byte(0) : (byte(0) & 0x1FU) << 6U | (byte(1) & 0x3FU);
    }
    return (byte(0) & 0x0FU) << 12U | (byte(1) & 0x3FU) << 6U | (byte(2) & 0x3FU);
}

struct Pair {
    std::string_view utf8;
    std::string_view code;
};
constexpr std::array pairs{
    Pair{"A", "A"},
    Pair{"\\", "\\"},
    Pair{"~", "~"},
    Pair{"ｱ", "\xB1"}, // katakana of half width
    Pair{"｡", "\xA1"},
    Pair{"ﾟ", "\xDF"},
    Pair{"　", "\x81\x40"}, // the first character
    Pair{"÷", "\x81\x80"},  // behind the gap at 7F
    Pair{"亜", "\x88\x9F"},
    Pair{"弌", "\x98\x9F"},
    Pair{"熙", "\xEA\xA4"}, // JIS X 0208's last one
    Pair{"漾", "\xE0\x40"}, // the first one with a lead byte of the upper range
    Pair{"表", "\x95\x5C"}, // its second byte is a backslash
    Pair{"①", "\x87\x40"},
    Pair{"㈱", "\x87\x8A"}, // row 13
    Pair{"～", "\x81\x60"},
    Pair{"－", "\x81\x7C"},
    Pair{"ⅰ", "\xFA\x40"},
    Pair{"纊", "\xFA\x5C"},
    Pair{"黑", "\xFC\x4B"}, // IBM's
    // Of several codes the one that Windows takes.
    Pair{"Ⅰ", "\x87\x54"},
    Pair{"№", "\x87\x82"},
    Pair{"℡", "\x87\x84"},
    Pair{"∵", "\x81\xE6"},
    Pair{"￢", "\x81\xCA"},
};

} // namespace

TEST_CASE("8.2 Character code conversion: Shift-JIS both ways", "[8.2]")
{
    for (const Pair& pair : pairs) {
        CAPTURE(pair.utf8);
        CHECK(written(LabelType::String, 4, pair.utf8).substr(0, pair.code.size() + 1) ==
              std::string{pair.code} + '\0');
        CHECK(read(LabelType::String, pair.code) == pair.utf8);
    }
}

TEST_CASE("8.2 Character code conversion: all of Shift-JIS", "[8.2]")
{
    // The sum is of the tables of Python's codec, without the user-defined rows.
    std::uint32_t sum = 0;
    std::set<std::string> characters;
    std::size_t codes = 0;
    for (int lead = 0x81; lead <= 0xFC; ++lead) {
        for (int trail = 0x40; (lead < 0xA0 || lead >= 0xE0) && trail <= 0xFC; ++trail) {
            if (trail == 0x7F) {
                continue;
            }
            const std::string code{static_cast<char>(lead), static_cast<char>(trail)};
            std::string text = read(LabelType::String, code);
            const std::uint32_t character = code_point(text);
            sum = sum * 31 + character;
            if (character != 0xFFFD) {
                ++codes;
                characters.insert(std::move(text));
            }
        }
    }
    CHECK(sum == 0x68874F4A);
    CHECK(codes == 7'724);
    CHECK(characters.size() == 7'326);
    std::size_t kept = 0;
    for (const std::string& text : characters) {
        kept += read(LabelType::String, written(LabelType::String, 2, text)) == text ? 1U : 0U;
    }
    CHECK(kept == characters.size());
}

TEST_CASE("8.2 Character code conversion: codes that are read but not written", "[8.2]")
{
    CHECK(read(LabelType::String, "\xED\x40") == "纊"); // NEC's selection
    CHECK(read(LabelType::String, "\xFA\x4A") == "Ⅰ");
    CHECK(read(LabelType::String, "\x87\x9A") == "∵");
}

TEST_CASE("8.2 Character code conversion: other tables' characters for Windows' own", "[8.2]")
{
    CHECK(written(LabelType::String, 2, "〜") == "\x81\x60\0"s);
    CHECK(written(LabelType::String, 2, "−") == "\x81\x7C\0"s);
    CHECK(written(LabelType::String, 2, "¬") == "\x81\xCA\0"s);
}

TEST_CASE("8.2 Character code conversion: what Shift-JIS has not is a middle dot", "[8.2]")
{
    CHECK(written(LabelType::String, 10, "aéb😀c€") == "a\x81\x45"
                                                      "b\x81\x45"
                                                      "c\x81\x45\0\0"s);
    CHECK(read(LabelType::String, "\x81\x45") == "・");
    CHECK(written(LabelType::String, 2, "\xEF\xBF\xBD") == "\x81\x45\0"s); // U+FFFD
    CHECK(written(LabelType::String, 2, "\xEE\x80\x80") == "\x81\x45\0"s); // user-defined
}

TEST_CASE("8.2 Character code conversion: bytes that are no Shift-JIS are U+FFFD", "[8.2]")
{
    const std::string bad = "\xEF\xBF\xBD";
    CHECK(read(LabelType::String, "a\x80z\xA0z\xFDz\xFF") ==
          "a" + bad + "z" + bad + "z" + bad + "z" + bad);
    CHECK(read(LabelType::String, "\x81 b") == bad + " b");  // no trail byte
    CHECK(read(LabelType::String, "\x81") == bad);           // the text ends
    CHECK(read(LabelType::String, "\x85\x40") == bad + "@"); // a cell without character
    CHECK(read(LabelType::String, "\x85\xA1"
                                  "b") == bad + "b"); // both of its bytes
    CHECK(read(LabelType::String, "\xF0\xA1"
                                  "b") == bad + "b"); // user-defined
}

TEST_CASE("8.2 Data types of labels: an odd length counts one less (note 7)", "[8.2]")
{
    CHECK(written(LabelType::String, 5, "abcde") == "abcd\0\0"s);
    CHECK(written(LabelType::String, 4, "abcde") == "abcd\0"s);
    CHECK(written(LabelType::String, 1, "abcde") == "\0\0"s);
    CHECK(written(LabelType::String, 0, "abcde") == "\0"s);
    CHECK(written(LabelType::UnicodeString, 3, "abcde") == "a\0b\0c\0\0\0"s);
    Mapping odd{BuiltInType::String, {LabelType::String, TimerPart::None, 3}};
    CHECK(odd.read_of("abc") == Variant{String{"ab"}});
}

TEST_CASE("8.2 Data types of labels: too long a text is cut between characters (note 8)", "[8.2]")
{
    CHECK(written(LabelType::String, 4, "a亜b亜c") == "a\x88\x9F"
                                                      "b\0"s);
    CHECK(written(LabelType::String, 4, "abc亜d") == "abc\0\0"s);
    CHECK(written(LabelType::UnicodeString, 2, "a😀") == "a\0\0\0\0\0"s);
    CHECK(written(LabelType::UnicodeString, 3, "a😀b") == "a\0\x3D\xD8\x00\xDE\0\0"s);
}

TEST_CASE("8.2 Character code conversion: UTF-16 both ways", "[8.2]")
{
    CHECK(written(LabelType::UnicodeString, 4, "Aé亜") == "A\0\xE9\0\x9C\x4E\0\0\0\0"s);
    CHECK(read(LabelType::UnicodeString, "A\0\xE9\0\x9C\x4E\0\0z\0"s) == "Aé亜");
    CHECK(read(LabelType::UnicodeString, "\x3D\xD8\x00\xDE"s) == "😀");
    const std::string bad = "\xEF\xBF\xBD";
    CHECK(read(LabelType::UnicodeString, "\x3D\xD8z\0"s) == bad + "z");
    CHECK(read(LabelType::UnicodeString, "\x00\xDEz\0"s) == bad + "z");
    CHECK(read(LabelType::UnicodeString, "\x3D\xD8\x3D\xD8\x00\xDE"s) == bad + "😀");
    CHECK(read(LabelType::UnicodeString, "\x3D\xD8"s) == bad);
}

TEST_CASE("8.2 Character code conversion: a text that is not UTF-8 is refused", "[8.2]")
{
    for (const LabelType type : {LabelType::String, LabelType::UnicodeString}) {
        Mapping mapping{BuiltInType::String, {type, TimerPart::None, 2}};
        for (const std::string_view text :
             {"\x80", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80",
              "\xF8\x88\x80\x80\x80", "\xC3", "\xE3\x81", "\xC3(", "abcdef\xFF"}) {
            CHECK(mapping.write(Variant{String{text}}) == status::Bad_OutOfRange);
        }
    }
}

TEST_CASE("8.2 Character code conversion: texts end at a zero", "[8.2]")
{
    CHECK(written(LabelType::String, 6, "ab\0cd"s) == "ab\0\0\0\0\0"s);
    CHECK(read(LabelType::String, "ab\0cd"s) == "ab");
    Mapping empty{BuiltInType::String, {LabelType::String, TimerPart::None, 2}};
    CHECK(empty.write(Variant{String{}}) == status::Good);
    CHECK(empty.read() == Variant{String{""}});
}

TEST_CASE("8.2 Data types of labels: of a LocalizedText the text only (note 10)", "[8.2]")
{
    for (const LabelType type : {LabelType::String, LabelType::UnicodeString}) {
        Mapping mapping{BuiltInType::LocalizedText, {type, TimerPart::None, 8}};
        CHECK(mapping.write(Variant{LocalizedText{"ja", "表"}}) == status::Good);
        const auto read = mapping.read();
        REQUIRE(read.has_value());
        CHECK(*read->get_if<LocalizedText>() == LocalizedText{String{"表"}});
    }
}

} // namespace text_conversion_test
