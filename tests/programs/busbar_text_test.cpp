#include <catch2/catch.hpp>

#include <busbar/core/status_codes.hpp>

#include "tool/admin/lines.hpp"
#include "tool/connection/context.hpp"
#include "tool/connection/failure.hpp"
#include "tool/connection/logs.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/junit.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value.hpp"
#include "tool/printing/value_lines.hpp"

namespace busbar_text_test {

using namespace busbar;
using namespace busbar::tool;

TEST_CASE("nothing that a server says changes what a terminal does")
{
    CHECK(safe("\x1b[2J\r\nno") == "\\x1B[2J\\x0D\\x0Ano");
    CHECK(safe("\xC2\x9B"
               "2J") == "\\xC2\\x9B2J");
    CHECK(safe("\xE2\x80\xAE"
               "txt.exe") == "\\u202Etxt.exe"); // right-to-left override
    CHECK(safe("Stückzahl 数") == "Stückzahl 数");
    CHECK(JsonLine{}.text("\x1b\xC2\x9B\"\\\x80").document() ==
          "\"\\u001b\\u009b\\\"\\\\\\ufffd\"");
}

TEST_CASE("a report for build servers has nothing that XML forbids")
{
    CHECK(xml_text("a < b & \"c\"\x01\x1b\x80 >\nSt\xC3\xBC"
                   "ck") == "a &lt; b &amp; &quot;c&quot;\\x01\\x1B\\x80 &gt;\nSt\xC3\xBC"
                            "ck");
    JunitCase failed;
    failed.class_name = "Read";
    failed.name = "a\x02"
                  "b";
    failed.outcome = JunitCase::Outcome::Failed;
    failed.message = "one\ntwo";
    failed.details = "1\x03\n2";
    JunitCase skipped;
    skipped.name = "c";
    skipped.outcome = JunitCase::Outcome::Skipped;
    skipped.seconds = 1.5;
    const std::string report = junit_report("busbar", {{"suite", {failed, skipped}}});
    CHECK(report == "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                    "<testsuites name=\"busbar\" tests=\"2\" failures=\"1\" skipped=\"1\">\n"
                    "  <testsuite name=\"suite\" tests=\"2\" failures=\"1\" skipped=\"1\">\n"
                    "    <testcase classname=\"Read\" name=\"a\\x02b\">\n"
                    "      <failure message=\"one two\">1\\x03\n2</failure>\n"
                    "    </testcase>\n"
                    "    <testcase classname=\"\" name=\"c\" time=\"1.500\">\n"
                    "      <skipped message=\"\"/>\n"
                    "    </testcase>\n"
                    "  </testsuite>\n"
                    "</testsuites>\n");
}

TEST_CASE("text is cut and wrapped by the columns that it takes")
{
    CHECK(display_width("数量") == 4);
    CHECK(display_width("e\xCC\x81") == 1); // e and a combining accent
    CHECK(cut("abcdef", 6) == "abcdef");
    CHECK(cut("abcdefg", 6) == "abc...");
    CHECK(cut("数量数量", 6) == "数...");
    CHECK(cut("abcdef", 2) == "..");
    CHECK(cut_front("/Objects/2:Speed", 10) == "...2:Speed");
    CHECK(cut_front("数量数量", 6) == "...量");
    CHECK(wrap("one two three", 9, 2) == "one two\n  three");
    CHECK(wrap("", 9, 2).empty());
}

TEST_CASE("what this side refuses of a server is told as its own refusal")
{
    VerboseLog log{false};
    explain(log, "channel",
            {status::Bad_TcpMessageTooLarge, "message size", "more than 16,777,216 bytes",
             "Part 6, 7.1.2.4", "Accept more"});
    CHECK(log.refusal_with(status::Bad_TcpMessageTooLarge) ==
          "message size failed: more than 16,777,216 bytes");
    // The server said these, or the network broke.
    CHECK(log.refusal_with(status::Bad_TcpServerTooBusy).empty());
    CHECK(log.refusal_with(status::Bad_ConnectionClosed).empty());
    CHECK(log.refusal_with({}).empty());
    log.write(LogLevel::Warning, "net", "cannot connect to x: it failed: Bad_Timeout, y");
    CHECK(log.refusal_with(status::Bad_Timeout).empty());

    const Failure failure = refused_by_us(status::Bad_TcpMessageTooLarge, "opc.tcp://x",
                                          log.refusal_with(status::Bad_TcpMessageTooLarge));
    const std::string text = text_of(failure, Output{stdout});
    CHECK(text.find("we ended the connection") != std::string::npos);
    CHECK(text.find("16,777,216") != std::string::npos);
    CHECK(text.find("trust our certificate") == std::string::npos);
}

TEST_CASE("busbar_text: a message stays one line in a file, however long its path is")
{
    const std::string what = "/a/rather/long/path" + std::string(200, 'x') + "/l.csv:1:2: a byte";
    std::FILE* const file = std::tmpfile();
    REQUIRE(file != nullptr);
    CHECK(text_of(Failure{Exit::Failed, what}, Output{file}) == "busbar: " + what + "\n");
    std::fclose(file);
}

TEST_CASE("a table fits, and cuts what may be cut")
{
    const Output out{stdout};
    Table table{{{"NODE", 8}, {"N", 1, true}, {"VALUE", 6}}};
    table.add({{"ns=2;s=SomethingLong"}, {"7"}, {"a long text that is a value"}});
    table.add({{"i=1"}, {"12"}, {"x"}});
    for (const std::string& line : table.lines(out, 30)) {
        INFO(line);
        CHECK(display_width(line) <= 30);
    }
    const auto whole = table.lines(out, SIZE_MAX);
    CHECK(whole[1] == "ns=2;s=SomethingLong   7  a long text that is a value");
    CHECK(whole[2] == "i=1                   12  x");
    CHECK(display_width(table.lines(out, 5)[1]) == 8 + 2 + 1 + 2 + 6); // never below the least
}

TEST_CASE("a value is told with a status that is more than Good or less than certain")
{
    const auto shown = [](StatusCode status) {
        return full_text_of(DataValue{Variant{17}, status, DateTime{}}, nullptr);
    };
    CHECK(shown(StatusCode{}) == "17");
    CHECK(shown(StatusCode{0x0000'0480}) == "17"); // the queue has overflown
    CHECK(shown(StatusCode{status::Good_Overload}) == "17  Good_Overload");
    CHECK(shown(StatusCode{status::Uncertain_LastUsableValue}) == "17  Uncertain_LastUsableValue");
    CHECK(shown(StatusCode{status::Bad_NoData}) == "Bad_NoData");
}

TEST_CASE("candidates are lines that can be pasted, ten of them")
{
    CHECK(lines_of({}).empty());
    CHECK(lines_of({"/Objects/2:Oven/Heat", "[ns=2;s=Oven]/Heat"}) ==
          "\n    /Objects/2:Oven/Heat\n    '[ns=2;s=Oven]/Heat'");
    CHECK(lines_of({"/2:It's $(here)\x1b"}) == "\n    '/2:It'\\''s $(here)\\x1B'");
    const std::string ten = lines_of(std::vector<std::string>(10, "/2:Oven"));
    CHECK(ten.find("others") == std::string::npos);
    CHECK(lines_of(std::vector<std::string>(11, "/2:Oven")) == ten + "\n    and others");
    Failure failure{status::Bad_TooManyMatches, "/Oven", "give one of these instead"};
    failure.candidates = {"/2:Oven", "/3:Oven"};
    CHECK(text_of(failure, Output{stdout}).ends_with("these instead\n    /2:Oven\n    /3:Oven\n"));
    CHECK(json_of(failure).find("\"candidates\":[\"/2:Oven\",\"/3:Oven\"]") != std::string::npos);
}

TEST_CASE("what went wrong decides the exit code")
{
    CHECK(exit_of(status::Bad_CertificateUntrusted) == Exit::Refused);
    CHECK(exit_of(status::Bad_UserAccessDenied) == Exit::Refused);
    CHECK(exit_of(status::Bad_Timeout) == Exit::NotConnected);
    CHECK(exit_of(status::Bad_NodeIdUnknown) == Exit::Failed);
}

TEST_CASE("a status is explained, with what can be done")
{
    const Failure failure{status::Bad_NodeIdUnknown, "ns=2;s=\x1b[31mX"};
    const std::string text = text_of(failure, Output{stdout});
    CHECK(text.find("Bad_NodeIdUnknown") != std::string::npos);
    CHECK(text.find("hint: ") != std::string::npos);
    CHECK(text.find('\x1b') == std::string::npos);
    // Info bits do not matter.
    const StatusCode overflow{status::Bad_Timeout.value() | 0x480U};
    CHECK(help_for(overflow).meaning == help_for(status::Bad_Timeout).meaning);
    CHECK(help_for(StatusCode{0x8FFF0000U}).meaning.empty());
    const std::string number = text_of(Failure{StatusCode{0x8FFF0000U}, "x"}, Output{stdout});
    CHECK(number.find("0x8FFF0000") != std::string::npos);
}

TEST_CASE("a server is told from a node")
{
    for (const char* url : {"opc.tcp://host", "http://host", "localhost:4840", "192.0.2.1:4840",
                            "[::1]:4840", "plc-7.example:4840/line", "host:48611x"}) {
        INFO(url);
        CHECK(is_url(url));
    }
    for (const char* node : {"i=2258", "ns=2;s=host:4840", "nsu=urn:x:4840;s=Name", "/Objects/2:4",
                             "nsu=http://works.example/Line4;i=5", "/2:http://x", "2:4",
                             "[ns=2;s=Line]/2:Speed", "localhost", ""}) {
        INFO(node);
        CHECK_FALSE(is_url(node));
    }
    CHECK(complete_url("localhost:4840") == "opc.tcp://localhost:4840");
    CHECK(complete_url("[::1]:4840/x") == "opc.tcp://[::1]:4840/x");
    CHECK(complete_url("OPC.TCP://host") == "OPC.TCP://host");
    for (const char* wrong : {"http://host", "opc.tcp://", "opc.tcp://:4840", "host:0",
                              "host:65536", "host:4840x", "opc.tcp://[::1"}) {
        INFO(wrong);
        CHECK_THROWS_AS(complete_url(wrong), Failure);
    }
}

TEST_CASE("a misspelt word has a nearest one, a strange word has none")
{
    const std::vector<std::string> words{"read", "browse", "cert", "subscribe"};
    CHECK(nearest("raed", words) == "read");
    CHECK(nearest("brwose", words) == "browse");
    CHECK(nearest("subscrib", words) == "subscribe");
    CHECK(nearest("export", words).empty());
    CHECK(nearest("", words).empty());
    CHECK(nearest("xy", words).empty());
    CHECK(nearest("read", {}).empty());
}

namespace {

std::string joined(const ValueText& value)
{
    std::string text = value.text;
    for (const std::string& line : value.lines) {
        text += "\n" + line;
    }
    return text;
}

std::string shown(const Variant& value, std::size_t limit = 100, std::size_t columns = 40)
{
    return joined(lines_of(value, nullptr, ValueLimits{limit}, columns));
}

Array<std::int32_t> numbers(std::int32_t count)
{
    Array<std::int32_t> result;
    for (std::int32_t i = 0; i < count; ++i) {
        result.push_back(i);
    }
    return result;
}

} // namespace

TEST_CASE("values that are short stay on their line")
{
    CHECK(shown(Variant{}) == "null");
    CHECK(shown(Variant{std::int32_t{-5}}) == "-5");
    CHECK(shown(Variant{"a\x1b[2J"}) == "\"a\\x1B[2J\"");
    CHECK(shown(Variant{Array<std::int32_t>{}}) == "null");
    CHECK(shown(Variant{numbers(4)}) == "[0, 1, 2, 3]");
}

TEST_CASE("an array stands in columns, each line with the index of its first element")
{
    CHECK(shown(Variant{numbers(20)}) == "Int32[20]\n"
                                         "  [0]    0   1   2   3   4   5   6   7\n"
                                         "  [8]    8   9  10  11  12  13  14  15\n"
                                         "  [16]  16  17  18  19");
    CHECK(shown(Variant{numbers(20)}, 6) == "Int32[20]\n"
                                            "  [0]  0  1  2  3  4  5\n"
                                            "  ... 14 more elements, --limit 0 shows them");
}

TEST_CASE("a matrix has a line for each row")
{
    const Variant matrix = Variant::matrix(numbers(12), Array<std::uint32_t>{2, 2, 3});
    CHECK(shown(matrix) == "Int32[2][2][3]\n"
                           "  [0][0]   0   1   2\n"
                           "  [0][1]   3   4   5\n"
                           "  [1][0]   6   7   8\n"
                           "  [1][1]   9  10  11");
    CHECK(shown(matrix, 100, 14) == "Int32[2][2][3]\n"
                                    "  [0][0]\n"
                                    "    [0]   0\n"
                                    "    [1]   1\n"
                                    "    [2]   2\n"
                                    "  [0][1]\n"
                                    "    [0]   3\n"
                                    "    [1]   4\n"
                                    "    [2]   5\n"
                                    "  [1][0]\n"
                                    "    [0]   6\n"
                                    "    [1]   7\n"
                                    "    [2]   8\n"
                                    "  [1][1]\n"
                                    "    [0]   9\n"
                                    "    [1]  10\n"
                                    "    [2]  11");
}

TEST_CASE("types of audit events are named without what all of them say")
{
    CHECK(admin::short_name("AuditOpenSecureChannelEventType") == "OpenSecureChannel");
    CHECK(admin::short_name("TrustListUpdatedAuditEventType") == "TrustListUpdated");
    CHECK(admin::short_name("AuditEventType") == "Audit");
    CHECK(admin::short_name("ValveOpened") == "ValveOpened");
    CHECK(admin::short_name("EventType") == "EventType");
    CHECK(admin::short_name("").empty());
}

namespace {

/// What a server says of a login; the user's name and the outcome are the test's.
EventFields login(const char* user, StatusCode status)
{
    return {Variant{DateTime::from_unix_seconds(0)},
            Variant{std::uint16_t{600}},
            Variant{String{"Session/ActivateSession"}},
            Variant{LocalizedText{"en", "a login"}},
            Variant{},
            Variant{},
            Variant{String{user}},
            Variant{NodeId{1, 7}},
            Variant{!status.is_bad()},
            Variant{status},
            Variant{String{"4"}}};
}

} // namespace

TEST_CASE("an audit event is a line that fits")
{
    const Output out{stdout};
    REQUIRE(login("pat", status::Good).size() ==
            standard_event_fields.size() + admin::audit_fields().size());
    CHECK(admin::audit_line(out, "ActivateSession", login("pat", status::Good), SIZE_MAX) ==
          "00:00:00.000  ActivateSession     pat           yes   a login  Session/ActivateSession"
          "  session ns=1;i=7");
    const EventFields refused = login("\x1b[2J", status::Bad_UserAccessDenied);
    const std::string whole = admin::audit_line(out, "ActivateSession", refused, SIZE_MAX);
    CHECK(whole.find("\\x1B[2J") != std::string::npos);
    CHECK(whole.find("no    a login  Bad_UserAccessDenied") != std::string::npos);
    for (const std::size_t columns : {80U, 100U}) {
        CHECK(display_width(admin::audit_line(out, "\xE6\x95\xB0", refused, columns)) == columns);
    }
    CHECK(display_width(admin::audit_line(out, "x", refused, 10)) == 54 + 12); // a word at least
    const std::string nobody =
        admin::audit_line(out, "OpenSecureChannel",
                          {Variant{}, Variant{}, Variant{}, Variant{}, Variant{}, Variant{},
                           Variant{String{""}}, Variant{}, Variant{}, Variant{}, Variant{}},
                          SIZE_MAX);
    CHECK(nobody == "-             OpenSecureChannel   -             yes   -  -");
}

TEST_CASE("an entry of an execution log is a line that fits, or two")
{
    const auto entry = controller::parse_execution_log_record(
        "8\t2017-10-17\t14:54:11\t822\tAUTH\t0001\tApplication\tERROR\tBadCertificateUntrusted");
    REQUIRE(entry);
    const std::string front = "    8  2017/10/17/14:54:11.822  AUTH      0001      Application";
    const std::string details = "ERROR BadCertificateUntrusted";
    CHECK(admin::log_title(SIZE_MAX) ==
          "Entry  Date/Time                Category  Log Code  Log Name           Details");
    CHECK(admin::log_line(*entry, SIZE_MAX) == front + "        " + details);
    CHECK(admin::log_line(*entry, 100) == front + "        " + details);
    CHECK(admin::log_line(*entry, 80) ==
          "    8  2017/10/17/14:54:11.822  AUTH      0001      Applica...\n       " + details);
    CHECK(display_width(admin::log_title(80)) <= 80);
    CHECK_FALSE(admin::log_line(*entry, 1).empty());
    JsonLine json;
    admin::append_entry(json, *entry);
    CHECK(json.document() ==
          "{\"entry\":8,\"time\":\"2017-10-17T14:54:11.822\",\"category\":\"AUTH\","
          "\"code\":\"0001\",\"name\":\"Application\","
          "\"details\":[\"ERROR\",\"BadCertificateUntrusted\"]}");
    // The time has its three digits, whatever they are.
    const auto even =
        controller::parse_execution_log_record("9\t2017-10-17\t14:54:12\t070\tSERVER\t0005\tRun");
    REQUIRE(even);
    JsonLine second;
    admin::append_entry(second, *even);
    CHECK(second.document().find("\"2017-10-17T14:54:12.070\"") != std::string::npos);
}

TEST_CASE("nothing in an execution log changes what a terminal does")
{
    const auto entry = controller::parse_execution_log_record(
        "8\t2017-10-17\t14:54:11\t822\tAUTH\t0002\tUser\t\xE2\x80\xAE"
        "txt.exe");
    REQUIRE(entry);
    CHECK(admin::log_line(*entry, SIZE_MAX).ends_with("\\u202Etxt.exe"));
}

TEST_CASE("files of an execution log are known by their names")
{
    CHECK(admin::is_log_name("OPCUA_ExecutionLog.log"));
    CHECK(admin::is_log_name("OPCUA_ExecutionLog_20170724220915040.log"));
    for (const char* name :
         {"", ".", "..", "../OPCUA_ExecutionLog.log", "OPCUA_ExecutionLog_2017072422091504.log",
          "OPCUA_ExecutionLog_2017072422091504/.log", "OPCUA_ExecutionLog_20170724220915040.txt"}) {
        CHECK_FALSE(admin::is_log_name(name));
    }
}

} // namespace busbar_text_test
