#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/file_transaction.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/store_limits.hpp>
#include <busbar/crypto/trust_list.hpp>

namespace busbar::crypto {

namespace detail {
class RejectedList;
class StoreLists;
class StoreRecords;
} // namespace detail

/// The lists of a store (Part 12, F.1).
enum class StoreList : std::uint8_t { Own, Trusted, Issuers, Rejected };

/// The name of the list's folder: "trusted".
[[nodiscard]] BUSBAR_API std::string_view name(StoreList list);

/// One file of a list. All texts are `printable`.
struct StoreEntry {
    /// The content of the file.
    enum class Kind : std::uint8_t { Certificate, RevocationList };

    Kind kind{Kind::Certificate};
    /// The path below the store's folder: "trusted/certs/Press 4 [0123...].der".
    std::string file;
    std::string subject; // the issuer for a revocation list
    std::string issuer;
    std::string thumbprint; // SHA-1 in upper-case hexadecimal, for a revocation list too
    DateTime valid_from;    // thisUpdate for a revocation list
    DateTime valid_to;      // nextUpdate for a revocation list, null if it has none
};

/// The lists of a TrustList that an operation applies to (Part 12, 7.8.2.9, TrustListMasks).
struct TrustListParts {
    bool trusted{false};
    bool trusted_crls{false};
    bool issuers{false};
    bool issuer_crls{false};
};

/// Certificates and revocation lists in a Storage, in the folders that OPC UA tools know (Part 12,
/// F.1): `own`, `trusted`, `issuers` and `rejected`, each with `certs` and `crl`; `own/private` for
/// the private keys.
///
/// People and tools may add and remove files at any time, under any name, as DER or PEM, one
/// certificate or revocation list in each; files that the store writes are called "Name
/// [THUMBPRINT].der" or ".crl". Links are not followed. A file that cannot be used is left alone
/// and ignored, and the log says so once for each change of it.
///
/// Two more places are read and never written: `issuer`, which is what Part 12 calls `issuers`, and
/// certificates that lie directly in a list's folder, where Busbar 0.1 had them. Nothing is moved
/// away from there, so that the older version still runs; remove and move reach them.
///
/// After a power failure at any moment a file is as it was before the operation or as it is after
/// it, and a certificate that is being moved is in at least one of both lists. Files that an
/// interrupted writer left are never read; create() removes them. Other processes may read and
/// write the same store.
///
/// Operations block on the storage. One thread at a time.
class BUSBAR_API CertificateStore {
public:
    /// The store is the root of `storage`, which must outlive this object as `log` must.
    CertificateStore(Storage& storage, const StoreLimits& limits, LogSink& log);
    ~CertificateStore();
    CertificateStore(const CertificateStore&) = delete;
    CertificateStore& operator=(const CertificateStore&) = delete;

    /// Creates missing folders and removes temporary files that were left; Bad_ConfigurationError
    /// if a folder cannot be created. Private keys that other users may read are closed to them,
    /// with a warning instead of a refusal: a plant must start again after a backup was restored
    /// with wrong permissions, and a refusal would not undo what others have already read.
    [[nodiscard]] Result<void> create();

    /// The lists that validation uses, up to the limits; files that changed are read again. `now`
    /// identifies files so new that they may still change without a change of their times. Valid
    /// until the next call of any member.
    [[nodiscard]] const TrustList& trust_list(DateTime now);

    /// Saves a certificate that is not trusted in `rejected`, unless it is there already, within
    /// the limits; the log says whether it was saved. `now` is for the limit per minute, a quarter
    /// of which is available to one `source` (see ValidationContext).
    void reject(const Certificate& certificate, DateTime now, std::string_view source = {});

    // For the administrator. Refusals explain what was wrong; the log tells what was done.

    /// Lists the entries in the order of their file names, limited only by the limits of reading.
    [[nodiscard]] std::vector<StoreEntry> list(StoreList list);
    /// Describes one certificate or revocation list of any list as lines of text for people (see
    /// certificate_text). Bad_NotFound.
    [[nodiscard]] Checked<std::string> show(std::string_view thumbprint);
    /// `contents` is one certificate or revocation list, DER or PEM. Bad_CertificateInvalid if it
    /// is neither; Bad_EntryExists; Bad_ResourceUnavailable if the list is full or the disk fails;
    /// Bad_NotSupported for the own list, where a certificate comes with its key.
    [[nodiscard]] Checked<StoreEntry> add(StoreList list, std::span<const std::byte> contents);
    /// Removes every file of the list that holds it. Bad_NotFound, Bad_ResourceUnavailable,
    /// Bad_NotSupported as for add.
    [[nodiscard]] Checked<void> remove(StoreList list, std::string_view thumbprint);
    /// Moves the files to another list; at every moment they are in one of both. If the certificate
    /// was in `to` already, it is only removed from `from`. Errors as for add and remove.
    [[nodiscard]] Checked<void> move(std::string_view thumbprint, StoreList from, StoreList to);

    /// Adds to `change`, of a storage that has this store in the folder `folder`, the steps that
    /// make these lists hold what `wanted` has and nothing else; certificates that are there
    /// already keep their files, and files that cannot be used are left alone.
    /// Bad_ResourceUnavailable if the storage fails or a list would exceed its limit,
    /// Bad_EntryExists if another certificate has the name that a file would get.
    [[nodiscard]] Checked<void> stage(const TrustList& wanted, const TrustListParts& parts,
                                      FileTransaction& change, std::string_view folder = {});

    /// Reports to the log, as add() and remove() do, each certificate and revocation list in which
    /// the lists `after` differ from `before`. Call it when the changes of stage() are committed.
    void tell_changes(const TrustList& before, const TrustList& after);

    /// Reports to the log each certificate and revocation list that came into trusted, issuers and
    /// rejected, left them or was moved since the last call, other than by this object, which
    /// reports its own changes at once. The first call takes the lists as they are. An entry that
    /// cannot be read now counts as still there.
    void tell_found_changes(DateTime now);

    [[nodiscard]] Storage& storage() const { return *storage_; }

private:
    Storage* storage_;
    LogSink* log_;
    std::unique_ptr<detail::StoreLists> lists_;
    std::unique_ptr<detail::StoreRecords> records_;
    std::unique_ptr<detail::RejectedList> rejected_;
};

/// Describes a certificate for people: one line each for subject, issuer, version, serial number,
/// validity, names, key, signature, usage, further extensions and thumbprint. Always printable,
/// whatever the certificate contains.
[[nodiscard]] BUSBAR_API std::string certificate_text(const Certificate& certificate);
/// Describes a revocation list likewise, with up to 1,000 of the serial numbers that it revokes.
[[nodiscard]] BUSBAR_API std::string revocation_list_text(const RevocationList& list);
/// The file name that a store gives to a revocation list: "Name [THUMBPRINT].crl".
[[nodiscard]] BUSBAR_API std::string file_name_of(const RevocationList& list);

} // namespace busbar::crypto
