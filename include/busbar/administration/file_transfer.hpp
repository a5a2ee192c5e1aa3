#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/named_fields.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/server/access_control.hpp>

namespace busbar::administration {

/// What clients may hold and make by one TemporaryFileTransfer, all sessions together. When there
/// is no room for a file, the user who has most loses one to a user who has less.
struct TransferLimits {
    /// Bytes of one file, which is in memory until it is closed.
    std::size_t max_file_size{16U << 20U};
    /// Bytes of all files.
    std::size_t max_held{32U << 20U};
    std::size_t max_open{8};
    std::size_t max_open_of_session{2};
    /// Of those that clients write: with 1 the second of two who write at once is refused.
    std::size_t max_written{8};
};

/// What a client wants: whatever it gave as generateOptions, of any type or null, who it is and in
/// which session. Valid as long as the call.
struct TransferRequest {
    const Variant& options;
    const server::UserIdentity& user;
    const NodeId& session;
};

/// The program on the other side of a TemporaryFileTransfer: it makes files and takes them. On the
/// server's thread, which everybody waits for meanwhile, but for preparation(). Bad statuses
/// go to the client as they are.
class BUSBAR_API TransferOwner {
public:
    TransferOwner() = default;
    TransferOwner(const TransferOwner&) = delete;
    TransferOwner& operator=(const TransferOwner&) = delete;
    virtual ~TransferOwner() = default;

    /// The bytes of a file, at most `max_size`: what is larger is refused, with
    /// Bad_EncodingLimitsExceeded. Bad_InvalidArgument for options that are none of this owner's.
    [[nodiscard]] virtual Result<std::vector<std::byte>> generate(const TransferRequest&,
                                                                  std::size_t /*max_size*/)
    {
        return fail(status::Bad_NotSupported);
    }
    /// Whether a file with these options would be taken, asked before the client sends it.
    [[nodiscard]] virtual StatusCode may_take(const TransferRequest&)
    {
        return status::Bad_NotSupported;
    }
    /// Takes the file as a whole, or not at all. The options are those of may_take. After a bad
    /// status the client has it still, and may try again.
    [[nodiscard]] virtual StatusCode take(const TransferRequest&, std::span<const std::byte>)
    {
        return status::Bad_NotSupported;
    }
    /// Why one of these refused, asked right after it did, for administrators (see
    /// server::CallResult::reason); empty where the status says it all.
    [[nodiscard]] virtual std::string why_refused() const { return {}; }
    /// What has to be done before take() and would keep the server waiting; empty: nothing. Asked
    /// after may_take, on the server's thread, so that it may take along a copy of what it needs;
    /// the bytes stay until take() or, if that does not come, until it is destroyed.
    ///
    /// It is called on Administration's worker, so it touches nothing that the server's thread may
    /// use meanwhile; without a worker on the server's thread. Others are served meanwhile, and no
    /// other file is committed. If it throws, or there is nobody to do it, or the user's right or
    /// session has gone meanwhile, take() does not come.
    [[nodiscard]] virtual std::function<void()> preparation(const TransferRequest&,
                                                            std::span<const std::byte>)
    {
        return {};
    }
};

/// An Object of TemporaryFileTransferType (Part 20, 4.4) below Objects: clients read what a program
/// makes for them and send it what it takes, such as backups and projects.
///
/// A file is there for the session that asked for it, and for nobody else: nobody can browse down
/// to its Object or guess its NodeId, and its handle is void in other sessions. Users with the same
/// roles who list all instances of FileType see that there is one, and its size. It goes when it is
/// closed, when CloseAndCommit has handed it over, with its session, or when the client lets
/// `client_processing_timeout` pass between two Methods; what the last two leave is removed at the
/// next Method that anybody calls. All is done before a Method answers: completionStateMachine is
/// null.
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
    /// Those that get and send them.
    std::vector<NodeId> writers{};
};

} // namespace busbar::administration
