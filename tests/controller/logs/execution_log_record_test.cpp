#include <catch2/catch.hpp>

#include <algorithm>
#include <set>

#include "log_fixture.hpp"

namespace execution_log_record_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

/// "SERVER 0100 MaxVariables|MaxValues" of each; a tab in the details is "|".
std::vector<std::string> items_of(const Happening& happening, DateTime now = example_start)
{
    std::vector<std::string> result;
    for (const ExecutionLogItem& item : execution_log_items(happening.record(), now)) {
        std::string line = std::string{item.code->category} + " " +
                           std::to_string(item.code->code) + " " + std::string{item.code->name};
        line += item.details.empty() ? "" : "|" + item.details;
        std::replace(line.begin(), line.end(), '\t', '|');
        result.push_back(std::move(line));
    }
    return result;
}

using Items = std::vector<std::string>;

Happening plain(RecordKind kind)
{
    return Happening{kind};
}

/// Writes records one after the other, as a file would have them.
struct Sheet {
    std::string lines;
    std::uint16_t serial{0};

    void add(const Happening& happening, DateTime time)
    {
        for (const ExecutionLogItem& item : execution_log_items(happening.record(), time)) {
            lines += execution_log_record(serial++, time, {}, item);
        }
    }
};

} // namespace

TEST_CASE("There are 22 log codes and one of our own, unique in their category (7-1-6)")
{
    std::set<std::pair<std::string_view, std::uint16_t>> seen;
    std::set<std::string_view> names;
    for (const ExecutionLogCode& code : execution_log_codes()) {
        CHECK(seen.emplace(code.category, code.code).second);
        CHECK(names.insert(code.name).second);
        CHECK(code.category.size() <= 16);
        CHECK(code.name.size() <= 32);
        CHECK_FALSE(code.meaning.empty());
    }
    CHECK(seen.size() == 22 + 1);
}

TEST_CASE("A start of the server as in the first example (7-1-7)")
{
    Sheet sheet;
    const auto at = [](std::int64_t milliseconds) { return later(example_start, milliseconds); };
    sheet.add(plain(RecordKind::ServerStarted), at(0));
    sheet.add(plain(RecordKind::ServerPreparing), at(2));
    sheet.add(published("Var1", 2, 1, 0), at(130));
    sheet.add(published("Var2", 6, 3, 3), at(131));
    sheet.add(published("Var3", 2, 1, 0), at(131));
    sheet.add(published("Var4", 10, 5, 0), at(131));
    sheet.add(Happening{RecordKind::VariablesCounted,
                        {number("Variables", 4), number("Values", 10), number("DataTypes", 1)}},
              at(131));
    sheet.add(plain(RecordKind::ServerRunning), at(131));
    // The example has "Prepaire" and "Data-Types", against the table of 7-1-6.
    CHECK(sheet.lines ==
          "0\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStart\r\n"
          "1\t2017-10-17\t14:52:50\t749\tSERVER\t0004\tPrepare\r\n"
          "2\t2017-10-17\t14:52:50\t877\tSERVER\t0111\tPublishedVariable\tVar1\t2Byte\t1\t0\r\n"
          "3\t2017-10-17\t14:52:50\t878\tSERVER\t0111\tPublishedVariable\tVar2\t6Byte\t3\t3\r\n"
          "4\t2017-10-17\t14:52:50\t878\tSERVER\t0111\tPublishedVariable\tVar3\t2Byte\t1\t0\r\n"
          "5\t2017-10-17\t14:52:50\t878\tSERVER\t0111\tPublishedVariable\tVar4\t10Byte\t5\t0\r\n"
          "6\t2017-10-17\t14:52:50\t878\tSERVER\t0110\tNumOfVariables\tVariables=4, Values=10, "
          "DataTypes=1\r\n"
          "7\t2017-10-17\t14:52:50\t878\tSERVER\t0005\tRun\r\n");
}

TEST_CASE("A client that is refused, trusted and let in as in the examples (7-1-7)")
{
    Sheet sheet;
    sheet.serial = 8;
    const auto der = sample_client().der();
    const DateTime at = later(example_start, 81'075);
    sheet.add(plain(RecordKind::CertificateRefused).with(status::Bad_CertificateUntrusted).of(der),
              at);
    sheet.add(plain(RecordKind::CertificateDiscarded).of(der), later(at, 22));
    sheet.add(Happening{RecordKind::CertificateMoved,
                        {text("ListName", "trusted"), text("FromListName", "rejected")}}
                  .of(der),
              later(at, 17'107));
    sheet.add(Happening{RecordKind::SessionActivated, {{"IsFirst", Variant{true}}}}.by("").of(der),
              later(at, 27'428));
    // The examples have lost tabs, and have "SUCCESS" and ".000Z", against the table of 7-1-6.
    CHECK(sheet.lines ==
          "8\t2017-10-17\t14:54:11\t822\tAUTH\t0001\tApplication\tERROR\t"
          "BadCertificateUntrusted\r\n"
          "9\t2017-10-17\t14:54:11\t844\tCERT\t0103\tDiscard\tUaClient_1@SamplePC\t"
          "2022-10-03T08:19:54Z\tCLIENT\tREJECTED\r\n"
          "10\t2017-10-17\t14:54:28\t929\tCERT\t0102\tMove\tUaClient_1@SamplePC\t"
          "2022-10-03T08:19:54Z\tCLIENT\tREJECTED->TRUSTED\r\n"
          "11\t2017-10-17\t14:54:39\t250\tAUTH\t0002\tUser\tSuccess\t0x2ADA356B\tAnonymous\r\n"
          "12\t2017-10-17\t14:54:39\t250\tAUTH\t0001\tApplication\tOPEN\t0x2ADA356B\t"
          "192.168.255.2\tUaClient_1@SamplePC\r\n");
}

TEST_CASE("A shutdown as in the last example (7-1-7)")
{
    Sheet sheet;
    sheet.serial = 60;
    sheet.add(plain(RecordKind::ServerShutDown), later(example_start, 4'374'576));
    CHECK(sheet.lines == "60\t2017-10-17\t16:05:45\t323\tSERVER\t0006\tShutdown\r\n");
}

TEST_CASE("What the server says of errors and of variables (7-1-6)")
{
    for (const std::string reason :
         {"Configuration Error", "Server Start Error", "OPC UA System Error"}) {
        CHECK(items_of(Happening{RecordKind::ServerHalted, {text("Reason", reason)}}) ==
              Items{"SERVER 7 HaltError|" + reason});
    }
    for (const std::string limit : {"MaxVariables", "MaxValues", "MaxDataTypes"}) {
        CHECK(items_of(Happening{RecordKind::PublishingLimitExceeded, {text("Limit", limit)}}) ==
              Items{"SERVER 100 MaxVariables|" + limit});
    }
    const auto not_published = [](std::string reason) {
        return items_of(Happening{
            RecordKind::VariableNotPublished,
            {text("Name", "Motor"), text("Reason", std::move(reason)), number("Size", 1025)}});
    };
    for (const std::string reason : {"MultiDimensionalArray", "Union", "SubscriptOfArray",
                                     "NestedStructre", "MaxMembers", "MaxArrayElements"}) {
        CHECK(not_published(reason) == Items{"SERVER 101 InvalidDataType|Motor|" + reason});
    }
    CHECK(not_published("MaxSize") == Items{"SERVER 101 InvalidDataType|Motor|MaxSize|1025Byte"});
}

TEST_CASE("What stands for authentication of applications (7-1-6)")
{
    const auto refused = [](StatusCode status) {
        return items_of(plain(RecordKind::CertificateRefused).with(status)).at(0);
    };
    CHECK(refused(status::Bad_CertificateIssuerRevocationUnknown) ==
          "AUTH 1 Application|ERROR|BadCertificateIssuerRevocationUnknown");
    CHECK(refused(status::Bad_CertificateInvalid) ==
          "AUTH 1 Application|ERROR|BadCertificateInvalid");
    CHECK(refused(status::Bad_CertificateRevoked) ==
          "AUTH 1 Application|ERROR|BadCertificateRevoked");
    CHECK(items_of(plain(RecordKind::SessionRefused).with(status::Bad_TooManySessions)) ==
          Items{"AUTH 1 Application|ERROR|BadTooManySessions"});
    // Those that the manual does not have are told as what they mean.
    CHECK(refused(status::Bad_CertificateChainIncomplete) ==
          "AUTH 1 Application|ERROR|BadCertificateUntrusted");
    CHECK(refused(status::Bad_CertificateRevocationUnknown) ==
          "AUTH 1 Application|ERROR|BadCertificateIssuerRevocationUnknown");
    CHECK(items_of(plain(RecordKind::LoginRefused)
                       .by("pat")
                       .with(status::Bad_ApplicationSignatureInvalid)) ==
          Items{"AUTH 1 Application|ERROR|BadApplicationSignatureInvalid"});

    CHECK(items_of(Happening{RecordKind::SessionClosed, {{"WasActivated", Variant{true}}}}.by(
              "pat", NodeId{1, 7U})) == Items{"AUTH 1 Application|CLOSE|0x00000007"});
    // One that nobody used was never told as open.
    CHECK(items_of(Happening{RecordKind::SessionClosed, {{"WasActivated", Variant{false}}}}.by(
              "", NodeId{1, 7U})) == Items{});
    // Without a certificate, who the client says it is.
    Happening open = plain(RecordKind::SessionActivated).by("pat", NodeId{1, Guid{0xDEADBEEF}});
    open.what.actor.application_uri = "urn:sample";
    CHECK(items_of(open) == Items{"AUTH 2 User|Success|0xDEADBEEF|pat",
                                  "AUTH 1 Application|OPEN|0xDEADBEEF|192.168.255.2|urn:sample"});
}

TEST_CASE("What stands for authentication of users and their settings (7-1-6)")
{
    CHECK(items_of(plain(RecordKind::LoginRefused).by("pat").with(status::Bad_UserAccessDenied)) ==
          Items{"AUTH 2 User|ERROR|pat|BadUserAccessDenied"});
    CHECK(
        items_of(plain(RecordKind::LoginRefused).by("").with(status::Bad_IdentityTokenRejected)) ==
        Items{"AUTH 2 User|ERROR|Anonymous|BadIdentityTokenRejected"});
    // Another user in the same session.
    CHECK(items_of(Happening{RecordKind::SessionActivated, {{"IsFirst", Variant{false}}}}.by(
              "kim")) == Items{"AUTH 2 User|Success|0x2ADA356B|kim"});
    for (const RecordKind kind :
         {RecordKind::UsersChanged, RecordKind::RolesChanged, RecordKind::TrustListUpdated}) {
        CHECK(items_of(plain(kind)) == Items{"AUTH 100 Update"});
        CHECK(items_of(plain(kind).with(status::Bad_UserAccessDenied)) == Items{});
    }
    // Of settings those of security.
    CHECK(items_of(plain(RecordKind::SettingsChanged)) == Items{});
    const auto settings = [](bool is_security) {
        return Happening{RecordKind::SettingsChanged, {{"IsSecurity", Variant{is_security}}}};
    };
    CHECK(items_of(settings(true)) == Items{"AUTH 100 Update"});
    CHECK(items_of(settings(true).with(status::Bad_InvalidState)) == Items{});
    CHECK(items_of(settings(false)) == Items{});
}

TEST_CASE("What stands for certificates and revocation lists (7-1-6)")
{
    const auto der = sample_client().der();
    const std::string facts = "|UaClient_1@SamplePC|2022-10-03T08:19:54Z";
    const auto own = [&](RecordKind kind) { return items_of(plain(kind).of(der)); };
    CHECK(own(RecordKind::CertificateUpdated) == Items{"CERT 1 Update_Server" + facts});
    CHECK(own(RecordKind::CertificateExpiring) == Items{"CERT 2 Notify_Server" + facts});
    CHECK(own(RecordKind::CertificateExpired) == Items{"CERT 3 Expired_Server" + facts});
    CHECK(own(RecordKind::CertificateHostNotNamed) == Items{"CERT 4 Mismatch_Host" + facts});
    // Neither one that is not valid yet nor one that was not changed.
    CHECK(items_of(plain(RecordKind::CertificateExpiring).of(der), {1}) == Items{});
    CHECK(items_of(
              plain(RecordKind::CertificateUpdated).of(der).with(status::Bad_CertificateInvalid)) ==
          Items{});

    const auto listed = [&](RecordKind kind, std::string list) {
        return items_of(Happening{kind, {text("ListName", std::move(list))}}.of(der));
    };
    CHECK(listed(RecordKind::CertificateAdded, "trusted") ==
          Items{"CERT 100 Add" + facts + "|CLIENT|TRUSTED"});
    CHECK(listed(RecordKind::CertificateAdded, "issuers") ==
          Items{"CERT 100 Add" + facts + "|CLIENT|ISSUER"});
    CHECK(listed(RecordKind::CertificateRemoved, "rejected") ==
          Items{"CERT 101 Delete" + facts + "|CLIENT|REJECTED"});
    CHECK(listed(RecordKind::CertificateExpired, "trusted") ==
          Items{"CERT 104 Expired_Client" + facts + "|CLIENT|TRUSTED"});

    const auto list = [](RecordKind kind) {
        return items_of(
            Happening{kind,
                      {text("ListName", "issuers"),
                       text("FileName", std::string(70, 'f')),
                       text("IssuerName", "Works"),
                       {"NextUpdate", Variant{DateTime::from_unix_seconds(1'506'736'953)}}}});
    };
    const std::string columns =
        "|" + std::string(65, 'f') + "|Works|2017-09-30T02:02:33Z|CLIENT|ISSUER";
    CHECK(list(RecordKind::RevocationListAdded) == Items{"CERT 200 Add_Crl" + columns});
    CHECK(list(RecordKind::RevocationListRemoved) == Items{"CERT 201 Delete_Crl" + columns});
}

TEST_CASE("Names are cut at 60 bytes and at a character's edge (7-1-6)")
{
    const std::string fits(60, 'x');
    CHECK(items_of(published(fits + "y", 2, 1, 0)) ==
          Items{"SERVER 111 PublishedVariable|" + fits + "|2Byte|1|0"});
    const std::string before(59, 'x');
    CHECK(items_of(published(before + "\xC3\xA4", 2, 1, 0)) ==
          Items{"SERVER 111 PublishedVariable|" + before + "|2Byte|1|0"});
    CHECK(items_of(published(before.substr(1) + "\xC3\xA4", 2, 1, 0)) ==
          Items{"SERVER 111 PublishedVariable|" + before.substr(1) + "\xC3\xA4|2Byte|1|0"});
}

TEST_CASE("A hostile name breaks neither lines nor columns (7-1-6)")
{
    CHECK(items_of(published("a\tb\r\nc\x7F\xFF", 2, 1, 0)) ==
          Items{"SERVER 111 PublishedVariable|a?b??c??|2Byte|1|0"});
    CHECK(items_of(
              plain(RecordKind::LoginRefused).by("x\nSERVER").with(status::Bad_UserAccessDenied)) ==
          Items{"AUTH 2 User|ERROR|x?SERVER|BadUserAccessDenied"});
}

TEST_CASE("A record has at most 256 bytes and 168 of details (7-1-6)")
{
    ExecutionLogItem item{&execution_log_codes().back(), std::string(167, 'd') + "\xC3\xA4"};
    const std::string line = execution_log_record(65'535, example_start, {}, item);
    CHECK(line.size() <= max_execution_log_record);
    CHECK(line.substr(line.size() - 5) == "ddd\r\n");
    CHECK(line.find(std::string(168, 'd')) == std::string::npos);
    const std::string wild(1'000, '\t');
    for (const ExecutionLogCode& code : execution_log_codes()) {
        item = {&code, wild};
        CHECK(execution_log_record(65'535, {INT64_MAX}, {INT16_MAX}, item).size() <=
              max_execution_log_record);
        CHECK(execution_log_record(0, {INT64_MIN}, {INT16_MIN}, item).size() <=
              max_execution_log_record);
    }
}

TEST_CASE("Times are those of the controller's place (7-1-6)")
{
    const ExecutionLogItem item{&execution_log_codes().front(), ""};
    CHECK(execution_log_record(1, example_start, {9 * 60}, item) ==
          "1\t2017-10-17\t23:52:50\t747\tSERVER\t0001\tStart\r\n");
    CHECK(execution_log_record(1, example_start, {-15 * 60}, item) ==
          "1\t2017-10-16\t23:52:50\t747\tSERVER\t0001\tStart\r\n");
    CHECK(execution_log_record(1, DateTime::from_unix_seconds(0), {}, item) ==
          "1\t1970-01-01\t00:00:00\t000\tSERVER\t0001\tStart\r\n");
}

TEST_CASE("Kinds that are told often and are not in the log are not wanted (7-1-6)")
{
    for (int i = 0; i <= static_cast<int>(RecordKind::ConfigurationRefused); ++i) {
        const auto kind = static_cast<RecordKind>(i);
        INFO(name(kind));
        if (!is_in_execution_log(kind)) {
            CHECK(items_of(plain(kind)) == Items{});
        }
    }
    CHECK_FALSE(is_in_execution_log(RecordKind::AttributeWritten));
    CHECK_FALSE(is_in_execution_log(RecordKind::ChannelOpened));
}

} // namespace execution_log_record_test
