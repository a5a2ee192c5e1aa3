#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <busbar/channel/open_worker.hpp>

#include "open_request.hpp"
#include "token.hpp"

namespace busbar::channel::detail {

/// An OPN that arrived, to be processed by open_asymmetric.
class OpeningWork final : public OpenWork {
public:
    /// For policies other than None; the header points into the message.
    OpeningWork(Kind kind, std::span<const std::byte> message, const AsymmetricHeader& header,
                ApplicationIdentity identity, OpenSender sender);
    ~OpeningWork() override;

    void run() override;

    // Valid after run().

    const crypto::SecurityPolicy& policy;
    ApplicationIdentity identity;
    OpenSender sender;
    Result<AsymmetricContent> opened{fail(status::Bad_SecurityChecksFailed)};

private:
    std::vector<std::byte> message_;
    AsymmetricHeader header_;
};

/// The answer, to be processed by make_asymmetric.
class SealingWork final : public OpenWork {
public:
    /// Uses the given identity, receiver and body instead of those in `parts`.
    SealingWork(Kind kind, const AsymmetricParts& parts, ApplicationIdentity identity,
                crypto::Certificate receiver, std::vector<std::byte> body, std::size_t max_size);
    ~SealingWork() override;

    void run() override;

    Result<std::vector<std::byte>> message{fail(status::Bad_SecurityChecksFailed)};

private:
    ApplicationIdentity identity_;
    crypto::Certificate receiver_;
    std::vector<std::byte> body_; // contains the server's nonce
    AsymmetricParts parts_;
    std::size_t max_size_;
};

/// A SecurityToken that comes into force once the peer can learn of it.
struct OpenAnswer {
    OpenSecureChannelRequest request;
    Token token;
    /// The encoded response, which contains a nonce.
    std::vector<std::byte> body;
};

/// The state of an OpenSecureChannel that an OpenWorker processes. At most one of the two pieces of
/// work exists, and the channel's input is held meanwhile.
struct OpenProgress {
    std::shared_ptr<OpeningWork> opening;
    std::shared_ptr<SealingWork> sealing;
    /// The answer that `sealing` is working on.
    std::optional<OpenAnswer> answer;

    [[nodiscard]] bool is_under_way() const { return opening != nullptr || sealing != nullptr; }
};

} // namespace busbar::channel::detail
