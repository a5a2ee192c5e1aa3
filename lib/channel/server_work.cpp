#include <utility>

#include "refusals.hpp"
#include "server_impl.hpp"

namespace busbar::channel {

using namespace detail;

namespace {

Unexpected<Refusal> no_room()
{
    return refuse({status::Bad_TcpServerTooBusy, "OpenSecureChannel",
                   "more than the worker has room for", "Part 6, 7.1.5",
                   "Find out which client connects so often"});
}

} // namespace

bool ServerChannel::Impl::has_worker_for(const crypto::SecurityPolicy& policy) const
{
    return conversation.environment().worker != nullptr && !policy.is_none();
}

OpenWork::Kind ServerChannel::Impl::kind_of_work(OpenWork::Kind of_new_channel) const
{
    return state == State::Open ? OpenWork::Kind::Renewal : of_new_channel;
}

/// The certificates are checked here: their validator belongs to this thread.
Checked<void> ServerChannel::Impl::hand_over_request(const Frame& frame,
                                                     const AsymmetricHeader& header)
{
    const OpenContext context{config, state == State::Open, client_nonce};
    auto sender = read_open_sender(header, conversation, context);
    if (!sender) {
        return refuse(std::move(sender).error());
    }
    progress.opening =
        std::make_shared<OpeningWork>(kind_of_work(OpenWork::Kind::Request), frame.bytes, header,
                                      *conversation.environment().identity, *std::move(sender));
    return hand_over(progress.opening);
}

Checked<void> ServerChannel::Impl::hand_over_answer(OpenAnswer answer, ApplicationIdentity identity,
                                                    std::uint32_t request_id)
{
    progress.sealing = std::make_shared<SealingWork>(
        kind_of_work(OpenWork::Kind::Answer), conversation.open_parts(request_id),
        std::move(identity), conversation.peer_certificates.front(), std::exchange(answer.body, {}),
        conversation.sizes().send_buffer_size);
    progress.answer = std::move(answer);
    // It has its sequence number, so that later messages have later ones (Part 6, 6.7.2.4).
    conversation.output().open_gap();
    return hand_over(progress.sealing);
}

Checked<void> ServerChannel::Impl::hand_over(std::shared_ptr<OpenWork> work)
{
    conversation.is_held = true;
    if (!conversation.environment().worker->start(std::move(work))) {
        is_at_work = false; // not the peer's fault
        return no_room();
    }
    return {};
}

void ServerChannel::Impl::work_done(StatusCode status)
{
    if (!progress.is_under_way()) {
        return;
    }
    if (status.is_bad()) {
        is_at_work = false;
        if (status == status::Bad_TcpServerTooBusy) {
            give_up(no_room().error());
        } else {
            fail_with(status, status, "asymmetric work");
        }
        return;
    }
    OpenProgress done = std::exchange(progress, {});
    conversation.is_held = false;
    const auto went = done.opening ? request_opened(*done.opening)
                                   : answer_sealed(*done.sealing, *std::move(done.answer));
    if (!went) {
        give_up(went.error());
    }
}

Checked<void> ServerChannel::Impl::request_opened(OpeningWork& work)
{
    const OpenContext context{config, state == State::Open, client_nonce};
    auto request = judge_open_request(std::move(work.opened), std::move(work.sender), work.policy,
                                      conversation, context);
    if (!request) {
        return refuse(std::move(request).error());
    }
    take_over(*request);
    auto answer = make_answer(std::move(request->body));
    if (!answer) {
        return refuse(protocol_refusal(answer.error()));
    }
    return hand_over_answer(*std::move(answer), std::move(work.identity), request->request_id);
}

Checked<void> ServerChannel::Impl::answer_sealed(const SealingWork& work, OpenAnswer answer)
{
    if (!work.message) {
        return refuse(protocol_refusal(work.message.error()));
    }
    conversation.output().fill_gap(*work.message);
    put_in_force(std::move(answer));
    return {};
}

void ServerChannel::Impl::drop_work()
{
    if (std::exchange(progress, {}).is_under_way()) {
        conversation.environment().worker->drop();
    }
    conversation.output().drop_gap();
}

} // namespace busbar::channel
