#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/certificate.hpp>

namespace busbar::crypto {

/// Reports expired certificates of others, such as clients in `trusted` (manual of variables mode,
/// 5-1-1): each once, as long as it stays in its list. One thread at a time.
class BUSBAR_API TrustedCertificateWatch {
public:
    /// `log` must outlive this object. `list_name` is the StoreList's name: "trusted".
    TrustedCertificateWatch(LogSink& log, std::string list_name)
        : log_{&log}, list_name_{std::move(list_name)}
    {
    }

    /// Call it with the whole list, when the list changes and at the time that the last call
    /// returned: when the next certificate expires, or in a day.
    [[nodiscard]] DateTime check(std::span<const Certificate> certificates, DateTime now);

private:
    LogSink* log_;
    std::string list_name_;
    std::vector<Certificate> told_; // certificates of the list
};

} // namespace busbar::crypto
