#include <busbar/crypto/trusted_certificate_watch.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <busbar/core/record.hpp>
#include <busbar/core/text.hpp>

namespace busbar::crypto {

namespace {

void tell_expired(LogSink& log, const Certificate& certificate, const std::string& list)
{
    const std::array fields{RecordField{"ListName", Variant{String{list}}}};
    Record record{RecordKind::CertificateExpired, LogLevel::Warning, "certificate store"};
    record.text = "a certificate in " + list + " expired at " + to_string(certificate.valid_to()) +
                  ": " + printable(certificate.subject()) + ", " + certificate.thumbprint_text() +
                  "; its owner is refused until it is replaced";
    record.certificate = certificate.der();
    record.fields = fields;
    tell(log, record);
}

} // namespace

DateTime TrustedCertificateWatch::check(std::span<const Certificate> certificates, DateTime now)
{
    constexpr DateTime one_day{86'400 * DateTime::ticks_per_second};
    DateTime next{now.ticks + one_day.ticks};
    std::vector<Certificate> expired;
    for (const Certificate& each : certificates) {
        const DateTime end{each.valid_to().ticks + DateTime::ticks_per_second};
        if (now < end) {
            next = std::min(next, end);
            continue;
        }
        if (std::find(told_.begin(), told_.end(), each) == told_.end() &&
            std::find(expired.begin(), expired.end(), each) == expired.end()) {
            tell_expired(*log_, each, list_name_);
        }
        expired.push_back(each);
    }
    told_ = std::move(expired);
    return next;
}

} // namespace busbar::crypto
