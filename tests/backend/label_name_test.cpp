#include <busbar/backend/label_name.hpp>

#include <catch2/catch.hpp>

namespace label_name_test {

using namespace busbar;
using namespace busbar::backend;

namespace {

/// What a name reads as, or why it does not.
std::string canonical(std::string_view name)
{
    const auto parsed = parse_label_name(name);
    return parsed ? to_text(*parsed) : text(parsed.error());
}

std::string repeated(std::size_t count, std::string_view what)
{
    std::string result;
    for (std::size_t i = 0; i < count; ++i) {
        result += what;
    }
    return result;
}

} // namespace

TEST_CASE("names of labels are read as they are mapped, and written in one way")
{
    struct Row {
        std::string_view name;
        std::string_view canonical;
    };
    const auto row = GENERATE(values<Row>({
        // SH-082679, 8.3: without array, one dimension, multiple dimensions.
        {"LabelName", "LabelName"},
        {"Structure.Inner.Member", "Structure.Inner.Member"},
        {"Timer.S", "Timer.S"},
        {"Array[0]", "Array[0]"},
        {"Structure.Member[0]", "Structure.Member[0]"},
        {"Structure[0].Member", "Structure[0].Member"},
        {"Timer[0].C", "Timer[0].C"},
        {"Two[0,1]", "Two[0,1]"},
        {"Three[2,1,0]", "Three[2,1,0]"},
        {"Structure[1,2,3].Array[4,5,6]", "Structure[1,2,3].Array[4,5,6]"},
        {"Timer[0,0,7].S", "Timer[0,0,7].S"},
        {"Three[1][2][3]", "Three[1,2,3]"},
        {"Two[1][2].Member[3][4]", "Two[1,2].Member[3,4]"},
        {"Three[1][2,3]", "Three[1,2,3]"},
        // Numbers have one form.
        {"Array[007]", "Array[7]"},
        {"Array[4294967295]", "Array[4294967295]"},
        // Names that begin as digits of a device would.
        {"K4", "K4"},
        {"K9Label", "K9Label"},
        {"K0Label", "K0Label"},
        {"K12Label", "K12Label"},
        {"Kiln4", "Kiln4"},
        {"Station.K4Label", "Station.K4Label"},
        {"\xE6\xB8\xA9\xE5\xBA\xA6[1]", "\xE6\xB8\xA9\xE5\xBA\xA6[1]"},
    }));
    CHECK(canonical(row.name) == row.canonical);
}

TEST_CASE("what is no name of a label is refused with its place and what was expected")
{
    struct Row {
        std::string_view name;
        std::string_view problem;
    };
    const auto row = GENERATE(values<Row>({
        {"", "column 1: found the end, expected a label's name"},
        {".Member", "column 1: found '.Member', expected a label's name"},
        {"Label.", "column 7: found the end, expected a member's name"},
        {"Label..Member", "column 7: found '.Member', expected a member's name"},
        {"1Label", "column 1: found '1Label', expected a name, which does not begin with a digit"},
        {"LabelName.1",
         "column 11: found '1', expected a member's name: bits of labels cannot be mapped"},
        {"LabelName[0].1",
         "column 14: found '1', expected a member's name: bits of labels cannot be mapped"},
        {"K4LabelName",
         "column 1: found 'K4LabelName', expected a label's name: digits of labels cannot be "
         "mapped"},
        {"k8LabelName[0,0]",
         "column 1: found 'k8LabelName[0,0]', expected a label's name: digits of labels cannot be "
         "mapped"},
        {"K1_",
         "column 1: found 'K1_', expected a label's name: digits of labels cannot be mapped"},
        {"Label]", "column 6: found ']', expected '.', '[' or the end"},
        {"Label,1", "column 6: found ',1', expected '.', '[' or the end"},
        {"Label[0]x", "column 9: found 'x', expected '.' or the end"},
        {"Label[0", "column 8: found the end, expected ',' or ']'"},
        {"Label[0;1]", "column 8: found ';1]', expected ',' or ']'"},
        {"Label[]",
         "column 7: found ']', expected an index, which is a decimal number of up to 4294967295"},
        {"Label[-1]",
         "column 7: found '-1]', expected an index, which is a decimal number of up to 4294967295"},
        {"Label[ 1]",
         "column 7: found ' 1]', expected an index, which is a decimal number of up to 4294967295"},
        {"Label[4294967296]",
         "column 7: found '4294967296]', expected an index, which is a decimal "
         "number of up to 4294967295"},
        {"Label[1,2,3,4]", "column 13: found '4]', expected at most three indices"},
        {"Label[1][2][3][4]", "column 16: found '4]', expected at most three indices"},
        {"\xE6\xB8\xA9.\xFF",
         "column 3: found '\\xFF', expected a UTF-8 character that is not a control character"},
        {"a\tb",
         "column 2: found '\\x09b', expected a UTF-8 character that is not a control character"},
        {"a\x7F",
         "column 2: found '\\x7F', expected a UTF-8 character that is not a control character"},
    }));
    CHECK(canonical(row.name) == row.problem);
}

TEST_CASE("a name has at most 800 characters, with all that is between its names")
{
    const std::string problem = "found more than 800 characters, with periods, indices and commas";
    const auto is_taken = [&](const std::string& name) {
        const auto parsed = parse_label_name(name);
        CHECK((parsed || parsed.error().text == problem));
        return parsed.has_value();
    };
    CHECK(is_taken(repeated(800, "a")));
    CHECK_FALSE(is_taken(repeated(801, "a")));
    // Characters, not bytes.
    CHECK(is_taken(repeated(800, "\xE6\xB8\xA9")));
    CHECK_FALSE(is_taken(repeated(801, "\xE6\xB8\xA9")));
    CHECK(is_taken(repeated(399, "a.") + "ab"));
    CHECK_FALSE(is_taken(repeated(400, "a.") + "a"));
    CHECK(is_taken(repeated(790, "a") + "[1,23,456]"));
    CHECK_FALSE(is_taken(repeated(790, "a") + "[1,23,4567]"));
    // As it is written in the end.
    CHECK(is_taken(repeated(793, "a") + "[1][2][3]"));
    CHECK(is_taken(repeated(797, "a") + "[0000000001]"));
}

TEST_CASE("names are told apart without case")
{
    const auto name = parse_label_name("Station[1].Count").value();
    CHECK(name == parse_label_name("STATION[01].count").value());
    CHECK_FALSE(name == parse_label_name("Station[2].Count").value());
    CHECK_FALSE(name == parse_label_name("Station.Count").value());
    CHECK_FALSE(name == parse_label_name("Station[1].Coun").value());
    CHECK(key_of(name) == "station[1].count");
    CHECK(to_text(name) == "Station[1].Count");
}

TEST_CASE("S, C and N behind a name can be parts of a timer")
{
    const auto part = [](std::string_view name) {
        return timer_part(parse_label_name(name).value().parts.back());
    };
    CHECK(part("Timer.S") == TimerPart::Contact);
    CHECK(part("Timer.c") == TimerPart::Coil);
    CHECK(part("Timer[3].n") == TimerPart::Current);
    CHECK(part("Timer.N[0]") == TimerPart::None);
    CHECK(part("Timer.SN") == TimerPart::None);
    CHECK(part("Timer.X") == TimerPart::None);
}

TEST_CASE("the mapping column takes letters, digits and what a name consists of")
{
    const auto taken = GENERATE(values<std::string_view>({
        "", "Station_1[0,1].Count", "\xC3\x84", "\xE6\xB8\xA9\xE5\xBA\xA6",
        "\xEF\xBC\xA1", // a wide A
        "\xEF\xBF\xBD", // U+FFFD
        "\xC3\x80",     // U+00C0
    }));
    CHECK_FALSE(check_label_characters(taken));
}

TEST_CASE("the mapping column takes no other symbol (appendix 6, note 1)")
{
    for (const char symbol : std::string_view{" !\"#$%&'()*+/-:;<=>?@\\^`{|}~\t"}) {
        const auto found = check_label_characters(std::string{"ab"} + symbol);
        REQUIRE(found);
        CHECK(found->where == "column 3");
    }
    const auto refused = GENERATE(values<std::string_view>({
        "\xC2\x80",         // U+0080
        "\xC2\xA0",         // U+00A0
        "\xC2\xBF",         // U+00BF
        "\xE3\x80\x80",     // the wide space
        "\xED\xA0\x80",     // half of a surrogate pair
        "\xF0\x9F\x9A\xA2", // beyond 16 bits
        "\xEF\xBF\xBE",     // U+FFFE
        "\xEF\xBF\xBF",     // U+FFFF
        "\xFF",
    }));
    const auto found = check_label_characters("\xC3\x84" + std::string{refused});
    REQUIRE(found);
    CHECK(found->where == "column 2");
}

} // namespace label_name_test
