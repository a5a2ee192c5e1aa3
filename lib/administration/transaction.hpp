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
    /// Path of the store's root in the files.
    std::string folder;
    crypto::CertificatePurpose purpose{};
    /// Number of changes, by which a session that reads the list in pieces detects them.
    std::uint32_t version{0};
};

/// Collects changes of certificates and trust lists that are applied together or not at all (Part
/// 12, 7.10.2). The first change begins a transaction, which belongs to one user in one session.
/// ApplyChanges, CancelChanges, the end of the session or a change of its user ends it.
///
/// Used on the server's thread, except apply(), which may be called where nothing else uses the
/// files.
class Transaction {
public:
    Transaction(const ManagedCertificates& files, const WallClock& clock)
        : files_{files}, clock_{clock}
    {
    }

    [[nodiscard]] std::vector<CertificateGroup>& groups() { return groups_; }
    [[nodiscard]] bool is_active() const { return owner_.has_value(); }
    /// Null if no transaction is active.
    [[nodiscard]] const Holder* owner() const { return owner_ ? &*owner_ : nullptr; }
    /// Begins or continues a transaction: Bad_TransactionPending if another session has one.
    [[nodiscard]] StatusCode enter(const Holder& holder);
    /// Good if the session may end the transaction: Bad_NothingToDo if there is none,
    /// Bad_SessionIdInvalid if it belongs to another session.
    [[nodiscard]] StatusCode check_end(const Holder& holder) const;

    /// Sets the group's future list.
    void set_trust_list(std::size_t group, crypto::TrustList list, crypto::TrustListParts parts);
    void set_own_certificate(crypto::OwnCertificate own);
    /// Deletes the own certificate; a new one must be set before apply().
    void delete_own_certificate();
    [[nodiscard]] bool is_own_deleted() const { return is_active() && is_own_deleted_; }
    /// Returns the future list, or the present one if it is not changed.
    [[nodiscard]] crypto::TrustList trust_list(std::size_t group) const;

    /// The result of apply().
    struct Changed {
        std::vector<std::size_t> groups;
        std::optional<crypto::OwnCertificate> own;
    };
    /// Writes all changes. If refused, nothing has changed; the transaction ends as well, unless
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

/// Enters a Transaction. Ends it again on destruction if this began it, unless keep() was called
/// after a change: a failed request must not leave a transaction that blocks other sessions.
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

    /// Returns the status of Transaction::enter.
    [[nodiscard]] StatusCode status() const { return status_; }
    void keep() { is_undone_ = false; }

private:
    Transaction& transaction_;
    bool is_undone_;
    StatusCode status_;
};

/// Reason for an administrator with Bad_TransactionPending.
inline constexpr const char* other_transaction =
    "another session is changing certificates: it must apply or cancel its changes, or end";

/// Finishes an earlier change of the folder that was decided; call it before staging anything.
[[nodiscard]] Checked<void> prepare_files(FileTransaction& change);
/// Writes all changes. If refused, nothing has changed, unless the change was decided and then the
/// medium failed; the next prepare_files or finish_changes continues with it.
[[nodiscard]] Checked<void> commit_files(FileTransaction& change);

/// The CertificateType of the server's own certificate.
inline constexpr std::uint32_t certificate_type = id::RsaSha256ApplicationCertificateType;

/// The only format of private keys that clients send (Part 12, 7.10.5).
inline constexpr std::string_view private_key_format = "PEM";

/// The folder of FileTransactions in ManagedCertificates::files.
inline constexpr const char* transaction_folder = "transaction";

} // namespace busbar::administration::detail
