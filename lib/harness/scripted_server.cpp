#include <busbar/harness/scripted_server.hpp>

#include <algorithm>
#include <utility>

#include <busbar/harness/report.hpp>
#include <busbar/harness/text.hpp>

#include "chunks.hpp"
#include "dissector.hpp"

namespace busbar::harness {

namespace {

constexpr std::size_t max_unexpected = 100;
constexpr std::size_t max_came = 10'000;

/// Every request begins with its header (Part 4, 7.32).
Result<std::vector<std::byte>> make_fault(std::span<const std::byte> request, StatusCode status,
                                          DateTime now)
{
    binary::Reader reader{request};
    NodeId id;
    RequestHeader header;
    decode(reader, id);
    decode(reader, header);
    ServiceFault fault;
    fault.response_header.timestamp = now;
    fault.response_header.request_handle = header.request_handle;
    fault.response_header.service_result = status;
    return encode_body(fault);
}

} // namespace

/// The server's end of one connection.
class ScriptedServer::Peer final : public LinkEnd {
public:
    Peer(ScriptedServer& server, channel::ServerChannelConfig config,
         channel::ChannelEnvironment environment, std::shared_ptr<Link> link)
        : server_{server}, link_{std::move(link)}, chunks_{*environment.chunk_hook},
          channel_{std::move(config), with_hook(environment, chunks_), server.world_.now()},
          deadline_{scheduler(),
                    [this] {
                        channel_.handle_deadline(scheduler().now());
                        update();
                    }},
          answers_{scheduler(), [this] { answer_due(); }}
    {
        deadline_.set(channel_.next_deadline());
    }
    ~Peer() override
    {
        if (link_ != nullptr) {
            link_->leave(Side::Server);
        }
    }

    [[nodiscard]] bool has_ended() const { return link_ == nullptr; }
    [[nodiscard]] std::span<const std::byte> output() const override { return output_; }
    void consume(std::size_t size) override
    {
        output_.erase(output_.begin(), output_.begin() + static_cast<std::ptrdiff_t>(size));
    }
    void feed(std::span<const std::byte> in) override
    {
        static_cast<void>(channel_.feed(in, scheduler().now()));
        update();
    }
    void link_lost() override
    {
        link_.reset();
        deadline_.cancel();
        answers_.cancel();
    }
    Result<void> send(std::uint32_t request_id, std::span<const std::byte> body, const Wrong& wrong)
    {
        if (!channel_.is_open()) {
            return fail(status::Bad_NotConnected);
        }
        auto sent = chunks_.send(wrong, body, [&](auto encode) { //
            return channel_.send(request_id, encode);
        });
        flush();
        return sent;
    }
    void send_bytes(std::span<const std::byte> bytes)
    {
        flush();
        output_.insert(output_.end(), bytes.begin(), bytes.end());
        flush();
    }

private:
    struct Due {
        TimePoint time;
        std::uint32_t request_id{0};
        std::vector<std::byte> body;
        std::optional<StatusCode> end;
        Wrong wrong;
        std::shared_ptr<detail::Hold> hold;

        [[nodiscard]] bool is_held() const { return hold != nullptr && !hold->is_open; }
    };

    static channel::ChannelEnvironment with_hook(channel::ChannelEnvironment environment,
                                                 channel::ChunkHook& hook)
    {
        environment.chunk_hook = &hook;
        return environment;
    }
    [[nodiscard]] Scheduler& scheduler() const { return server_.world_.scheduler(); }
    void update()
    {
        while (auto event = channel_.next_event()) {
            if (event->kind == channel::ChannelEvent::Kind::Message) {
                handle(event->request_id, event->body);
            }
        }
        answer_due();
    }
    void handle(std::uint32_t request_id, std::span<const std::byte> request)
    {
        const DateTime now = server_.world_.clock().now();
        const auto step = server_.take_step(request);
        Due due{scheduler().now(), request_id, {}, {}, {}, {}};
        if (!step) {
            due.body = make_fault(request, status::Bad_ServiceUnsupported, now).value_or(due.body);
        } else {
            due.time += step->delay;
            due.end = step->end;
            due.wrong = step->wrong;
            due.hold = step->hold;
            if (due.is_held()) {
                due.hold->waiting.emplace_back([this, alive = std::weak_ptr{alive_}] {
                    if (!alive.expired()) {
                        answers_.set_after(Duration{0});
                    }
                });
            }
            if (step->answer) {
                server_.channel_ = &channel_;
                auto body = step->answer(request, now, step->wrong);
                server_.channel_ = nullptr;
                due.body = body ? *std::move(body)
                                : make_fault(request, body.error(), now).value_or(due.body);
            }
        }
        const auto place = std::upper_bound(
            due_.begin(), due_.end(), due.time,
            [](TimePoint time, const Due& other_due) { return time < other_due.time; });
        due_.insert(place, std::move(due));
    }
    /// Returns the first that nothing keeps, whether its time has come or not.
    [[nodiscard]] std::deque<Due>::iterator next_due()
    {
        return std::find_if(due_.begin(), due_.end(), [](const Due& due) { //
            return !due.is_held();
        });
    }
    void answer_due()
    {
        for (auto next = next_due();
             link_ != nullptr && next != due_.end() && next->time <= scheduler().now();
             next = next_due()) {
            const Due due = std::move(*next);
            due_.erase(next);
            answer(due);
        }
        if (link_ == nullptr) {
            return;
        }
        flush();
        if (channel_.is_closed()) {
            std::exchange(link_, nullptr)->close(Side::Server);
            deadline_.cancel();
            return;
        }
        deadline_.set(channel_.next_deadline());
        const auto next = next_due();
        answers_.set(next == due_.end() ? no_deadline : next->time);
    }
    /// Takes what the channel has to say, but for messages that the script replaces.
    void flush()
    {
        detail::Dissector frames;
        frames.feed(Side::Server, channel_.output());
        while (const auto frame = frames.take(Side::Server)) {
            const auto instead = server_.take_replaced(frame->type_name);
            const auto& bytes = instead ? *instead : frame->bytes;
            output_.insert(output_.end(), bytes.begin(), bytes.end());
        }
        channel_.consume(channel_.output().size());
        if (link_ != nullptr) {
            link_->flush(Side::Server);
        }
    }
    void answer(const Due& due)
    {
        if (!due.body.empty()) {
            static_cast<void>(send(due.request_id, due.body, due.wrong));
        }
        if (!due.end) {
            return;
        }
        if (due.end->is_bad()) {
            channel_.close(*due.end, "as the script says");
        } else {
            link_->cut(); // both ends are notified
        }
    }

    ScriptedServer& server_;
    std::shared_ptr<Link> link_;
    detail::WrongChunks chunks_;
    channel::ServerChannel channel_;
    std::vector<std::byte> output_;
    std::deque<Due> due_;
    std::shared_ptr<bool> alive_{std::make_shared<bool>(true)};
    Alarm deadline_;
    Alarm answers_;
};

ScriptedServer::ScriptedServer(World& world, std::string_view url, const ScriptedServerParts& parts)
    : world_{world}, url_{url}, parts_{parts}, log_{world.new_log(Actor::Server)},
      random_{world.new_chance(Actor::Server).next()}
{
    if (const auto listens = world.network().listen(url, *this); !listens) {
        unexpected_.push_back("it does not listen at \"" + url_ + "\": " +
                              (listens.error() == status::Bad_InvalidState
                                   ? "something else does already"
                                   : text_of(listens.error())));
    }
}

ScriptedServer::~ScriptedServer()
{
    world_.network().unlisten(*this);
    if (const std::string text = unseen_report(); !text.empty()) {
        fail_test("a scripted server was not asked as its script says, and the test has not looked "
                  "at its report():\n" +
                  text);
    }
}

detail::ScriptStep& ScriptedServer::add(detail::ScriptStep& step, std::uint32_t encoding_id)
{
    step.encoding_id = encoding_id;
    step.name = detail::encoding_name(NodeId{0, encoding_id});
    return step;
}

bool ScriptedServer::accept(const std::shared_ptr<Link>& link, std::string_view /*peer_address*/)
{
    peers_.erase(std::remove_if(peers_.begin(), peers_.end(),
                                [](const auto& peer) { return peer->has_ended(); }),
                 peers_.end());
    channel::ServerChannelConfig config;
    config.allowed = parts_.allowed;
    config.channel_id = ++last_channel_id_;
    const channel::ChannelEnvironment environment{
        .random = &random_,
        .wall_clock = &world_.clock(),
        .log = &log_,
        .validator = parts_.validator != nullptr ? parts_.validator : &accept_any_,
        .identity = parts_.identity,
        .chunk_hook = &world_.network().chunk_hook()};
    peers_.push_back(std::make_unique<Peer>(*this, std::move(config), environment, link));
    link->attach(Side::Server, *peers_.back());
    return true;
}

std::optional<detail::ScriptStep> ScriptedServer::take_step(std::span<const std::byte> body)
{
    const NodeId id = detail::encoding_of(body);
    if (came_.size() < max_came) {
        came_.push_back(detail::encoding_name(id));
    }
    const auto is_it = [&](const detail::ScriptStep& step) {
        return id.is(step.encoding_id) && (!step.matches || step.matches(body));
    };
    if (!steps_.empty() && is_it(steps_.front())) {
        auto step = std::move(steps_.front());
        steps_.pop_front();
        return step;
    }
    const auto known = [&](const std::deque<detail::ScriptStep>& steps) {
        const auto found = std::find_if(steps.begin(), steps.end(), is_it);
        return found == steps.end() ? std::nullopt : std::optional{*found};
    };
    if (auto step = known(allowed_)) {
        return step;
    }
    if (auto answer = others_ ? others_(body) : std::nullopt) {
        detail::ScriptStep step;
        step.delay = answer->delay;
        if (!answer->body.empty()) {
            step.answer = [kept = std::move(answer->body)](const auto&, DateTime, const Wrong&) {
                return Result<std::vector<std::byte>>{kept};
            };
        }
        return step;
    }
    if (auto step = known(defaults_)) {
        return step;
    }
    if (unexpected_.size() < max_unexpected) {
        const bool is_other = !steps_.empty() && id.is(steps_.front().encoding_id);
        const std::string expected =
            steps_.empty() ? "nothing more" : (is_other ? "another " : "") + steps_.front().name;
        const auto time = std::chrono::duration<double>{world_.now().time_since_epoch()};
        unexpected_.push_back("expected " + expected + ", came " + detail::encoding_name(id) +
                              " at " + std::to_string(time.count()) + " s");
    }
    return std::nullopt;
}

ScriptedServer::Peer* ScriptedServer::newest() const
{
    return peers_.empty() || peers_.back()->has_ended() ? nullptr : peers_.back().get();
}

Result<void> ScriptedServer::send_body(std::uint32_t request_id, std::span<const std::byte> body,
                                       const Wrong& wrong)
{
    Peer* const peer = newest();
    return peer != nullptr ? peer->send(request_id, body, wrong) : fail(status::Bad_NotConnected);
}

void ScriptedServer::send_bytes(std::span<const std::byte> bytes)
{
    if (Peer* const peer = newest()) {
        peer->send_bytes(bytes);
    }
}

void ScriptedServer::replace(std::string_view message_type, std::vector<std::byte> bytes)
{
    replaced_.emplace_back(message_type, std::move(bytes));
}

std::optional<std::vector<std::byte>> ScriptedServer::take_replaced(std::string_view message_type)
{
    const auto found = std::find_if(replaced_.begin(), replaced_.end(),
                                    [&](const auto& entry) { return entry.first == message_type; });
    if (found == replaced_.end()) {
        return std::nullopt;
    }
    auto bytes = std::move(found->second);
    replaced_.erase(found);
    return bytes;
}

std::string ScriptedServer::report() const
{
    excuses_all_ = true;
    return unexpected() + missing();
}

std::string ScriptedServer::unseen_report() const
{
    if (excuses_all_) {
        return {};
    }
    return unexpected() + (excuses_steps_ ? std::string{} : missing());
}

std::string ScriptedServer::unexpected() const
{
    std::string text;
    for (const std::string& line : unexpected_) {
        text += line + "\n";
    }
    return text;
}

std::string ScriptedServer::missing() const
{
    std::string text;
    for (const detail::ScriptStep& step : steps_) {
        text += "expected " + step.name + ", came nothing\n";
    }
    return text;
}

} // namespace busbar::harness
