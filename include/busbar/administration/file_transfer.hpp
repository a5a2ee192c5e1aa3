#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/named_fields.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/server/access_control.hpp>

namespace busbar::administration {

/// Limits what clients may hold and create by one TemporaryFileTransfer, for all sessions together.
/// If there is no room for a file, the user who has most loses one to a user who has less.
struct TransferLimits {
    /// Bytes of one file, which is in memory until it is closed.
    std::size_t max_file_size{16U << 20U};
    /// Bytes of all files.
    std::size_t max_held{32U << 20U};
    std::size_t max_open{8};
    std::size_t max_open_of_session{2};
    /// Number of files that clients write: with 1 the second of two concurrent writers is refused.
    std::size_t max_written{8};
};

/// A client's request: its generateOptions, of any type or null, its user and session, and the
/// Method that it calls. Valid for the duration of the call. A record of what the request changes
/// names the Method in its field MethodId, since the Method has an audit event already (AuditLog).
struct TransferRequest {
    const Variant& options;
    const server::UserIdentity& user;
    const NodeId& session;
    /// Null for a request that is not a Call.
    const NodeId* method{nullptr};
};

/// The program on the other side of a TemporaryFileTransfer: it creates files and takes them.
/// Called on the server's thread, which serves nothing else meanwhile, except for preparation().
/// Bad statuses go to the client unchanged.
class BUSBAR_API TransferOwner {
public:
    TransferOwner() = default;
    TransferOwner(const TransferOwner&) = delete;
    TransferOwner& operator=(const TransferOwner&) = delete;
    virtual ~TransferOwner() = default;

    /// Returns the bytes of a file, at most `max_size`: a larger one is refused with
    /// Bad_EncodingLimitsExceeded. Bad_InvalidArgument for options that this owner does not know.
    [[nodiscard]] virtual Result<std::vector<std::byte>> generate(const TransferRequest&,
                                                                  std::size_t /*max_size*/)
    {
        return fail(status::Bad_NotSupported);
    }
    /// Returns whether a file with these options would be accepted, called before the client sends
    /// it.
    [[nodiscard]] virtual StatusCode may_take(const TransferRequest&)
    {
        return status::Bad_NotSupported;
    }
    /// Takes the file completely, or not at all. The options are those of may_take. After a bad
    /// status the client still has it, and may try again.
    [[nodiscard]] virtual StatusCode take(const TransferRequest&, std::span<const std::byte>)
    {
        return status::Bad_NotSupported;
    }
    /// Returns why one of these functions refused, called right after it, for administrators (see
    /// server::CallResult::reason); empty if the status says everything.
    [[nodiscard]] virtual std::string why_refused() const { return {}; }
    /// Returns work that must be done before take() and would block the server; empty for none.
    /// Called after may_take, on the server's thread, so that it may copy what it needs; the bytes
    /// stay valid until take() or, if that is not called, until the work is destroyed.
    ///
    /// It runs on Administration's worker, so it must not access anything that the server's thread
    /// may use meanwhile; without a worker it runs on the server's thread. Other clients are served
    /// meanwhile, and no other file is committed. If it throws, cannot be run, or the user's right
    /// or session has ended meanwhile, take() is not called.
    [[nodiscard]] virtual std::function<void()> preparation(const TransferRequest&,
                                                            std::span<const std::byte>)
    {
        return {};
    }
};

/// An Object of TemporaryFileTransferType (Part 20, 4.4) below Objects: clients read files that a
/// program creates for them and send files to it, such as backups and projects.
///
/// A file exists only for the session that requested it: its Object cannot be browsed to, its
/// NodeId cannot be guessed, and its handle is invalid in other sessions. Users with the same roles
/// who list all instances of FileType see that it exists, and its size. It is removed when it is
/// closed, when CloseAndCommit has delivered it, with its session, or when the client lets
/// `client_processing_timeout` pass between two Methods; in the last two cases at the next call of
/// any Method. Everything is done before a Method answers: completionStateMachine is null.
struct TemporaryFileTransfer {
    [[no_unique_address]] NamedFields named_fields{};

    /// BrowseName, and a part of all NodeIds: "Transfers/backup".
    std::string name;
    /// Must outlive the Administration.
    TransferOwner* owner{nullptr};
    TransferLimits limits{};
    /// ClientProcessingTimeout.
    std::chrono::milliseconds client_processing_timeout{60'000};
    /// Roles that get files, over encrypted channels.
    std::vector<NodeId> readers{};
    /// Roles that get and send files.
    std::vector<NodeId> writers{};
};

} // namespace busbar::administration
