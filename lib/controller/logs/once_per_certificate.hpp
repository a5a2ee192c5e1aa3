#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <busbar/core/record.hpp>

namespace busbar::controller::detail {

/// Passes notices of the server's certificate, which repeat each day, once: until a restart or a
/// new certificate (W588, 7-1-1 and 9-2-2).
class OncePerCertificate {
public:
    /// False for a notice that was already passed for the same certificate; true for everything
    /// else.
    [[nodiscard]] bool is_new(const Record& record)
    {
        if (record.kind == RecordKind::CertificateUpdated && !record.status.is_bad()) {
            told_ = {};
            return true;
        }
        const auto found = std::find(kinds.begin(), kinds.end(), record.kind);
        // Notices of lists have a field with the name of the list; see RecordKind.
        if (found == kinds.end() || field(record, "ListName") != nullptr) {
            return true;
        }
        auto& told = told_[static_cast<std::size_t>(found - kinds.begin())];
        if (!told.empty() && std::equal(told.begin(), told.end(), record.certificate.begin(),
                                        record.certificate.end())) {
            return false;
        }
        told.assign(record.certificate.begin(), record.certificate.end());
        return true;
    }

private:
    static constexpr std::array kinds{RecordKind::CertificateExpiring,
                                      RecordKind::CertificateExpired,
                                      RecordKind::CertificateHostNotNamed};

    std::array<std::vector<std::byte>, kinds.size()> told_; // DER of the certificate of each kind
};

} // namespace busbar::controller::detail
