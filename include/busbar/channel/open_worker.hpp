#pragma once

#include <cstdint>
#include <memory>

#include <busbar/core/api.hpp>

namespace busbar::channel {

/// The asymmetric work of one OpenSecureChannel (Part 6, 6.7.2): decrypting and verifying the
/// request, or signing and encrypting the answer. It has copies of everything it needs, and shares
/// the keys of the identity that was in use when it began: neither its channel nor that identity
/// has to outlive it.
class BUSBAR_API OpenWork {
public:
    /// In the order of precedence when there is more work than time.
    enum class Kind : std::uint8_t {
        Request, // of a new channel, whose peer is not yet known
        Answer,  // to a request that was verified
        Renewal, // both, for an open channel
    };

    explicit OpenWork(Kind kind) : kind_{kind} {}
    OpenWork(const OpenWork&) = delete;
    OpenWork& operator=(const OpenWork&) = delete;
    virtual ~OpenWork() = default;

    [[nodiscard]] Kind kind() const { return kind_; }
    /// Does the work, once, on any thread; takes milliseconds. Throws std::bad_alloc if an
    /// allocation fails.
    virtual void run() = 0;

private:
    Kind kind_;
};

/// Moves the asymmetric work of a server's channels elsewhere, so that only the channel concerned
/// waits for it. Called on the channel's thread.
class BUSBAR_API OpenWorker {
public:
    OpenWorker() = default;
    OpenWorker(const OpenWorker&) = delete;
    OpenWorker& operator=(const OpenWorker&) = delete;
    virtual ~OpenWorker() = default;

    /// Schedules `work` to run later, and calls ServerChannel::work_done after that, or when there
    /// is no time for it after all; never from within this call. False if there is no room: the
    /// peer is told Bad_TcpServerTooBusy (Part 6, 7.1.5), and the channel ends. A channel has one
    /// piece of work at a time.
    [[nodiscard]] virtual bool start(std::shared_ptr<OpenWork> work) = 0;
    /// The channel has ended, and its work is of no use any more.
    virtual void drop() = 0;
};

} // namespace busbar::channel
