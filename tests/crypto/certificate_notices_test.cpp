#include <utility>

#include <catch2/catch.hpp>

#include <busbar/crypto/certificate_notices.hpp>

#include "issuing.hpp"

namespace certificate_notices_test {

using namespace busbar;
using namespace busbar::test;
using crypto::certificate_notices;
using crypto::CertificateNotice;
using crypto::CertificateWatch;
using Kind = CertificateNotice::Kind;

namespace {

constexpr DateTime second{DateTime::ticks_per_second};

constexpr DateTime after(DateTime time, DateTime by = second)
{
    return {time.ticks + by.ticks};
}

constexpr DateTime before(DateTime time)
{
    return {time.ticks - second.ticks};
}

/// Valid from day 0 to day 100.
const crypto::Certificate& certificate()
{
    static const auto result = [] {
        CertificateOptions options;
        options.valid_from = in_days(0);
        options.valid_to = in_days(100);
        return issue(options, key_number(1)).certificate;
    }();
    return result;
}

std::vector<Kind> kinds(DateTime time, const std::vector<std::string>& hosts = {})
{
    std::vector<Kind> result;
    for (const CertificateNotice& notice : certificate_notices(certificate(), time, hosts)) {
        result.push_back(notice.kind);
    }
    return result;
}

class Lines final : public LogSink {
public:
    void write(LogLevel level, std::string_view source, std::string_view text) override
    {
        CHECK(source == "certificate");
        levels.push_back(level);
        lines.emplace_back(text);
    }
    /// How many came since the last call.
    std::size_t fresh() { return lines.size() - std::exchange(seen, lines.size()); }

    std::vector<LogLevel> levels;
    std::vector<std::string> lines;
    std::size_t seen{0};
};

} // namespace

TEST_CASE("a certificate's time is noticed at its edges", "[crypto][notice]")
{
    using Kinds = std::vector<Kind>;
    CHECK(kinds(before(in_days(0))) == Kinds{Kind::NotYetValid});
    CHECK(kinds(in_days(0)) == Kinds{});
    CHECK(kinds(before(in_days(70))) == Kinds{});
    CHECK(kinds(in_days(70)) == Kinds{Kind::ExpiresSoon});
    CHECK(kinds(in_days(100)) == Kinds{Kind::ExpiresSoon});
    CHECK(kinds(after(in_days(100))) == Kinds{Kind::Expired});
    CHECK(kinds(in_days(4'000)) == Kinds{Kind::Expired});
}

TEST_CASE("hosts that a certificate does not name are noticed", "[crypto][notice]")
{
    using Kinds = std::vector<Kind>;
    CHECK(kinds(in_days(1), {"plc.example", "PLC.example", "192.0.2.7"}) == Kinds{});
    CHECK(kinds(in_days(1), {""}) == Kinds{});
    CHECK(kinds(in_days(1), {"192.0.2.8"}) == Kinds{Kind::HostNotNamed});
    CHECK(kinds(in_days(1), {"leaf"}) == Kinds{Kind::HostNotNamed}); // its CommonName
    CHECK(kinds(in_days(101), {"192.0.2.8"}) == Kinds{Kind::Expired, Kind::HostNotNamed});
    const std::vector<std::string> hosts{"192.0.2.8", "plc.example", "a\nb"};
    const auto notices = certificate_notices(certificate(), in_days(1), hosts);
    REQUIRE(notices.size() == 1);
    CHECK(notices[0].text.find("192.0.2.8, a\\x0Ab") != std::string::npos);
    CHECK(notices[0].text.find("plc.example") == std::string::npos);
}

TEST_CASE("a notice says which certificate, what and when", "[crypto][notice]")
{
    const auto notices = certificate_notices(certificate(), in_days(95), {});
    REQUIRE(notices.size() == 1);
    const std::string& text = notices[0].text;
    for (const std::string& part : {std::string{"CN=leaf"}, certificate().thumbprint_text(),
                                    std::string{"2026-04-11T00:00:00Z"}, std::string{"in 5 days"},
                                    std::string{"regenerate"}}) {
        INFO(part);
        CHECK(text.find(part) != std::string::npos);
    }
}

TEST_CASE("each notice is said when it comes up and once a day", "[crypto][notice]")
{
    Lines log;
    CertificateWatch watch{log};
    // A day at a time while all is well, then right at the edge.
    CHECK(watch.check(certificate(), in_days(10), {}) == in_days(11));
    const DateTime noon = after(in_days(69), {DateTime::ticks_per_second * 43'200});
    CHECK(watch.check(certificate(), noon, {}) == in_days(70));
    CHECK(log.fresh() == 0);

    CHECK(watch.check(certificate(), in_days(70), {}) == in_days(71));
    CHECK(log.fresh() == 1);
    CHECK(watch.check(certificate(), after(in_days(70)), {}) == in_days(71));
    CHECK(watch.check(certificate(), before(in_days(71)), {}) == in_days(71));
    CHECK(log.fresh() == 0);
    CHECK(watch.check(certificate(), in_days(71), {}) == in_days(72));
    CHECK(log.fresh() == 1);
    CHECK(log.levels.back() == LogLevel::Warning);

    // It expires between two days.
    CHECK(watch.check(certificate(), before(in_days(100)), {}) == after(in_days(100)));
    log.fresh();
    const DateTime expired = after(in_days(100));
    CHECK(watch.check(certificate(), expired, {}) == after(in_days(101)));
    CHECK(log.fresh() == 1);
    CHECK(log.levels.back() == LogLevel::Error);
}

TEST_CASE("a change is said at once", "[crypto][notice]")
{
    Lines log;
    CertificateWatch watch{log};
    const std::vector<std::string> known{"192.0.2.7"};
    const std::vector<std::string> moved{"192.0.2.8"};
    const std::vector<std::string> again{"192.0.2.9"};
    const auto says = [&](const crypto::Certificate& which, DateTime time, const auto& hosts) {
        static_cast<void>(watch.check(which, time, hosts));
        return log.fresh();
    };
    CHECK(says(certificate(), in_days(1), known) == 0);
    CHECK(says(certificate(), in_days(1), moved) == 1);
    CHECK(says(certificate(), in_days(1), moved) == 0);
    CHECK(says(certificate(), in_days(1), again) == 1);
    CHECK(says(certificate(), in_days(1), known) == 0);
    CHECK(says(certificate(), in_days(1), moved) == 1); // it is back
    // Another certificate with the same fault.
    const auto other = issue({}, key_number(2)).certificate;
    CHECK(says(other, in_days(1), moved) == 1);
    CHECK(says(other, in_days(1), moved) == 0);
    // A clock that is set back does not silence anything.
    CHECK(says(other, in_days(0), moved) == 1);
}

TEST_CASE("a certificate that is not valid yet is looked at when it is", "[crypto][notice]")
{
    Lines log;
    CertificateWatch watch{log};
    const DateTime shortly = before(in_days(0));
    CHECK(watch.check(certificate(), shortly, {}) == in_days(0));
    CHECK(log.fresh() == 1);
    CHECK(watch.check(certificate(), in_days(0), {}) == in_days(1));
    CHECK(log.fresh() == 0);
}

} // namespace certificate_notices_test
