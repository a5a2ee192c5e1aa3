#include "recorded_exchanges.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "volatile_fields.hpp"

namespace busbar::harness::detail {

namespace {

bool is_of_session(std::string_view name)
{
    static constexpr std::array<std::string_view, 6> names{
        "FindServersRequest",   "FindServersOnNetworkRequest", "GetEndpointsRequest",
        "CreateSessionRequest", "ActivateSessionRequest",      "CloseSessionRequest"};
    return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace

std::vector<RecordedExchange> exchanges_of(const std::vector<WholeRecordedMessage>& messages)
{
    std::vector<RecordedExchange> exchanges;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> open;
    for (const WholeRecordedMessage& message : messages) {
        const RecordedMessage& words = message.words;
        if (message.body.empty() || words.fields.empty()) {
            continue;
        }
        const std::pair place{words.connection, words.request_id};
        if (words.from == Side::Client) {
            open.erase(place);
            if (!is_of_session(words.name)) {
                open[place] = exchanges.size();
                exchanges.push_back({&message, nullptr});
            }
        } else if (const auto found = open.find(place); found != open.end()) {
            exchanges[found->second].response = &message;
            open.erase(found);
        }
    }
    return exchanges;
}

std::string content_of(const RecordedMessage& request)
{
    std::string text;
    for (const RecordedMessage::Field& field : request.fields) {
        if (variability_of(field) == Variability::None) {
            text += field.path + "=" + field.text + "\n";
        }
    }
    return text;
}

} // namespace busbar::harness::detail
