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

/// An OPN that came, on its way through open_asymmetric.
class OpeningWork final : public OpenWork {
public:
    /// With a policy that is not None; the header points into the message.
    OpeningWork(Kind kind, std::span<const std::byte> message, const AsymmetricHeader& header,
                ApplicationIdentity identity, OpenSender sender);
    ~OpeningWork() override;

    void run() override;

    // After run().

    const crypto::SecurityPolicy& policy;
    ApplicationIdentity identity;
    OpenSender sender;
    Result<AsymmetricContent> opened{fail(status::Bad_SecurityChecksFailed)};

private:
    std::vector<std::byte> message_;
    AsymmetricHeader header_;
};

/// The answer, on its way through make_asymmetric.
class SealingWork final : public OpenWork {
public:
    /// With identity, receiver and body of its own, whatever `parts` has of these.
    SealingWork(Kind kind, const AsymmetricParts& parts, ApplicationIdentity identity,
                crypto::Certificate receiver, std::vector<std::byte> body, std::size_t max_size);
    ~SealingWork() override;

    void run() override;

    Result<std::vector<std::byte>> message{fail(status::Bad_SecurityChecksFailed)};

private:
    ApplicationIdentity identity_;
    crypto::Certificate receiver_;
    std::vector<std::byte> body_; // with the server's nonce
    AsymmetricParts parts_;
    std::size_t max_size_;
};

/// A SecurityToken that is in force once the peer can learn of it.
struct OpenAnswer {
    OpenSecureChannelRequest request;
    Token token;
    /// The encoded response, with a nonce in it.
    std::vector<std::byte> body;
};

/// How far an OpenSecureChannel is that an OpenWorker has. At most one of the two pieces of work
/// is there, and the channel's input is held meanwhile.
struct OpenProgress {
    std::shared_ptr<OpeningWork> opening;
    std::shared_ptr<SealingWork> sealing;
    /// What `sealing` is for.
    std::optional<OpenAnswer> answer;

    [[nodiscard]] bool is_under_way() const { return opening != nullptr || sealing != nullptr; }
};

} // namespace busbar::channel::detail
