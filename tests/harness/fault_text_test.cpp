#include <catch2/catch.hpp>

#include <busbar/harness/fault.hpp>

namespace fault_text_test {

using namespace busbar;
using namespace busbar::harness;

TEST_CASE("a fault is read as it is described", "[harness]")
{
    const std::string text = GENERATE(
        as<std::string>{}, "cut", "cut after PublishResponse 3", "delay 2 s at ReadResponse 1",
        "delay 0.25 s at byte 40", "hold", "hold 3 s after 90 s on connection 2",
        "half open after MSG 7 of the server", "corrupt 40 bit 3 at OPN 1 of the client", "split 7",
        "answer Bad_Timeout at ReadRequest 2 times 5", "jump clock -3600 s after 10 s",
        "refuse times 3", "drop at PublishResponse 2", "duplicate at WriteRequest 1 always",
        "overtake at ReadResponse 1", "truncate 3 at ReadResponse 1",
        "edit results[0].status = Bad_Timeout at ReadResponse 2",
        "edit sessionName = at the press at CreateSessionRequest 1",
        "edit sessionName = at noon before CreateSessionRequest 1", "delay 0.3 s at MSG 1");
    const auto fault = parse_fault(text);
    INFO((fault ? std::string{} : fault.error().text));
    REQUIRE(fault);
    CHECK(describe(*fault) == text);
}

TEST_CASE("a fault is written as one says it", "[harness]")
{
    const auto same = [](const char* text, const char* described) {
        const auto fault = parse_fault(text);
        REQUIRE(fault);
        CHECK(describe(*fault) == described);
    };
    same("delay 200ms at  ReadResponse", "delay 0.2 s at ReadResponse 1");
    same("hold 5min after 1h", "hold 300 s after 3600 s");
    same("split", "split 1");
    same("cut on 3 of server", "cut of the server on connection 3");
    same("corrupt 9 at OPN", "corrupt 9 bit 0 at OPN 1");
}

TEST_CASE("what is no fault is told with what is expected", "[harness]")
{
    const auto [text, what] = GENERATE(table<const char*, const char*>(
        {{"", "found the end; expected cut, delay,"},
         {"cute", "found \"cute\"; expected cut, delay,"},
         {"half", "expected cut"},
         {"delay at ReadResponse", "found \"at\"; expected a time with its unit"},
         {"delay 2 at ReadResponse", "expected a time with its unit"},
         {"delay 2e99s at ReadResponse", "expected a time with its unit"},
         {"answer Bad_Luck at ReadRequest", "found \"Bad_Luck\"; expected the name of a status"},
         {"answer Bad_Timeout at ReadResponse", "only requests"},
         {"corrupt x at OPN", "expected the number of a byte"},
         {"cut near OPN", "found \"near\"; expected before, at"},
         {"cut at", "no message is called \"\""},
         {"cut at OPN 0", "counted from 1"},
         {"cut of the cable", "found \"cable\"; expected client or server"},
         {"cut on connection two", "found \"two\"; expected the number"},
         {"cut at OPN times 0", "\"always\""},
         {"cut on connection 0", "connections are counted from 1"},
         {"cut at OPN at MSG", "found \"at\"; expected one moment only"},
         {"cut after -5 s", "its time is negative"},
         {"corrupt 3 bit 9 at OPN", "found bit 9; expected 0 to 7"},
         {"cut\nat OPN", "found a control character"},
         {"edit results[0].status Bad_Timeout at ReadResponse", "edit FIELD = VALUE"},
         {"edit results[0].status = Bad_Timeout", "expected the value, and \"at\""},
         {"drop", "neither is said"},
         {"drop at PublishReponse", "no message is called \"PublishReponse\""}}));
    const auto fault = parse_fault(text);
    REQUIRE_FALSE(fault);
    CHECK_THAT(fault.error().text, Catch::Contains(what));
}

TEST_CASE("a file of faults names the line of what is wrong", "[harness]")
{
    const auto good = read_faults("# two\n\n  cut after OPN 1\r\nrefuse\n", "a.faults");
    REQUIRE(good);
    CHECK(good->size() == 2);
    const auto bad = read_faults("cut\ndelay\n", "a.faults");
    REQUIRE_FALSE(bad);
    CHECK_THAT(text(bad.error()), Catch::StartsWith("a.faults:2: found the end; expected a time"));
    std::string many;
    for (int i = 0; i < 1'001; ++i) {
        many += "cut\n";
    }
    CHECK_THAT(read_faults(many, "a").error().text, Catch::Contains("more than 1000"));
}

} // namespace fault_text_test
