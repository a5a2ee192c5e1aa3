#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <busbar/administration/managed_certificates.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/trust_list.hpp>
#include <busbar/types/configuration.hpp>
#include <busbar/types/ids.hpp>

#include "permissions.hpp"

namespace busbar::administration::detail {

/// A CertificateGroup (Part 12, 7.8.3).
struct CertificateGroup {
    NodeId id;
    NodeId trust_list_id;
    crypto::CertificateStore* store{nullptr};
    /// Where the store's root lies in the files.
    std::string folder;
    crypto::CertificatePurpose purpose{};
    /// Counts the changes, so that who reads the list in pieces knows of them.
    std::uint32_t version{0};
};

/// Changes of certificates and trust lists that are applied together or not at all (Part 12,
/// 7.10.2): begun by the first of them, by one user in one session, and over with ApplyChanges,
/// CancelChanges, the session, or another user of the session.
///
/// On the server's thread, but apply(), which may be called where nothing else uses the files.
class Transaction {
public:
    Transaction(const ManagedCertificates& files, const WallClock& clock)
        : files_{files}, clock_{clock}
    {
    }

    [[nodiscard]] std::vector<CertificateGroup>& groups() { return groups_; }
    [[nodiscard]] bool is_active() const { return owner_.has_value(); }
    /// Null if there is none.
    [[nodiscard]] const Holder* owner() const { return owner_ ? &*owner_ : nullptr; }
    /// Begins one or goes on with it: Bad_TransactionPending if another session has one.
    [[nodiscard]] StatusCode enter(const Holder& holder);
    /// Good if the session may end it: Bad_NothingToDo if there is none, Bad_SessionIdInvalid if it
    /// is another's.
    [[nodiscard]] StatusCode check_end(const Holder& holder) const;

    /// What the group's list will be.
    void set_trust_list(std::size_t group, crypto::TrustList list, crypto::TrustListParts parts);
    void set_own_certificate(crypto::OwnCertificate own);
    /// There has to be another one before apply().
    void delete_own_certificate();
    [[nodiscard]] bool is_own_deleted() const { return is_active() && is_own_deleted_; }
    /// The list as it will be, or as it is.
    [[nodiscard]] crypto::TrustList trust_list(std::size_t group) const;

    /// What apply() has changed.
    struct Changed {
        std::vector<std::size_t> groups;
        std::optional<crypto::OwnCertificate> own;
    };
    /// Writes all of it. Refused: nothing has changed, and the transaction is over as well, unless
    /// there was no memory.
    [[nodiscard]] Checked<Changed> apply(std::string_view application_uri);
    void cancel(StatusCode why);

    // TransactionDiagnostics (Part 12, 7.10.17): of the last one, also after its end.

    [[nodiscard]] bool has_begun() const { return has_begun_; }
    [[nodiscard]] DateTime start_time() const { return start_time_; }
    [[nodiscard]] DateTime end_time() const { return end_time_; }
    [[nodiscard]] StatusCode result() const { return result_; }
    [[nodiscard]] const std::vector<NodeId>& affected_trust_lists() const { return trust_lists_; }
    [[nodiscard]] const std::vector<NodeId>& affected_groups() const { return affected_groups_; }
    [[nodiscard]] const std::vector<TransactionErrorType>& errors() const { return errors_; }

private:
    struct NewList {
        std::size_t group;
        crypto::TrustList list;
        crypto::TrustListParts parts;
    };

    [[nodiscard]] Checked<void> write(FileTransaction& change, std::string_view application_uri);
    void end(StatusCode result);

    const ManagedCertificates& files_;
    const WallClock& clock_;
    std::vector<CertificateGroup> groups_;
    std::optional<Holder> owner_;
    std::vector<NewList> lists_;
    std::optional<crypto::OwnCertificate> own_;
    bool is_own_deleted_{false};

    bool has_begun_{false};
    DateTime start_time_;
    DateTime end_time_;
    StatusCode result_;
    std::vector<NodeId> trust_lists_;
    std::vector<NodeId> affected_groups_;
    std::vector<TransactionErrorType> errors_;
};

/// Enters a Transaction. One that this begins is over again with it, unless keep() was called when
/// something was changed: what fails leaves no transaction that keeps others out.
class TransactionEntry {
public:
    TransactionEntry(Transaction& transaction, const Holder& holder)
        : transaction_{transaction},
          is_undone_{!transaction.is_active()}, status_{transaction.enter(holder)}
    {
    }
    TransactionEntry(const TransactionEntry&) = delete;
    TransactionEntry& operator=(const TransactionEntry&) = delete;
    ~TransactionEntry()
    {
        if (is_undone_) {
            transaction_.cancel(StatusCode{busbar::status::Bad_ResourceUnavailable});
        }
    }

    /// That of Transaction::enter.
    [[nodiscard]] StatusCode status() const { return status_; }
    void keep() { is_undone_ = false; }

private:
    Transaction& transaction_;
    bool is_undone_;
    StatusCode status_;
};

/// The reason of Bad_TransactionPending, for an administrator.
inline constexpr const char* other_transaction =
    "another session is changing certificates: it must apply or cancel its changes, or end";

/// Finishes what an earlier change of the folder has decided; before anything is staged.
[[nodiscard]] Checked<void> prepare_files(FileTransaction& change);
/// Writes all of it. Refused: nothing has changed, unless it was decided and the medium failed on
/// the way; then the next prepare_files or finish_changes goes on with it.
[[nodiscard]] Checked<void> commit_files(FileTransaction& change);

/// The CertificateType of the server's own certificate.
inline constexpr std::uint32_t certificate_type = id::RsaSha256ApplicationCertificateType;

/// The only format of private keys that clients send (Part 12, 7.10.5).
inline constexpr std::string_view private_key_format = "PEM";

/// The folder of FileTransactions in ManagedCertificates::files.
inline constexpr const char* transaction_folder = "transaction";

} // namespace busbar::administration::detail
