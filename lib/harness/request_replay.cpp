#include <busbar/harness/request_replay.hpp>

#include <algorithm>
#include <map>

#include <busbar/harness/message_body.hpp>
#include <busbar/types/history.hpp>
#include <busbar/types/view.hpp>

#include "message_fields.hpp"
#include "recorded_exchanges.hpp"
#include "volatile_fields.hpp"

namespace busbar::harness {

namespace {

using detail::RecordedExchange;
using detail::WholeRecordedMessage;

/// The text of a field; empty if there is none.
std::string text_at(const RecordedMessage& message, std::string_view path)
{
    const auto found =
        std::find_if(message.fields.begin(), message.fields.end(),
                     [&](const RecordedMessage::Field& field) { return field.path == path; });
    return found == message.fields.end() ? std::string{} : found->text;
}

/// The ContinuationPoints in a response, in the order of its results; those of other services are
/// not known.
std::vector<ByteString> points_in(std::span<const std::byte> response)
{
    std::vector<ByteString> points;
    const auto add = [&](const auto& decoded) {
        for (const auto& result : decoded->results) {
            points.push_back(result.continuation_point);
        }
    };
    if (const auto browsed = decode_body<BrowseResponse>(response)) {
        add(browsed);
    } else if (const auto next = decode_body<BrowseNextResponse>(response)) {
        add(next);
    } else if (const auto history = decode_body<HistoryReadResponse>(response)) {
        add(history);
    }
    return points;
}

/// One replay.
class RequestReplay {
public:
    RequestReplay(World& world, ConnectionHost& client, const RequestReplayOptions& options,
                  std::vector<RecordedExchange> exchanges)
        : world_{world}, client_{client}, options_{options}, exchanges_{std::move(exchanges)},
          is_answered_(exchanges_.size(), false)
    {
        for (std::size_t i = 0; i < exchanges_.size(); ++i) {
            is_answered_[i] = exchanges_[i].response == nullptr; // and is not waited for
        }
    }

    [[nodiscard]] std::vector<RecordedMessage> run()
    {
        const TimePoint begin = world_.now();
        for (std::size_t i = 0; i < exchanges_.size() && client_.is_ready(); ++i) {
            if (options_.keeps_pace) {
                world_.run_until(begin + (time_of(i) - time_of(0)));
            }
            await_answers_before(i);
            send(i);
        }
        await(exchanges_.size(),
              [](const RecordedExchange& exchange) { return exchange.response != nullptr; });
        return std::move(messages_);
    }

private:
    [[nodiscard]] Duration time_of(std::size_t i) const
    {
        constexpr Duration most = std::chrono::hours{24 * 366};
        return std::min<Duration>(exchanges_[i].request->words.time, most);
    }
    /// Waits for the answers that the recorded client had before it sent this request.
    void await_answers_before(std::size_t i)
    {
        const std::size_t number = exchanges_[i].request->words.number;
        await(i, [number](const RecordedExchange& exchange) {
            return exchange.response != nullptr && exchange.response->words.number < number;
        });
    }
    /// Waits until those of the first `count` exchanges for which `counts` are answered.
    template <typename Counts>
    void await(std::size_t count, Counts counts)
    {
        const auto is_done = [&] {
            while (first_open_ < exchanges_.size() && is_answered_[first_open_]) {
                ++first_open_;
            }
            for (std::size_t i = first_open_; i < count; ++i) {
                if (!is_answered_[i] && counts(exchanges_[i])) {
                    return false;
                }
            }
            return true;
        };
        if (!world_.run_until(is_done, options_.answer_limit)) {
            // What has not come is not waited for again.
            for (std::size_t i = 0; i < count; ++i) {
                is_answered_[i] = is_answered_[i] || counts(exchanges_[i]);
            }
        }
    }
    void send(std::size_t i)
    {
        const WholeRecordedMessage& request = *exchanges_[i].request;
        std::vector<std::byte> body = request.body;
        put_points(body);
        for (const RecordedMessage::Field& field : request.words.fields) {
            const auto found = ids_.find({kind_of(i, field.path), field.text});
            if (found != ids_.end() && found->second != field.text) {
                static_cast<void>(detail::edit_message(body, field.path, found->second));
            }
        }
        note(Side::Client, i, body);
        client_.send_body(body, [this, i](const std::vector<std::byte>& answer) {
            if (!answer.empty()) {
                learn_points(i, answer);
                learn(i, note(Side::Server, i, answer));
            }
            is_answered_[i] = true;
        });
    }
    /// Returns what an id in an exchange stands for. Servers may number the items of each
    /// Subscription from 1 on, so that an item's id means nothing without its Subscription's.
    [[nodiscard]] std::string kind_of(std::size_t i, std::string_view path) const
    {
        const std::string kind{detail::kind_of_id(path)};
        return kind == "item"
                   ? kind + " of " + text_at(exchanges_[i].request->words, "subscriptionId")
                   : kind;
    }
    /// Puts the new server's ContinuationPoints in the place of the old one's.
    void put_points(std::vector<std::byte>& body) const
    {
        const auto put = [&](ByteString& point) {
            const auto found = points_.find({point.span().begin(), point.span().end()});
            if (found != points_.end()) {
                point = found->second;
            }
        };
        if (auto next = decode_body<BrowseNextRequest>(body)) {
            for (ByteString& point : next->continuation_points) {
                put(point);
            }
            body = encode_body(*next).value_or(body);
        } else if (auto history = decode_body<HistoryReadRequest>(body)) {
            for (HistoryReadValueId& node : history->nodes_to_read) {
                put(node.continuation_point);
            }
            body = encode_body(*history).value_or(body);
        }
    }
    /// Finds out which ContinuationPoints the new server has for those of the old one.
    void learn_points(std::size_t i, std::span<const std::byte> answer)
    {
        if (exchanges_[i].response == nullptr) {
            return;
        }
        const auto before = points_in(exchanges_[i].response->body);
        const auto after = points_in(answer);
        for (std::size_t j = 0; j < std::min(before.size(), after.size()); ++j) {
            if (!before[j].empty() && !after[j].empty()) {
                points_[{before[j].span().begin(), before[j].span().end()}] = after[j];
            }
        }
    }
    /// Keeps a message in words; the exchange's number is its request id.
    const RecordedMessage& note(Side from, std::size_t i, std::span<const std::byte> body)
    {
        RecordedMessage& message = messages_.emplace_back();
        message.number = messages_.size();
        message.time = world_.now().time_since_epoch();
        message.connection = 1;
        message.from = from;
        message.request_id = static_cast<std::uint32_t>(i + 1);
        detail::read_into(message, body);
        return message;
    }
    /// Finds out which ids the new server has for those of the old one.
    void learn(std::size_t i, const RecordedMessage& answer)
    {
        if (exchanges_[i].response == nullptr) {
            return;
        }
        for (const RecordedMessage::Field& field : exchanges_[i].response->words.fields) {
            const std::string kind = kind_of(i, field.path);
            if (kind != "subscription" && !kind.starts_with("item") && kind != "node") {
                continue; // not the server's, or of another session
            }
            const auto found = std::find_if(
                answer.fields.begin(), answer.fields.end(),
                [&](const RecordedMessage::Field& own) { return own.path == field.path; });
            if (found == answer.fields.end()) {
                continue;
            }
            if (answer.name.starts_with("Create") || answer.name.starts_with("Register")) {
                ids_.insert_or_assign({kind, field.text}, found->text);
            } else {
                ids_.try_emplace({kind, field.text}, found->text);
            }
        }
    }

    World& world_;
    ConnectionHost& client_;
    RequestReplayOptions options_;
    std::vector<RecordedExchange> exchanges_;
    std::vector<bool> is_answered_;
    /// All before it are answered.
    std::size_t first_open_{0};
    std::vector<RecordedMessage> messages_;
    std::map<std::pair<std::string, std::string>, std::string> ids_;
    std::map<std::vector<std::byte>, ByteString> points_;
};

} // namespace

Result<std::vector<RecordedMessage>> replay_requests(World& world, const Recording& recording,
                                                     client::ConnectionConfig config,
                                                     const ClientParts& parts,
                                                     const RequestReplayOptions& options)
{
    const auto messages = detail::read_whole_messages(recording);
    config.request_timeout = std::chrono::duration_cast<std::chrono::milliseconds>(
        options.answer_limit + std::chrono::seconds{1});
    ConnectionHost client{world, std::move(config), parts};
    if (const auto opened = client.open(options.answer_limit); !opened) {
        return fail(opened.error());
    }
    RequestReplay replay{world, client, options, detail::exchanges_of(messages)};
    auto came = replay.run();
    client.close(); // what was not answered is told to the replay
    constexpr Duration farewell = std::chrono::milliseconds{100};
    world.run_for(farewell);
    return came;
}

std::vector<RecordedMessage> repeated_messages(const Recording& recording)
{
    const auto messages = detail::read_whole_messages(recording);
    std::vector<RecordedMessage> repeated;
    for (const RecordedExchange& exchange : detail::exchanges_of(messages)) {
        for (const WholeRecordedMessage* const one : {exchange.request, exchange.response}) {
            if (one != nullptr) {
                repeated.push_back(one->words);
            }
        }
    }
    std::sort(repeated.begin(), repeated.end(),
              [](const auto& a, const auto& b) { return a.number < b.number; });
    return repeated;
}

} // namespace busbar::harness
