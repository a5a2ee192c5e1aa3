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

/// A finding about a certificate in use that an operator should know about.
struct CertificateNotice {
    /// The matter that an administrator should know of.
    enum class Kind : std::uint8_t { NotYetValid, ExpiresSoon, Expired, HostNotNamed };

    Kind kind;
    /// Says what was found and what to do about it.
    std::string text;
    /// Identifies the notice: stays the same even if `text` counts days.
    std::string matter;

    friend bool operator==(const CertificateNotice&, const CertificateNotice&) = default;
};

/// A certificate that expires within this many days gets a notice.
inline constexpr std::int64_t expiry_notice_days = 30;

/// Returns the notices at `now`, in the order of their kinds, at most one of each. `hosts` are the
/// names and addresses by which clients reach this machine. Those that the certificate does not
/// name share one notice: clients refuse to connect by them (Part 4, 6.1.3).
[[nodiscard]] BUSBAR_API std::vector<CertificateNotice>
certificate_notices(const Certificate& certificate, DateTime now,
                    std::span<const std::string> hosts);

/// Returns whether the certificate names a host or address (Part 6, 6.2.2).
[[nodiscard]] BUSBAR_API bool names_host(const Certificate& certificate, const std::string& host);

/// Writes notices to a log: each one when it arises and then once a day. An expired certificate is
/// an error, everything else a warning. One thread at a time.
class BUSBAR_API CertificateWatch {
public:
    /// `log` must outlive this object.
    explicit CertificateWatch(LogSink& log) : log_{&log} {}

    /// Call it at the time that the last call returned, and whenever the certificate or the hosts
    /// change. Returns the time of the next check: in a day, or earlier if a notice arises before.
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
