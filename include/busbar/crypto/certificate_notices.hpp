#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/certificate.hpp>

namespace busbar::crypto {

/// What an operator should know of a certificate that is still, or again, in use.
struct CertificateNotice {
    enum class Kind : std::uint8_t { NotYetValid, ExpiresSoon, Expired, HostNotNamed };

    Kind kind;
    /// What was found and what to do about it.
    std::string text;
    /// The same for as long as the matter is the same, also when `text` counts days.
    std::string matter;

    friend bool operator==(const CertificateNotice&, const CertificateNotice&) = default;
};

/// A certificate that expires within this many days is worth a notice.
inline constexpr std::int64_t expiry_notice_days = 30;

/// The notices at `now`, in the order of their kinds, at most one of each. `hosts` are the names
/// and addresses by which clients reach this machine; those that the certificate does not name are
/// in one notice, since clients refuse to connect by them (Part 4, 6.1.3).
[[nodiscard]] BUSBAR_API std::vector<CertificateNotice>
certificate_notices(const Certificate& certificate, DateTime now,
                    std::span<const std::string> hosts);

/// Says notices to a log: each when it comes up, and again once a day. An expired certificate is an
/// error, everything else a warning. One thread at a time.
class BUSBAR_API CertificateWatch {
public:
    /// `log` must outlive this.
    explicit CertificateWatch(LogSink& log) : log_{&log} {}

    /// To be called at the time that the last call returned, and whenever the certificate or the
    /// hosts change. Returns when to look again: a day later or earlier, if something comes up
    /// before.
    [[nodiscard]] DateTime check(const Certificate& certificate, DateTime now,
                                 std::span<const std::string> hosts);

private:
    struct Said {
        CertificateNotice notice;
        DateTime at;
    };

    LogSink* log_;
    std::vector<Said> said_; // at most one of each kind
};

} // namespace busbar::crypto
