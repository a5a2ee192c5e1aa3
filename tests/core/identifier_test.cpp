#include <catch2/catch.hpp>

#include <array>
#include <set>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include <busbar/core/text_forms.hpp>
#include <busbar/core/types.hpp>

#include "core/utf8.hpp"

namespace identifier_test {

using namespace busbar;

TEST_CASE("a NodeId's text form is read and written", "[core][node_id]")
{
    const std::array texts = {"i=0",
                              "i=85",
                              "i=4294967295",
                              "ns=2;s=Line1.Motor",
                              "ns=65535;s=a;b=c",
                              "ns=1;g=72962B91-FA75-4AE6-8D28-B404DC7DAF63",
                              "ns=4;b=AQIDBAU=",
                              "s=x"};
    for (const std::string text : texts) {
        const auto id = NodeId::parse(text);
        INFO(text);
        REQUIRE(id);
        CHECK(to_string(*id) == text);
    }
}

TEST_CASE("text that is no NodeId is refused", "[core][node_id]")
{
    const std::array texts = {
        "",     "85",  "i=",     "i=-1", "i=4294967296", "i=1x", "ns=;i=1",       "ns=65536;i=1",
        "ns=1", "x=1", "g=1234", "b=A",  "ns=-1;i=1",    "i= 1", "ns=1;ns=2;i=1", "b=@@@@"};
    for (const std::string text : texts) {
        INFO(text);
        const auto id = NodeId::parse(text);
        REQUIRE_FALSE(id);
        CHECK(id.error() == status::Bad_NodeIdInvalid);
    }
}

TEST_CASE("NodeIds compare by namespace, type and identifier", "[core][node_id]")
{
    const std::array ids = {NodeId{},
                            NodeId{0, 1},
                            NodeId{1, 1},
                            NodeId{1, "1"},
                            NodeId{1, ""},
                            NodeId{1, Guid{1, 0, 0, {}}},
                            NodeId{1, ByteString{std::as_bytes(std::span{"1", 1})}},
                            NodeId{2, "1"}};
    std::set<NodeId> ordered;
    std::unordered_set<NodeId> hashed;
    for (const NodeId& id : ids) {
        ordered.insert(id);
        hashed.insert(id);
        hashed.insert(NodeId{id});
    }
    CHECK(ordered.size() == ids.size());
    CHECK(hashed.size() == ids.size());
    CHECK(ids[0].is_null());
    CHECK_FALSE(ids[4].is_null());
    CHECK(ids[1].is(1));
    CHECK_FALSE(ids[2].is(1));
}

TEST_CASE("a copied NodeId owns what the original borrowed", "[core][node_id]")
{
    std::string text = "Motor";
    const NodeId borrowed{2, String::borrow(text)};
    const NodeId copy = borrowed;
    text = "Xxxxx";
    CHECK(to_string(copy) == "ns=2;s=Motor");
    CHECK(to_string(borrowed) == "ns=2;s=Xxxxx");
    CHECK(copy.string().is_owned());
}

TEST_CASE("a NodeId may be assigned over any other kind", "[core][node_id]")
{
    NodeId id{1, "text"};
    id = NodeId{1, Guid{7, 0, 0, {}}};
    CHECK(id.guid().data1 == 7);
    id = NodeId{3, String{"again"}};
    const NodeId& self = id;
    id = self;
    CHECK(id.string().view() == "again");
    NodeId moved = std::move(id);
    id = NodeId{0, 5};
    CHECK(moved.string().view() == "again");
}

TEST_CASE("a Guid's text form is checked", "[core][guid]")
{
    const auto guid = Guid::parse("72962b91-fa75-4ae6-8d28-b404dc7daf63");
    REQUIRE(guid);
    CHECK(to_string(*guid) == "72962B91-FA75-4AE6-8D28-B404DC7DAF63");
    CHECK(guid->data1 == 0x72962B91U);
    CHECK(guid->data4[7] == 0x63);
    CHECK_FALSE(Guid::parse("72962b91fa754ae68d28b404dc7daf63"));
    CHECK_FALSE(Guid::parse("72962b91-fa75-4ae6-8d28-b404dc7daf6"));
    CHECK_FALSE(Guid::parse("72962b91-fa75-4ae6-8d28-b404dc7daf6g"));
    CHECK_FALSE(Guid::parse("72962b91-fa75-4ae6-8d28-b404dc7daf633"));
}

TEST_CASE("Guids are in order from their first field to their last byte", "[core][guid]")
{
    const std::vector<Guid> guids{
        {0, 0, 0, {}},
        {0, 0, 0, {{0, 0, 0, 0, 0, 0, 0, 1}}},
        {0, 0, 0, {{1}}},
        {0, 0, 1, {}},
        {0, 1, 0, {{0, 9}}},
        {1, 0, 0, {}},
        {1, 0, 0, {{0xFF, 0x01}}},
    };
    for (std::size_t i = 0; i < guids.size(); ++i) {
        for (std::size_t k = 0; k < guids.size(); ++k) {
            CAPTURE(i, k);
            CHECK((guids[i] <=> guids[k]) == (i <=> k));
            CHECK((guids[i] == guids[k]) == (i == k));
        }
    }
}

TEST_CASE("null, empty and filled strings are three things", "[core][string]")
{
    const String null;
    const String empty{""};
    CHECK(null.is_null());
    CHECK_FALSE(empty.is_null());
    CHECK(null != empty);
    CHECK(null < empty);
    CHECK(null.view().empty());
    CHECK(ByteString{} != ByteString{std::span<const std::byte>{}});
    CHECK(String{"a"} == String::borrow("a"));
}

TEST_CASE("a moved string leaves null behind", "[core][string]")
{
    String text{"some text that is long enough to be somewhere"};
    String taken = std::move(text);
    text = String{"new"};
    CHECK(taken.view() == "some text that is long enough to be somewhere");
    taken = std::move(text);
    CHECK(taken.view() == "new");
}

TEST_CASE("a DateTime is written as ISO 8601 and clamped on the wire", "[core][date_time]")
{
    CHECK(to_string(DateTime::from_unix_seconds(0)) == "1970-01-01T00:00:00Z");
    CHECK(to_string(DateTime{DateTime::unix_epoch + 1'234'567}) == "1970-01-01T00:00:00.1234567Z");
    CHECK(to_string(DateTime{DateTime::from_unix_seconds(951'826'554)}) == "2000-02-29T12:15:54Z");
    CHECK(DateTime{-5}.clamped() == 0);
    CHECK(DateTime{DateTime::latest}.clamped() == INT64_MAX);
    CHECK(DateTime{DateTime::latest - 1}.clamped() == DateTime::latest - 1);
}

TEST_CASE("status codes have the specification's names", "[core][status]")
{
    CHECK(name(status::Bad_Timeout) == "Bad_Timeout");
    CHECK(name(StatusCode{status::Bad_Timeout.value() | 0x480U}) == "Bad_Timeout");
    CHECK(name(StatusCode{}) == "Good");
    CHECK(name(StatusCode{0x8FFF0000U}).empty());
    CHECK(StatusCode{0xC0000000U}.is_bad());
    CHECK(status::Uncertain_LastUsableValue.is_uncertain());
}

TEST_CASE("a DateTime is read from xs:dateTime and xs:date (Part 6, 5.3.1.6)", "[core][date_time]")
{
    const auto read = [](std::string_view text) {
        const auto time = parse_date_time(text);
        return time ? to_string(*time) : "nothing";
    };
    CHECK(read("2026-11-21T06:00:00.125Z") == "2026-11-21T06:00:00.125Z");
    CHECK(read("2026-11-21T06:00:00") == "2026-11-21T06:00:00Z");
    CHECK(read("2026-11-21T06:00:00.12345678999+02:00") == "2026-11-21T04:00:00.1234567Z");
    CHECK(read("2026-11-21") == "2026-11-21T00:00:00Z");
    CHECK(read("2026-11-21-01:30") == "2026-11-21T01:30:00Z");
    CHECK(read("2026-11-21T24:00:00Z") == "2026-11-22T00:00:00Z");
    CHECK(parse_date_time("0001-01-01T00:00:00Z") == DateTime{0});
    CHECK(parse_date_time("9999-12-31T23:59:59Z") == DateTime{INT64_MAX});
    for (const std::string_view wrong :
         {"", "2026", "2026-11-21T", "2026-11-21T06:00", "2026-11-21T24:00:01Z", "2026-02-30",
          "2026-11-21T06:60:00Z", "2026-11-21 06:00:00", "2026-11-21T06:00:00.Z",
          "2026-11-21T06:00:00+1:00", "2026-11-21Zz", "+026-11-21"}) {
        CAPTURE(wrong);
        CHECK(read(wrong) == "nothing");
    }
}

TEST_CASE("printable text has no control characters nor broken UTF-8", "[core][text]")
{
    CHECK(printable("Motor \xe6\xb0\xb4") == "Motor \xe6\xb0\xb4");
    CHECK(printable("a\x1b[2Jb\n") == "a\\x1B[2Jb\\x0A");
    CHECK(printable("\xc3(") == "\\xC3(");
    CHECK(printable("\xed\xa0\x80") == "\\xED\\xA0\\x80");
    CHECK(printable("\xe2\x80\xaetxt.exe") == "\\u202Etxt.exe"); // read from right to left
    CHECK(printable(std::string(300, 'x'), 10) == "xxxxxxxxxx...");
}

TEST_CASE("UTF-8 is checked at any place of a text (Part 6, 5.2.2.4)", "[core][text]")
{
    using busbar::detail::is_ascii;
    using busbar::detail::is_utf8;
    const std::string_view good[] = {"",
                                     "\x7f",
                                     std::string_view{"\0", 1},
                                     "\xc2\x80",
                                     "\xdf\xbf",
                                     "\xe0\xa0\x80",
                                     "\xed\x9f\xbf",
                                     "\xee\x80\x80",
                                     "\xf0\x90\x80\x80",
                                     "\xf4\x8f\xbf\xbf"};
    // Continuations alone, overlong ones, surrogates, beyond U+10FFFF, ends within a sequence.
    const std::string_view bad[] = {"\x80",
                                    "\xbf",
                                    "\xc0\xaf",
                                    "\xc1\xbf",
                                    "\xe0\x9f\xbf",
                                    "\xed\xa0\x80",
                                    "\xf0\x8f\xbf\xbf",
                                    "\xf4\x90\x80\x80",
                                    "\xf5\x80\x80\x80",
                                    "\xff\xfe",
                                    "\xc3",
                                    "\xe2\x82",
                                    "\xf0\x9f\x94",
                                    "\xc3\x28",
                                    "\xe2\x28\xa1"};
    for (std::size_t before = 0; before < 40; ++before) {
        for (std::size_t after = 0; after < 40; ++after) {
            const auto at = [&](std::string_view middle) {
                return std::string(before, 'a') + std::string{middle} + std::string(after, 'z');
            };
            REQUIRE(is_ascii(at("\x7f")));
            for (const std::string_view text : good) {
                REQUIRE(is_utf8(at(text)));
            }
            for (const std::string_view text : bad) {
                REQUIRE_FALSE(is_utf8(at(text)));
                REQUIRE_FALSE(is_ascii(at(text)));
            }
        }
    }
}

TEST_CASE("names are texts that people can read", "[core][text]")
{
    using busbar::detail::is_name;
    for (const char* name :
         {"a", "Press 4", "Motor \xe6\xb0\xb4", "a\xc2\xa0-", "\xf0\x9f\x94\xa7"}) {
        INFO(name);
        CHECK(is_name(name));
    }
    for (const char* no_name :
         {"", " ", " a", "a ", "a\nb", "\x7f", "\x1b[2J", "\xff\xfe", "\xc0\xae", "\xc3",
          "\xed\xa0\x80", "\xc2\x85", "\xd8\x9c", "a\xe2\x80\x8e", "\xe2\x80\x8f", "\xe2\x80\xaa",
          "\xe2\x80\xaetxt.exe", "\xe2\x81\xa6", "\xe2\x81\xa9"}) {
        INFO(printable(no_name));
        CHECK_FALSE(is_name(no_name));
    }
    CHECK_FALSE(is_name(std::string_view{"a\0b", 3}));
    for (const char* neighbour :
         {"\xe2\x80\x90", "\xe2\x80\xaf", "\xe2\x81\xa5", "\xe2\x81\xaa", "\xd8\x9b"}) {
        CHECK(is_name(neighbour));
    }
}

TEST_CASE("text is cut between its characters", "[core][text]")
{
    using busbar::detail::cut_short;
    CHECK(cut_short("abc", 5) == "abc");
    CHECK(cut_short("abc", 2) == "ab");
    CHECK(cut_short("a\xe6\xb0\xb4", 4) == "a\xe6\xb0\xb4");
    CHECK(cut_short("a\xe6\xb0\xb4", 3) == "a");
    CHECK(cut_short("\x80\x80", 1).empty());
}

} // namespace identifier_test
