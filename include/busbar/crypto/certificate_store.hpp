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

/// "trusted", as the folder is called.
[[nodiscard]] BUSBAR_API std::string_view name(StoreList list);

/// One file of a list. All texts are `printable`.
struct StoreEntry {
    enum class Kind : std::uint8_t { Certificate, RevocationList };

    Kind kind{Kind::Certificate};
    /// Below the store's folder: "trusted/certs/Press 4 [0123...].der".
    std::string file;
    std::string subject; // of a revocation list its issuer
    std::string issuer;
    std::string thumbprint; // SHA-1 in upper-case hexadecimal; of a revocation list too
    DateTime valid_from;    // of a revocation list thisUpdate
    DateTime valid_to;      // and nextUpdate, null if it has none
};

/// The lists of a TrustList that an operation is about (Part 12, 7.8.2.9, TrustListMasks).
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
/// Files may come and go at any time, by the hands of people or tools, under any name, as DER or
/// PEM, one certificate or revocation list in each; what is written here is called
/// "Name [THUMBPRINT].der" or ".crl". Links are not followed. A file that cannot be used is left
/// alone, does not count, and the log says so once for each change of it.
///
/// Two more places are read, and written never: `issuer`, which is what Part 12 calls `issuers`,
/// and certificates that lie directly in a list's folder, where Busbar 0.1 had them. Nothing is
/// moved away from there, so that the older version still runs; remove and move reach them.
///
/// After a power cut at any moment a file is there as it was before or as it is after the
/// operation, and a certificate that is moved in at least one of both lists. What a writer that
/// died left is never read; create() removes it. Other processes may read and write the same store.
///
/// Operations block on the storage. One thread at a time.
class BUSBAR_API CertificateStore {
public:
    /// The store is the root of `storage`, which must outlive this object as `log` must.
    CertificateStore(Storage& storage, const StoreLimits& limits, LogSink& log);
    ~CertificateStore();
    CertificateStore(const CertificateStore&) = delete;
    CertificateStore& operator=(const CertificateStore&) = delete;

    /// Makes the folders that are missing and removes temporary files that were left behind;
    /// Bad_ConfigurationError if a folder cannot be made. Private keys that others may read are
    /// closed to them, with a warning instead of a refusal: a plant must start again after a backup
    /// was restored with wrong permissions, and refusing would not undo what others have read
    /// already.
    [[nodiscard]] Result<void> create();

    /// The lists that validation uses, up to the limits; files that changed are read again. `now`
    /// tells fresh files apart, which may still change without a change of their times. Valid until
    /// the next call of any member.
    [[nodiscard]] const TrustList& trust_list(DateTime now);

    /// Saves a certificate that is not trusted in `rejected`, unless it is there already, within
    /// the limits; the log says what became of it. `now` is for the limit per minute, of which one
    /// `source` has a quarter (see ValidationContext).
    void reject(const Certificate& certificate, DateTime now, std::string_view source = {});

    // For the administrator. Refusals say in words what was wrong; the log says what was done.

    /// In the order of the file names; no limits but those of reading.
    [[nodiscard]] std::vector<StoreEntry> list(StoreList list);
    /// One certificate or revocation list, from whatever list it lies in, as lines of text for
    /// people (see certificate_text). Bad_NotFound.
    [[nodiscard]] Checked<std::string> show(std::string_view thumbprint);
    /// `contents` is one certificate or revocation list, DER or PEM. Bad_CertificateInvalid if it
    /// is neither; Bad_EntryExists; Bad_ResourceUnavailable if the list is full or the disk fails;
    /// Bad_NotSupported for the own list, where a certificate comes with its key.
    [[nodiscard]] Checked<StoreEntry> add(StoreList list, std::span<const std::byte> contents);
    /// Removes every file of the list that holds it. Bad_NotFound, Bad_ResourceUnavailable,
    /// Bad_NotSupported as for add.
    [[nodiscard]] Checked<void> remove(StoreList list, std::string_view thumbprint);
    /// At no moment is it in neither list. If it was in `to` already, it just leaves `from`. Errors
    /// as for add and remove.
    [[nodiscard]] Checked<void> move(std::string_view thumbprint, StoreList from, StoreList to);

    /// Lays down in `change`, of a storage that has this store in the folder `folder`, what makes
    /// these lists hold what `wanted` has and nothing else; certificates that are there already
    /// keep their files, and files that cannot be used are left alone. Bad_ResourceUnavailable if
    /// the storage fails or a list would have more than its limit, Bad_EntryExists if the name that
    /// a file would get is taken by another certificate.
    [[nodiscard]] Checked<void> stage(const TrustList& wanted, const TrustListParts& parts,
                                      FileTransaction& change, std::string_view folder = {});

    /// Tells the log, as add() and remove() do, of each certificate and revocation list in which
    /// the lists `after` differ from `before`: once what stage() laid down is committed.
    void tell_changes(const TrustList& before, const TrustList& after);

    /// Tells the log of each certificate and revocation list that came into trusted, issuers and
    /// rejected since the last call, went from them or was moved, by other hands than this
    /// object's, which tells at once of what it does. The first call takes the lists as they are.
    /// What cannot be read now counts as being there still.
    void tell_found_changes(DateTime now);

    [[nodiscard]] Storage& storage() const { return *storage_; }

private:
    Storage* storage_;
    LogSink* log_;
    std::unique_ptr<detail::StoreLists> lists_;
    std::unique_ptr<detail::StoreRecords> records_;
    std::unique_ptr<detail::RejectedList> rejected_;
};

/// What a certificate says, for people: one line each for subject, issuer, version, serial number,
/// validity, names, key, signature, usage, further extensions and thumbprint. Printable whatever it
/// contains.
[[nodiscard]] BUSBAR_API std::string certificate_text(const Certificate& certificate);
/// The same of a revocation list, with the serial numbers that it revokes, up to 1,000.
[[nodiscard]] BUSBAR_API std::string revocation_list_text(const RevocationList& list);
/// What a store calls the file of a revocation list that it takes: "Name [THUMBPRINT].crl".
[[nodiscard]] BUSBAR_API std::string file_name_of(const RevocationList& list);

} // namespace busbar::crypto
