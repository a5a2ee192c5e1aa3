#include <algorithm>
#include <map>

#include <busbar/harness/request_replay.hpp>

#include "message_fields.hpp"
#include "recorded_exchanges.hpp"

namespace busbar::harness {

struct RecordedServer::Impl {
    Impl(World& world, std::string_view url, const Recording& recording,
         const ScriptedServerParts& parts)
        : messages{detail::read_whole_messages(recording)}, server{world, url, parts}
    {
        for (const detail::RecordedExchange& exchange : detail::exchanges_of(messages)) {
            const RecordedMessage& request = exchange.request->words;
            answers[{request.name, detail::content_of(request)}].exchanges.push_back(exchange);
        }
        server.accept_clients();
        server.answer_others([this](std::span<const std::byte> request) { //
            return answer(request);
        });
    }

    [[nodiscard]] std::optional<ScriptedServer::OtherAnswer>
    answer(std::span<const std::byte> request)
    {
        RecordedMessage words;
        if (!detail::read_into(words, request)) {
            return std::nullopt;
        }
        const auto found = answers.find({words.name, detail::content_of(words)});
        if (found == answers.end()) {
            return std::nullopt;
        }
        Answers& known = found->second;
        const bool is_used_up = known.next == known.exchanges.size();
        if (is_used_up && words.name == "PublishRequest") {
            return ScriptedServer::OtherAnswer{};
        }
        const auto& exchange = known.exchanges[is_used_up ? known.next - 1 : known.next++];
        if (exchange.response == nullptr) {
            return ScriptedServer::OtherAnswer{};
        }
        ScriptedServer::OtherAnswer answer;
        answer.body = exchange.response->body;
        // Recorded times never decrease, and are not negative.
        constexpr Duration most = std::chrono::hours{24};
        answer.delay =
            std::min<Duration>(exchange.response->words.time - exchange.request->words.time, most);
        for (const RecordedMessage::Field& field : words.fields) {
            if (field.path == "requestHeader.requestHandle") {
                static_cast<void>(
                    detail::edit_message(answer.body, "responseHeader.requestHandle", field.text));
            }
        }
        return answer;
    }

    struct Answers {
        std::vector<detail::RecordedExchange> exchanges;
        std::size_t next{0};
    };
    std::vector<detail::WholeRecordedMessage> messages;
    /// Answers by the name and the content of the request.
    std::map<std::pair<std::string, std::string>, Answers> answers;
    ScriptedServer server;
};

RecordedServer::RecordedServer(World& world, std::string_view url, const Recording& recording,
                               const ScriptedServerParts& parts)
    : impl_{std::make_unique<Impl>(world, url, recording, parts)}
{
}

RecordedServer::~RecordedServer() = default;

std::string RecordedServer::report() const
{
    return impl_->server.report();
}

} // namespace busbar::harness
