#include <busbar/crypto/certificate_notices.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include <openssl/err.h>

#include <busbar/core/record.hpp>
#include <busbar/core/text.hpp>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

using NoticeKind = CertificateNotice::Kind;

constexpr DateTime one_day{86'400 * DateTime::ticks_per_second};

DateTime operator+(DateTime a, DateTime b)
{
    return {a.ticks + b.ticks};
}

DateTime notice_time(const Certificate& certificate)
{
    return {certificate.valid_to().ticks - expiry_notice_days * one_day.ticks};
}

/// Returns those of `hosts` that the certificate does not name, separated by commas.
std::string missing_hosts(const Certificate& certificate, std::span<const std::string> hosts)
{
    std::string missing;
    for (const std::string& host : hosts) {
        if (!host.empty() && !names_host(certificate, host)) {
            missing += (missing.empty() ? "" : ", ") + printable(host);
        }
    }
    ERR_clear_error();
    return missing;
}

CertificateNotice make_notice(const Certificate& certificate, NoticeKind kind,
                              const std::string& matter, const std::string& text)
{
    return {kind,
            "own certificate " + printable(certificate.subject()) + ", " +
                certificate.thumbprint_text() + ": " + text,
            certificate.thumbprint_text() + matter};
}

CertificateNotice expiry_notice(const Certificate& certificate, DateTime now)
{
    const DateTime end = certificate.valid_to();
    const std::string date = to_string(end);
    if (now > end) {
        return make_notice(certificate, NoticeKind::Expired, date,
                           "expired at " + date +
                               "; peers refuse it: regenerate it or have it issued again");
    }
    const std::int64_t days = (end.ticks - now.ticks) / one_day.ticks;
    return make_notice(certificate, NoticeKind::ExpiresSoon, date,
                       "expires at " + date + ", in " + std::to_string(days) +
                           " days; regenerate it or have it issued again");
}

RecordKind kind_of(NoticeKind kind)
{
    switch (kind) {
    case NoticeKind::HostNotNamed:
        return RecordKind::CertificateHostNotNamed;
    case NoticeKind::Expired:
        return RecordKind::CertificateExpired;
    case NoticeKind::NotYetValid:
    case NoticeKind::ExpiresSoon:
        break;
    }
    return RecordKind::CertificateExpiring;
}

void tell_notice(LogSink& log, const Certificate& certificate, const CertificateNotice& notice)
{
    const bool is_over = notice.kind == NoticeKind::Expired;
    Record record{kind_of(notice.kind), is_over ? LogLevel::Error : LogLevel::Warning,
                  "certificate"};
    record.text = notice.text;
    record.certificate = certificate.der();
    tell(log, record);
}

} // namespace

/// Compares as a client does (Part 4, 6.1.3).
bool names_host(const Certificate& certificate, const std::string& host)
{
    constexpr unsigned flags = X509_CHECK_FLAG_NO_WILDCARDS | X509_CHECK_FLAG_NEVER_CHECK_SUBJECT;
    return X509_check_host(certificate.native(), host.data(), host.size(), flags, nullptr) == 1 ||
           X509_check_ip_asc(certificate.native(), host.c_str(), 0) == 1;
}

std::vector<CertificateNotice> certificate_notices(const Certificate& certificate, DateTime now,
                                                   std::span<const std::string> hosts)
{
    std::vector<CertificateNotice> notices;
    if (now < certificate.valid_from()) {
        const std::string date = to_string(certificate.valid_from());
        notices.push_back(make_notice(certificate, NoticeKind::NotYetValid, date,
                                      "not valid before " + date +
                                          "; peers refuse it: check this machine's clock"));
    }
    if (now >= notice_time(certificate)) {
        notices.push_back(expiry_notice(certificate, now));
    }
    const std::string missing = missing_hosts(certificate, hosts);
    if (!missing.empty()) {
        notices.push_back(make_notice(certificate, NoticeKind::HostNotNamed, missing,
                                      "does not name " + missing +
                                          ", by which clients reach this machine; they refuse to "
                                          "connect by it: regenerate it or have it issued again"));
    }
    return notices;
}

DateTime CertificateWatch::check(const Certificate& certificate, DateTime now,
                                 std::span<const std::string> hosts)
{
    std::vector<Said> still;
    DateTime next = now + one_day;
    for (CertificateNotice& notice : certificate_notices(certificate, now, hosts)) {
        const auto before = std::find_if(said_.begin(), said_.end(), [&](const Said& said) {
            return said.notice.kind == notice.kind && said.notice.matter == notice.matter;
        });
        // A clock that was set back counts as if a day had passed.
        const bool is_fresh =
            before != said_.end() && before->at <= now && now < before->at + one_day;
        if (!is_fresh) {
            tell_notice(*log_, certificate, notice);
        }
        still.push_back({std::move(notice), is_fresh ? before->at : now});
        next = std::min(next, still.back().at + one_day);
    }
    said_ = std::move(still);
    const DateTime after_end{certificate.valid_to().ticks + DateTime::ticks_per_second};
    for (const DateTime time : {certificate.valid_from(), notice_time(certificate), after_end}) {
        next = time > now ? std::min(next, time) : next;
    }
    return next;
}

} // namespace busbar::crypto
