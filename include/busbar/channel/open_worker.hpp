#pragma once

#include <cstdint>
#include <memory>

#include <busbar/core/api.hpp>

namespace busbar::channel {

/// Asymmetric work of one OpenSecureChannel (Part 6, 6.7.2): to decrypt and verify what came, or to
/// sign and encrypt the answer. It has copies of all it needs, and shares the keys of the identity
/// that there was when it was begun: neither its channel nor that identity has to outlive it.
class BUSBAR_API OpenWork {
public:
    /// In the order in which it is to be done where there is more than can be.
    enum class Kind : std::uint8_t {
        Request, // of a new channel: whose it is, nobody knows yet
        Answer,  // to one that was found to be right
        Renewal, // both, of a channel that is open
    };

    explicit OpenWork(Kind kind) : kind_{kind} {}
    OpenWork(const OpenWork&) = delete;
    OpenWork& operator=(const OpenWork&) = delete;
    virtual ~OpenWork() = default;

    [[nodiscard]] Kind kind() const { return kind_; }
    /// Does it, once, on any thread; takes milliseconds. Throws what a failed allocation does.
    virtual void run() = 0;

private:
    Kind kind_;
};

/// Has the asymmetric work of one server's channel done elsewhere, so that nobody waits for it but
/// that channel. On the channel's thread.
class BUSBAR_API OpenWorker {
public:
    OpenWorker() = default;
    OpenWorker(const OpenWorker&) = delete;
    OpenWorker& operator=(const OpenWorker&) = delete;
    virtual ~OpenWorker() = default;

    /// Has `work` run later, and calls ServerChannel::work_done then, or when there is no time for
    /// it after all; never from within. False if there is no room: the peer is told
    /// Bad_TcpServerTooBusy (Part 6, 7.1.5), and the channel ends. One piece at a time.
    [[nodiscard]] virtual bool start(std::shared_ptr<OpenWork> work) = 0;
    /// The channel has ended, and what was started is of no use any more.
    virtual void drop() = 0;
};

} // namespace busbar::channel
