#include "volatile_fields.hpp"

#include <algorithm>
#include <array>

namespace busbar::harness::detail {

namespace {

struct IdName {
    std::string_view field;
    std::string_view kind;
};

constexpr std::array ids{
    IdName{"authenticationToken", "token"},   IdName{"sessionId", "session"},
    IdName{"subscriptionId", "subscription"}, IdName{"subscriptionIds", "subscription"},
    IdName{"monitoredItemId", "item"},        IdName{"monitoredItemIds", "item"},
    IdName{"triggeringItemId", "item"},       IdName{"linksToAdd", "item"},
    IdName{"linksToRemove", "item"},          IdName{"clientHandle", "client"},
    IdName{"continuationPoint", "point"},     IdName{"continuationPoints", "point"},
    IdName{"registeredNodeIds", "node"},      IdName{"nodesToUnregister", "node"},
};

constexpr std::array<std::string_view, 17> noise{"requestHandle",     "clientNonce",
                                                 "serverNonce",       "signature",
                                                 "clientCertificate", "serverCertificate",
                                                 "secureChannelId",   "tokenId",
                                                 "sequenceNumber",    "auditEntryId",
                                                 "timeoutHint",       "password",
                                                 "tokenData",         "availableSequenceNumbers",
                                                 "endpointUrl",       "discoveryUrls",
                                                 "discoveryUrl"};

constexpr std::array<std::string_view, 5> times{"timestamp", "createdAt", "startTime", "endTime",
                                                "publishTime"};

template <typename Names>
bool has(const Names& names, std::string_view name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace

std::string_view last_name(std::string_view path)
{
    path.remove_prefix(path.rfind('.') + 1); // npos + 1 is 0
    return path.substr(0, path.find('['));
}

std::string_view kind_of_id(std::string_view path)
{
    const std::string_view name = last_name(path);
    const auto found = std::find_if(ids.begin(), ids.end(),
                                    [&](const IdName& known) { return known.field == name; });
    return found == ids.end() ? std::string_view{} : found->kind;
}

Variability variability_of(const RecordedMessage::Field& field)
{
    const std::string_view path = field.path;
    const std::string_view name = last_name(path);
    if (name == "eventFields" && field.text.starts_with("DateTime ")) {
        return Variability::Time;
    }
    if (name == "eventFields" && field.text.starts_with("ByteString ")) {
        return Variability::Noise; // EventId
    }
    if (!kind_of_id(path).empty()) {
        return Variability::Id;
    }
    if (has(times, name) || name.ends_with("Timestamp")) {
        return Variability::Time;
    }
    return has(noise, name) ? Variability::Noise : Variability::None;
}

std::string Symbols::of(const RecordedMessage::Field& field)
{
    switch (variability_of(field)) {
    case Variability::Id: {
        const std::string kind{kind_of_id(field.path)};
        const auto [known, is_new] = known_.try_emplace({kind, field.text}, 0);
        if (is_new) {
            known->second = ++counts_[kind];
        }
        return "$" + kind + std::to_string(known->second);
    }
    case Variability::Time:
        return "$time";
    case Variability::Noise:
        return "$" + std::string{last_name(field.path)};
    case Variability::None:
        break;
    }
    return field.text;
}

} // namespace busbar::harness::detail
