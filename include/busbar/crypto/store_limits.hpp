#pragma once

#include <cstddef>
#include <cstdint>

namespace busbar::crypto {

/// The treatment of a certificate that is not trusted when the rejected list is full.
enum class RejectedFull : std::uint8_t {
    OldestOut, // it replaces the one that has been there longest
    Discard,   // it is not saved
};

/// Limits what a CertificateStore holds and reads. Files beyond a limit are ignored, and the log
/// says so once.
struct StoreLimits {
    /// Certificates in each of the trusted and the issuers list.
    std::size_t max_certificates{256};
    /// Revocation lists in each of these lists.
    std::size_t max_revocation_lists{256};
    std::size_t max_rejected{100};
    RejectedFull when_rejected_is_full{RejectedFull::OldestOut};
    /// Certificates that are not trusted and are saved, discarded and logged within one minute:
    /// unknown peers must not wear out a flash disk. Those of one network may use a quarter of it.
    std::size_t max_rejected_per_minute{10};

    // Limits of one folder: names that are read, bytes of a file, and bytes of all files together.

    std::size_t max_files{1'000};
    std::size_t max_certificate_file_size{65'536};
    std::size_t max_revocation_list_file_size{2U << 20U};
    std::size_t max_folder_size{16U << 20U};
};

/// NJ501 and NX102 (their OPC UA manual, 1-2-2): 32 trusted, 32 CA and 32 rejected certificates.
/// When the rejected list is full, further ones are discarded until one is deleted.
[[nodiscard]] constexpr StoreLimits nj501_store_limits()
{
    StoreLimits limits;
    limits.max_certificates = 32;
    limits.max_revocation_lists = 32;
    limits.max_rejected = 32;
    limits.when_rejected_is_full = RejectedFull::Discard;
    return limits;
}

/// The limits of NX102 controllers.
[[nodiscard]] constexpr StoreLimits nx102_store_limits()
{
    return nj501_store_limits();
}

/// RD81OPC96: 32 of each. Its manual does not say what happens to the next one.
[[nodiscard]] constexpr StoreLimits rd81opc96_store_limits()
{
    StoreLimits limits = nj501_store_limits();
    limits.when_rejected_is_full = RejectedFull::OldestOut;
    return limits;
}

} // namespace busbar::crypto
