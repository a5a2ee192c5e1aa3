#include "open_work.hpp"

#include <utility>

#include <busbar/crypto/secret.hpp>

namespace busbar::channel::detail {

OpeningWork::OpeningWork(Kind kind, std::span<const std::byte> message,
                         const AsymmetricHeader& header, ApplicationIdentity identity_of_receiver,
                         OpenSender from)
    : OpenWork{kind}, policy{*header.policy}, identity{std::move(identity_of_receiver)},
      sender{std::move(from)}, message_{message.begin(), message.end()}
{
    header_.policy = header.policy;
    header_.size = header.size;
}

OpeningWork::~OpeningWork()
{
    if (opened) {
        crypto::cleanse(opened->body);
    }
}

void OpeningWork::run()
{
    opened = open_asymmetric(message_, header_, &identity.key, &sender.certificates.front());
}

SealingWork::SealingWork(Kind kind, const AsymmetricParts& parts, ApplicationIdentity identity,
                         crypto::Certificate receiver, std::vector<std::byte> body,
                         std::size_t max_size)
    : OpenWork{kind}, identity_{std::move(identity)}, receiver_{std::move(receiver)},
      body_{std::move(body)}, parts_{parts}, max_size_{max_size}
{
    parts_.sender = &identity_;
    parts_.receiver = &receiver_;
    parts_.body = body_;
}

SealingWork::~SealingWork()
{
    crypto::cleanse(body_);
}

void SealingWork::run()
{
    message = make_asymmetric(parts_, max_size_);
}

} // namespace busbar::channel::detail
