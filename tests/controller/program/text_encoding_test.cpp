#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/text_encoding.hpp>

namespace text_encoding_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

constexpr std::size_t enough = 1'000;

/// The text and its encoding, or the problem.
std::string decoded(std::string_view bytes, TextEncoding asked = TextEncoding::Recognized)
{
    const auto text = decode_text(bytes, "a.st", enough, asked);
    return text ? std::string{name(text->encoding())} + ": " + std::string{text->text()}
                : std::string{busbar::text(text.error())};
}

std::string bytes_of(std::initializer_list<unsigned> units)
{
    std::string bytes;
    for (const unsigned unit : units) {
        bytes += {static_cast<char>(unit & 0xFFU), static_cast<char>(unit >> 8U)};
    }
    return bytes;
}

} // namespace

TEST_CASE("A text's encoding is recognized by its content")
{
    struct Row {
        std::string bytes;
        std::string decoded;
    };
    const std::vector<Row> rows{
        {"", "UTF-8: "},
        {"x : INT;", "UTF-8: x : INT;"},
        {"\xEF\xBB\xBFx", "UTF-8: x"},
        {"Gr\xC3\xB6\xC3\x9F"
         "e",
         "UTF-8: Gr\u00F6\u00DFe"},
        {"\xFF\xFE" + bytes_of({'a', 0xE4, 0x901F}), "UTF-16LE: a\u00E4\u901F"},
        {{"\xFE\xFF\0a\x90\x1F", 6}, "UTF-16BE: a\u901F"},
        {bytes_of({'a', 0xD83D, 0xDE00}), "UTF-16LE: a\U0001F600"},
        {{"\0a\0b", 4}, "UTF-16BE: ab"},
        // Accented letters before others are lead bytes of rare characters.
        {"Ger\xE4t, \xE9tat, Gr\xF6\xDF"
         "e",
         "Windows-1252: Ger\u00E4t, \u00E9tat, Gr\u00F6\u00DFe"},
        {"\x93pr\xEAt\x94 \x96 25 \xB0"
         "C",
         "Windows-1252: \u201Cpr\u00EAt\u201D \u2013 25 \u00B0C"},
        {"\x91\xAC\x93x", "Shift-JIS: \u901F\u5EA6"},
        {"\xBD\xCB\xDF\xB0\xC4\xDE", "Shift-JIS: \uFF7D\uFF8B\uFF9F\uFF70\uFF84\uFF9E"},
        // A second byte that is ASCII in another encoding.
        {"\x83\x5C", "Shift-JIS: \u30BD"},
    };
    for (const Row& row : rows) {
        CAPTURE(row.decoded);
        CHECK(decoded(row.bytes) == row.decoded);
    }
}

TEST_CASE("An XML declaration names the encoding of a text that is not UTF-8")
{
    const auto declared = [](const std::string& encoding) {
        return decoded("<?xml version=\"1.0\" encoding=" + encoding + "?>\x91\xAC");
    };
    CHECK_THAT(declared("'Shift_JIS'"), Catch::StartsWith("Shift-JIS: <?xml"));
    CHECK_THAT(declared("\"windows-1252\""), Catch::EndsWith("?>\u2018\u00AC"));
    CHECK(declared("\"koi8-r\"") ==
          "a.st:1:1: found the encoding 'koi8-r', expected UTF-8, UTF-16, "
          "Shift-JIS or Windows-1252");
    CHECK_THAT(declared("\"utf-8\""),
               Catch::StartsWith("a.st:1:39: found a byte that is not UTF-8"));
    CHECK_THAT(declared("\"utf-8"), Catch::StartsWith("Shift-JIS: "));
}

TEST_CASE("Bytes that an encoding does not have are told with their place")
{
    constexpr std::string_view then = "; expected a text that is, or the name of its encoding";
    struct Row {
        std::string bytes;
        std::string problem;
        TextEncoding asked{TextEncoding::Recognized};
    };
    const std::vector<Row> rows{
        // UTF-8 that is cut off.
        {"\xC3\xA4\xC3\xB6\n\xC3\xA4\xC3", "2:2: found a byte that is not UTF-8"},
        {"a\xFF", "1:2: found a byte that is not UTF-8", TextEncoding::Utf8},
        // Half of a surrogate pair: the first, the second, and the first at the end.
        {bytes_of({'a', '\n', 0xD800, 'b'}), "2:1: found a unit that is not UTF-16LE"},
        {bytes_of({'a', 0xDC00}), "1:2: found a unit that is not UTF-16LE"},
        {bytes_of({'a', 0xD800}), "1:2: found a unit that is not UTF-16LE"},
        {bytes_of({'a'}) + "b", "1:2: found a unit that is not UTF-16LE"},
        {"a\x81", "1:2: found a byte that is not Windows-1252"},
        {"ab\x91", "1:3: found a byte that is not Shift-JIS", TextEncoding::ShiftJis},
    };
    for (const Row& row : rows) {
        CAPTURE(row.problem);
        CHECK(decoded(row.bytes, row.asked) == "a.st:" + row.problem + std::string{then});
    }
}

TEST_CASE("A byte order mark precedes the encoding that is asked for, and that the content")
{
    CHECK(decoded("\xEF\xBB\xBF\xC3\xA4", TextEncoding::Windows1252) == "UTF-8: \u00E4");
    CHECK(decoded("\xC3\xA4", TextEncoding::Windows1252) == "Windows-1252: \u00C3\u00A4");
    CHECK(decoded("\xE4t", TextEncoding::ShiftJis) == "Shift-JIS: \u8229");
}

TEST_CASE("A text is limited both as it is and as UTF-8")
{
    CHECK_FALSE(decode_text("12345", "a.st", 4));
    CHECK(decode_text("\xE4\xE4", "a.st", 4, TextEncoding::Windows1252));
    CHECK_FALSE(decode_text("\xE4\xE4\xE4", "a.st", 4, TextEncoding::Windows1252));
}

TEST_CASE("Encodings have the names that people know")
{
    CHECK(find_text_encoding("CP932") == TextEncoding::ShiftJis);
    CHECK(find_text_encoding("ISO-8859-1") == TextEncoding::Windows1252);
    CHECK(find_text_encoding("utf-16be") == TextEncoding::Utf16Big);
    CHECK_FALSE(find_text_encoding("koi8-r"));
}

TEST_CASE("Declarations are read in any encoding and tell which")
{
    const std::string text = "VAR_GLOBAL\n x : INT; // \x91\xAC\x93x\nEND_VAR";
    const auto program = read_declarations(text, "a.st");
    REQUIRE(program);
    CHECK(program->encoding == TextEncoding::ShiftJis);
    CHECK(program->variables.at(0).comment == "\u901F\u5EA6");
    const auto as_asked =
        read_declarations(text, "a.st", {}, Unserved::Refuse, TextEncoding::Windows1252);
    REQUIRE(as_asked);
    CHECK(as_asked->variables.at(0).comment == "\u2018\u00AC\u201Cx");
}

} // namespace text_encoding_test
