#include <catch2/catch.hpp>

#include <vector>

#include <busbar/core/record.hpp>
#include <busbar/crypto/trusted_certificate_watch.hpp>

#include "issuing.hpp"

namespace trusted_certificate_watch_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::TrustedCertificateWatch;

namespace {

class ExpiryEar final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view line) override
    {
        lines.emplace_back(line);
    }
    bool wants(RecordKind kind) const override { return kind == RecordKind::CertificateExpired; }
    void record(const Record& record) override
    {
        const Variant* const list = field(record, "ListName");
        lists.push_back(list == nullptr ? "" : list->value_or(String{}).str());
    }

    std::vector<std::string> lines;
    std::vector<std::string> lists;
};

Certificate named(const std::string& common_name)
{
    CertificateOptions options;
    options.common_name = common_name;
    return issue(options, key_number(1)).certificate; // until in_days(100)
}

} // namespace

TEST_CASE("a certificate of a list that expires is told once while it is there", "[crypto][notice]")
{
    ExpiryEar log;
    TrustedCertificateWatch watch{log, "trusted"};
    const std::vector<Certificate> list{named("press"), named("robot")};
    const DateTime end{in_days(100).ticks + DateTime::ticks_per_second};
    CHECK(watch.check(list, in_days(10)) == in_days(11));
    CHECK(watch.check(list, {end.ticks - 2}) == end);
    CHECK(log.lists.empty());
    CHECK(watch.check(list, end) == DateTime{end.ticks + in_days(1).ticks - in_days(0).ticks});
    CHECK(log.lists == std::vector<std::string>{"trusted", "trusted"});
    REQUIRE(log.lines.size() == 2);
    CHECK(log.lines[0].find("CN=press") != std::string::npos);
    CHECK(log.lines[0].find(list[0].thumbprint_text()) != std::string::npos);
    static_cast<void>(watch.check(list, in_days(102)));
    CHECK(log.lists.size() == 2);
    // Gone and back, and there twice.
    static_cast<void>(watch.check({}, in_days(103)));
    const std::vector<Certificate> again{list[0], list[0]};
    static_cast<void>(watch.check(again, in_days(104)));
    CHECK(log.lists.size() == 3);
}

} // namespace trusted_certificate_watch_test
